"""A block and its foundation."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal

from rocking_block import _engine
from rocking_block._html import html_table
from rocking_block._pulse import Pulse, as_pulse
from rocking_block._record import Record, as_record
from rocking_block._run import Run
from rocking_block._tie import Damper, Tie, links
from rocking_block._words import OnOverturning, OnSeparation, number, run_options, ticking

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from typing_extensions import Self

    from rocking_block._pushover import Pushover


class Block(_engine.Block):
    """An immutable rigid block on viscoelastic supports, or on a rigid base.

    Its outline is given by the paper's `alpha` and `p` (Palmeri & Makris 2008) or by sizes, and its supports by `eta` and `xi_v`
    or by `K` and `C`, in any combination. Either way all of these are attributes, and so are `R0`, `I0`, `omega_v`, `delta_s`, `e`, `e_max`,
    `theta_separation`, `alpha_L` and `alpha_R`. Attributes that a rigid base lacks are nan.

    Parameters
    ----------
    alpha : float, default 0.18
        Slenderness angle α [rad], 0 < α < π/2.
    p : float, default 2.75
        Frequency parameter p = √(γ g / ((1 + γ) R0)) [rad/s], eq. (3).
    eta : float, default 40
        Stiffness ratio η = ω_v/p [1]; required with `width` unless `K` and `C` are given.
    xi_v : float, default 0.1
        Vertical damping ratio ξ_v [1].
    width, height : float
        Width of the base, and twice the height of the centre of mass above it [m], instead of `alpha` and `p`.
    center_height : float
        Height of the centre of mass above the base [m], instead of `height`.
    inertia : float
        Centroidal moment of inertia I0 [kg m²], instead of `gamma`; with `width` and `mass`.
    K, C : float
        Stiffness [N/m] and damping [N s/m] of one support, instead of `eta` and `xi_v`.
    mass : float, default 1000
        Mass M [kg]; required with `K` and `C`, since η and ξ_v then depend on it.
    gamma : float, default 3
        Shape factor γ = M R0²/I0 [1]; 3 for a homogeneous rectangle. Refused with `inertia`.
    epsilon : float
        Restitution ε of the landing corner [1], 0 ≤ ε ≤ 1, eq. (17).
    g : float
        Gravity [m/s²].
    foundation : {"viscoelastic", "rigid"}
        A spring and a dashpot under each corner, or Housner's rigid base.
    restitution_factor : float, default 1
        On the rigid base, restitution e over Housner's e of ε [1].
    eccentricity : float, default 0
        Distance of the centre of mass from the middle of the base [m], positive to the right. `alpha_L` and `alpha_R` are the
        slenderness angles of both sides.
    friction : float, optional
        Coulomb's coefficient of friction μ of the feet [1]. By default (None or infinity) it has no limit, so that they do not slide.
    ties : Tie or sequence of Tie
        One or several ties to the ground; they need `mass`.
    dampers : Damper or sequence of Damper
        One or several dampers to the ground, which need `mass` too. Ties and dampers are up to eight.

    Raises
    ------
    ValueError
        A parameter that is invalid or has no effect; the message names it.

    Warns
    -----
    UserWarning
        Supports too soft to keep the block upright.

    Examples
    --------
    >>> import rocking_block as rb
    >>> block = rb.Block(alpha=0.2, p=1.5, eta=60, xi_v=0.1)
    >>> block
    <Block 1.3 m × 6.41 m, 1000 kg: alpha=0.2, p=1.5, eta=60, xi_v=0.1, epsilon=0; R0=3.27 m, K=4.05e+06 N/m, C=9e+03 N s/m>
    >>> block.replace(foundation="rigid")
    <Block 1.3 m × 6.41 m, 1000 kg: alpha=0.2, p=1.5, rigid base, epsilon=0; R0=3.27 m, e=0.9408>
    >>> rb.Block(alpha=-0.2)
    Traceback (most recent call last):
        ...
    ValueError: alpha = -0.2 is not valid; expected 0 < alpha < pi/2 rad
    """

    __slots__ = ()

    def __new__(
        cls,
        *,
        alpha: float | None = None,
        p: float | None = None,
        eta: float | None = None,
        xi_v: float | None = None,
        width: float | None = None,
        height: float | None = None,
        K: float | None = None,
        C: float | None = None,
        mass: float | None = None,
        gamma: float | None = None,
        epsilon: float = 0.0,
        g: float = 9.81,
        foundation: str = "viscoelastic",
        restitution_factor: float | None = None,
        center_height: float | None = None,
        inertia: float | None = None,
        eccentricity: float = 0.0,
        friction: float | None = None,
        ties: Sequence[Tie] | Tie | None = None,
        dampers: Sequence[Damper] | Damper | None = None,
    ) -> Self:
        """Returns the block of these parameters, which the engine checks."""
        return _engine.Block.__new__(cls, **{name: value for name, value in locals().items() if name != "cls"})

    def replace(self, **changes: Any) -> Block:
        """Returns the block with some parameters replaced.

        With `foundation="rigid"` the parameters of its supports are dropped, and with "viscoelastic" the factor on e.

        >>> import rocking_block as rb
        >>> rb.Block(eta=60).replace(p=2.0).eta
        60.0
        """
        kept = self.parameters()
        if "inertia" in changes:
            kept.pop("gamma", None)
        if "gamma" in changes:
            kept.pop("inertia", None)
        for one, other_one in (("height", "center_height"), ("center_height", "height")):
            if one in changes:
                kept.pop(other_one, None)
        if "foundation" in changes:
            for name in _engine.Block._names_of_other_foundation(changes["foundation"]):
                kept.pop(name, None)
        return Block(**(kept | changes))

    __replace__ = replace

    def run(
        self,
        record: Record | str | os.PathLike[str] | None = None,
        *,
        vertical: Record | str | os.PathLike[str] | None = None,
        scale: float = 1.0,
        pulse: Pulse | None = None,
        theta: float = 0.0,
        theta_dot: float = 0.0,
        v: float | None = None,
        v_dot: float | None = None,
        tolerance: float = 1e-8,
        on_separation: OnSeparation = "fly",
        on_overturning: OnOverturning = "terminate",
        duration: float | None = None,
        step: float | None = None,
        gradients: Sequence[str] | str = (),
        progress: bool | None = None,
    ) -> Run:
        """Simulates the block under a record or a pulse, or in free motion.

        Results equal those of `rocking simulate --on-separation fly` to the last bit.

        Parameters
        ----------
        record, vertical : Record or path, optional
            Horizontal and vertical ground acceleration, each followed exactly, sample by sample. Files are read with
            `read_record`.
        scale : float
            Factor on both [1].
        pulse : Pulse, optional
            A pulse, alone or added to the record.
        theta, theta_dot : float
            Rotation [rad] and its rate [rad/s] at the start, positive to the right.
        v, v_dot : float, optional
            Height of the centre of mass above its position at rest [m] and vertical velocity [m/s] at the start,
            instead of vertical equilibrium.
        tolerance : float
            Relative tolerance of the integration, 1e-14 to 1e-1.
        on_separation : {"fly", "terminate", "hold"}
            At complete separation the block flies and lands, the default in all functions of the package. With
            "terminate" the run ends there, as in the paper; with "hold" the block is frozen until `duration`.
        on_overturning : {"terminate", "hold"}
            At a quarter turn the run ends, or the block is frozen until `duration`.
        duration : float, optional
            Duration [s]; by default the run continues until the ground has come to rest and the block has come down.
        step : float, optional
            Time between two rows [s]; by default the record's time step, or 0.01 s.
        gradients : str or sequence of str
            One or several parameters with respect to which `Run.gradients` has exact derivatives, through all events: "alpha", "eta",
            "scale", "pulse.period", "initial.theta", "tie_1.stiffness" and so on, by the names of the FMU.
        progress : bool, optional
            Whether to show a tqdm progress bar.

        Raises
        ------
        ValueError
            An invalid option, no excitation, or a failed run; the message is the engine's.
        TypeError
            An argument that is not a record or a pulse.

        Examples
        --------
        >>> import rocking_block as rb
        >>> run = rb.Block(alpha=0.25, p=1.0).run(pulse=rb.Pulse("one-sine", 6.2622, 1.2566))
        >>> run
        <Run completed at 9.257 s, |θ|/α = 0.5798, 4 impacts, 927 rows>
        >>> run.outcome, run.theta.shape
        ('completed', (927,))

        The peak rotation grows with the period of the pulse:

        >>> run = rb.Block(alpha=0.25, p=1.0).run(pulse=rb.Pulse("one-sine", 6.2622, 1.2566), gradients=["pulse.period"])
        >>> run.gradients["pulse.period"].peak.theta > 0
        True
        """
        initial = {"theta": theta, "theta_dot": theta_dot, "v": v, "v_dot": v_dot}
        initial = {name: None if value is None else number(name, value) for name, value in initial.items()}
        options = run_options(tolerance, on_separation, on_overturning, duration, step)
        horizontal = None if record is None else as_record("record", record, self.g)
        vertical = None if vertical is None else as_record("vertical", vertical, self.g)
        with ticking(progress) as tick:
            factor = number("scale", scale)
            parameters = [gradients] if isinstance(gradients, str) else [str(name) for name in gradients]
            result = _engine.history(
                self, horizontal, vertical, factor, as_pulse(pulse), initial, options, parameters, tick
            )
        return Run.of(self, result)

    def pushover(
        self,
        *,
        side: Literal["right", "left"] = "right",
        to: float | None = None,
        amplitude: float | None = None,
        points: int = 400,
    ) -> Pushover:
        """Turns the block slowly by a lateral force at its centre of mass.

        Supports, ties and dampers follow their laws at rest, so that dashpots do nothing. The curve ends where the force vanishes, or where
        the block slides or leaves the ground.

        Parameters
        ----------
        side : {"right", "left"}
            Side to which the force turns the block.
        to : float, optional
            Greatest rotation [rad]; by default that at which the centre of mass stands over the corner.
        amplitude : float, optional
            Also turn the block to and fro by this amplitude [rad].
        points : int
            Number of equal steps to the greatest rotation, and to the amplitude. Landmarks stand between them, at their rotations.

        Raises
        ------
        ValueError
            A rotation or a number of steps out of range, an amplitude that the block does not reach, or forces without a balance.

        Examples
        --------
        >>> import rocking_block as rb
        >>> rb.Block(alpha=0.25, p=1.0).pushover()
        <Pushover of 403 rows: L lifts at 0.003368, greatest force at 0.003368, balance at 0.25>
        """
        from rocking_block import _pushover

        return _pushover.pushover(self, side, to, amplitude, points)

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draws the block with its centre of mass, foundation and dimensions with Matplotlib.

        Lengths are to scale, in metres; supports have a fixed size.

        Parameters
        ----------
        ax : Axes, optional
            Axes to draw on; by default pyplot's current axes, or a new figure if these show another plot.
        """
        from rocking_block import _sketch

        return _sketch.sketch(self, ax)

    def _repr_html_(self) -> str:
        angles = [("α", self.alpha)] if self.eccentricity == 0 else [("α left", self.alpha_L), ("α right", self.alpha_R)]
        rows = [
            ("width × height", f"{self.width:.4g} m × {self.height:.4g} m"),
            *((name, f"{angle:.4g} rad = {math.degrees(angle):.4g}°") for name, angle in angles),
            ("R0, p", f"{self.R0:.4g} m, {self.p:.4g} rad/s"),
            ("mass, γ", f"{self.mass:.6g} kg, {self.gamma:.4g}"),
        ]
        if self.foundation == "rigid":
            rows += [("rigid base", f"e = {self.e:.4g}")]
        else:
            rows += [
                ("η, ξ_v, ε", f"{self.eta:.4g}, {self.xi_v:.4g}, {self.epsilon:.4g}"),
                ("K, C of a support", f"{self.K:.4g} N/m, {self.C:.4g} N s/m"),
            ]
        rows += [("eccentricity", f"{self.eccentricity:.4g} m")] if self.eccentricity else []
        rows += [("friction", f"{self.friction:.4g}")] if math.isfinite(self.friction) else []
        rows += [(name.replace("_", " "), repr(link)) for name, link in links(self).items()]
        return html_table("rigid block", (), rows)

    def __repr__(self) -> str:
        size = f"{self.width:.3g} m × {self.height:.3g} m, {self.mass:g} kg"
        if math.isnan(self.eta):
            base = "rigid base, "
            more = f"e={self.e:.4g}"
        else:
            base = f"eta={self.eta:.6g}, xi_v={self.xi_v:.6g}, "
            more = f"K={self.K:.3g} N/m, C={self.C:.3g} N s/m"
        paper = f"alpha={self.alpha:.6g}, p={self.p:.6g}, {base}epsilon={self.epsilon:g}"
        paper += f", eccentricity={self.eccentricity:g}" if self.eccentricity else ""
        paper += f", friction={self.friction:g}" if math.isfinite(self.friction) else ""
        for kind, found in (("tie", self.ties), ("damper", self.dampers)):
            if found:
                paper += f", {len(found)} {kind}{'s' if len(found) > 1 else ''}"
        return f"<Block {size}: {paper}; R0={self.R0:.3g} m, {more}>"
