"""The history of a block."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any, overload

import numpy as np
import numpy.typing as npt

from rocking_block import _engine
from rocking_block._html import html_table
from rocking_block._tie import force_of, links
from rocking_block._words import Floats, Outcome, optional

if TYPE_CHECKING:
    import pandas
    from matplotlib.axes import Axes


@dataclass(frozen=True)
class Event:
    """A change of contact."""

    t: float
    """Time [s]."""
    event: str
    """"lift-off", "landing", "slip", "grip" or "overturning"; of a tie or a damper "taut", "slack", "yield", "unload" or "break"."""
    corner: str | None
    """"L" or "R", of a lift-off or a landing; such as "tie 1" or "damper 2" of its event."""
    before: str
    """The regime before: "full contact", "tilting left", "tilting right" or "separated"."""
    after: str
    """The regime after."""


@dataclass(frozen=True)
class Peak:
    """Largest absolute values of a run, including those between its rows."""

    theta: float
    """Rotation [rad]."""
    N: float
    """Vertical reaction of a corner [N]."""
    H: float
    """Horizontal reaction [N]."""
    uplift: float
    """Height of a corner above its support [m]."""
    friction_demand: float
    """|H|/(N_L + N_R) [1]: the coefficient of friction that prevents sliding."""
    slip: float
    """Distance of the foot from its initial position [m], of blocks with friction."""
    tensions: tuple[float, ...]
    """Tension of each tie [N]."""
    damper_forces: tuple[float, ...] = ()
    """Force of each damper [N]."""
    plastic_elongations: tuple[float, ...] = ()
    """Plastic elongation of each tie, then of each damper [m]."""
    damper_strokes: tuple[float, ...] = ()
    """Elongation of each damper, longer or shorter [m]."""

    @classmethod
    def _of(cls, peak: Any) -> Peak:
        *quantities, of_links = peak
        return cls(*quantities, *of_links)


@dataclass(frozen=True, eq=False)
class Gradient:
    """Derivatives of a run with respect to one parameter, per SI unit of the parameter."""

    columns: dict[str, Floats]
    """Derivatives of the columns at the times of the rows, each of shape (n,); sums of energy since the start have none."""
    event_times: Floats
    """Derivatives of the times of the events."""
    peak: Peak
    """Derivatives of the largest absolute values."""

    def __getitem__(self, name: str) -> Floats:
        return self.columns[name]

    def __repr__(self) -> str:
        return f"<Gradient of {len(self.columns)} columns and the times of {len(self.event_times)} events; peak theta {self.peak.theta:.4g}>"


@dataclass(frozen=True)
class Grazing:
    """An event whose function barely crosses zero: after it a run has no derivatives."""

    t: float
    """Time [s]."""
    event: str
    """As in `Event`, or "held" where a corner begins or ceases to be held."""
    corner: str | None
    """"L" or "R", of a lift-off or a landing."""


@dataclass(frozen=True)
class Counts:
    """Counters of a run."""

    impacts: int
    """Landings of a corner."""
    liftoffs: int
    """Lift-offs of a corner."""
    steps: int
    """Accepted steps of the integrator."""
    rejected: int
    """Rejected steps, repeated with a smaller size."""
    evaluations: int
    """Evaluations of the equations of motion."""


@dataclass(frozen=True, eq=False)
class Energy:
    """Energies over time [J], each of shape (n,)."""

    total: Floats
    kinetic: Floats
    input: Floats
    """Work of the ground motion."""
    dashpots: Floats
    """Lost in the dashpots."""
    friction: Floats
    """Lost by sliding."""
    ties: Floats
    """Lost in the dashpots and the yielding of ties, and in ties that broke."""
    dampers: Floats
    """Lost in the dashpots and the yielding of dampers, and in dampers that broke."""
    impacts: Floats
    """Lost at impacts."""
    constraint: Floats
    """Gained or lost when the horizontal constraint changes."""
    residual: Floats
    """Error of the energy balance: round-off and integration error."""


@dataclass(frozen=True, eq=False, repr=False)
class Run:
    """The history of a block, in rows at evenly spaced times and at the end of the run; made by `Block.run`.

    Columns are arrays of shape (n,) in SI units, with angles in radians, under the names of the FMU's variables.
    `run["theta"]` gives any column by its name; columns without a dot in their name are attributes, as in `run.theta`,
    and energies are in `run.energy`, as in `run.energy.total`.
    """

    block: _engine.Block
    """The block."""
    columns: dict[str, Floats]
    """All columns by name, as in the table of `rocking simulate`."""
    events: tuple[Event, ...]
    """Events in order of time."""
    peak: Peak
    """Largest absolute values."""
    counts: Counts
    """Counters."""
    outcome: Outcome
    """How the run ended: "completed", "overturned", "separated", or "undecided" if the duration was too short.

    A block that leaves its supports with |θ| ≥ α and growing has overturned.
    """
    end_time: float
    """End of the run [s]."""
    has_come_down: bool
    """Whether, at the end, the ground is at rest and the block is at rest or bound to come to rest."""
    passed_balance: bool = False
    """Whether |θ| exceeded the balance angle of its side, beyond which the block needs more than its weight to come back."""
    ends_tilted: bool = False
    """Whether the block rests at the end without standing upright, as one that leans on a tie."""
    broken: tuple[bool, ...] = ()
    """Whether each tie, and then each damper, is broken at the end."""
    yield_energies: tuple[float, ...] = ()
    """Energy lost by yielding of each tie, then of each damper [J]."""
    gradients: dict[str, Gradient] = field(default_factory=dict)
    """Derivatives by the names of their parameters, as requested in `Block.run`; NaN after `grazing`."""
    grazing: Grazing | None = None
    """The event from which on there are no derivatives, if one grazes."""

    @staticmethod
    def of(block: _engine.Block, result: dict[str, Any]) -> Run:
        """Builds a run from the engine's result."""
        gradients = {
            name: Gradient(columns, event_times, Peak._of(peak))
            for name, (columns, event_times, peak) in result["gradients"].items()
        }
        derivatives = [array for gradient in gradients.values() for array in (*gradient.columns.values(), gradient.event_times)]
        for column in (*result["columns"].values(), *derivatives):
            column.setflags(write=False)
        return Run(
            block=block,
            columns=result["columns"],
            events=tuple(Event(*event) for event in result["events"]),
            peak=Peak._of(result["peak"]),
            counts=Counts(*result["counts"]),
            outcome=result["outcome"],
            end_time=result["end_time"],
            has_come_down=result["has_come_down"],
            passed_balance=result["passed_balance"],
            ends_tilted=result["ends_tilted"],
            broken=tuple(result["broken"]),
            yield_energies=result["yield_energies"],
            gradients=gradients,
            grazing=Grazing(*result["grazing"]) if result["grazing"] else None,
        )

    def __getitem__(self, name: str) -> Floats:
        return self.columns[name]

    def __len__(self) -> int:
        return len(self.t)

    @property
    def t(self) -> Floats:
        """Time [s]."""
        return self.columns["t"]

    @property
    def theta(self) -> Floats:
        """Rotation [rad], positive to the right."""
        return self.columns["theta"]

    @property
    def theta_dot(self) -> Floats:
        """Rate of rotation [rad/s]."""
        return self.columns["theta_dot"]

    @property
    def theta_ddot(self) -> Floats:
        """Angular acceleration [rad/s²]."""
        return self.columns["theta_ddot"]

    @property
    def v(self) -> Floats:
        """Vertical displacement of the centre of mass relative to the ground [m], positive up."""
        return self.columns["v"]

    @property
    def v_dot(self) -> Floats:
        """Rate of `v` [m/s]."""
        return self.columns["v_dot"]

    @property
    def v_ddot(self) -> Floats:
        """Acceleration of `v` [m/s²]."""
        return self.columns["v_ddot"]

    @property
    def u(self) -> Floats:
        """Horizontal displacement of the centre of mass relative to the ground [m], positive to the right."""
        return self.columns["u"]

    @property
    def u_dot(self) -> Floats:
        """Rate of `u` [m/s]."""
        return self.columns["u_dot"]

    @property
    def u_ddot(self) -> Floats:
        """Acceleration of `u` [m/s²]."""
        return self.columns["u_ddot"]

    @property
    def N_L(self) -> Floats:
        """Vertical reaction of the left corner [N], ≥ 0."""
        return self.columns["N_L"]

    @property
    def N_R(self) -> Floats:
        """Vertical reaction of the right corner [N], ≥ 0."""
        return self.columns["N_R"]

    @property
    def H(self) -> Floats:
        """Horizontal reaction on the block [N], positive to the right."""
        return self.columns["H"]

    @property
    def M_base(self) -> Floats:
        """Moment of the reactions about the middle of the base [N m], positive clockwise."""
        return self.columns["M_base"]

    @property
    def regime(self) -> npt.NDArray[np.int8]:
        """−1 tilting left, 0 full contact, 1 tilting right, 2 separated."""
        return self.columns["regime"].astype(np.int8)

    @property
    def uplift_L(self) -> Floats:
        """Height of the left corner above its support [m], ≥ 0."""
        return self.columns["uplift_L"]

    @property
    def uplift_R(self) -> Floats:
        """Height of the right corner above its support [m], ≥ 0."""
        return self.columns["uplift_R"]

    @property
    def friction_demand(self) -> Floats:
        """|H|/(N_L + N_R) [1]."""
        return self.columns["friction_demand"]

    @property
    def slip(self) -> Floats:
        """Displacement of the foot from its initial position [m], positive to the right; only for blocks with friction."""
        return self._of_friction("slip")

    @property
    def slip_rate(self) -> Floats:
        """Velocity at which the foot slides [m/s]; only for blocks with friction."""
        return self._of_friction("slip_rate")

    def _of_friction(self, name: str) -> Floats:
        if name not in self.columns:
            raise AttributeError(f"no {name}: the block has no coefficient of friction; expected Block(friction=...)")
        return self.columns[name]

    @property
    def tensions(self) -> tuple[Floats, ...]:
        """Tension of each tie [N]."""
        return tuple(self.columns[f"tie_{number}.tension"] for number in range(1, len(self.block.ties) + 1))

    @property
    def damper_forces(self) -> tuple[Floats, ...]:
        """Force of each damper [N], positive in tension."""
        return tuple(self.columns[f"damper_{number}.force"] for number in range(1, len(self.block.dampers) + 1))

    def plot_loops(self, ax: Axes | None = None) -> Axes:
        """Draws the forces of dampers, and of ties that yield, over their elongations with Matplotlib.

        Parameters
        ----------
        ax : Axes, optional
            Axes to draw on; by default those of a new figure.

        Raises
        ------
        ValueError
            A block without dampers, whose ties do not yield.
        """
        from rocking_block import _plot

        return _plot.loops(self.block, self.columns, ax)

    @property
    def a_gx(self) -> Floats:
        """Horizontal ground acceleration [m/s²], including the pulse, positive to the right."""
        return self.columns["a_gx"]

    @property
    def a_gz(self) -> Floats:
        """Vertical ground acceleration [m/s²], positive up."""
        return self.columns["a_gz"]

    @property
    def energy(self) -> Energy:
        """Energies [J]."""
        zeros = np.zeros(len(self))
        return Energy(**{part.name: self.columns.get(f"energy.{part.name}", zeros) for part in fields(Energy)})

    def to_frame(self) -> pandas.DataFrame:
        """Returns the columns as a pandas DataFrame with the index `t` [s].

        >>> import rocking_block as rb
        >>> rb.Block().run(theta=0.1, duration=1.0).to_frame().shape
        (101, 26)
        """
        with optional("to_frame", "pandas"):
            import pandas

        columns = {name: self.columns[name] for name in self.columns if name != "t"}
        return pandas.DataFrame(columns | {"regime": self.regime}, index=pandas.Index(self.t, name="t"))

    @overload
    def plot(self, ax: Axes, *, label: str | None = None, color: Any = None, **style: Any) -> Axes: ...
    @overload
    def plot(
        self, ax: Sequence[Axes] | None = None, *, label: str | None = None, color: Any = None, **style: Any
    ) -> npt.NDArray[Any]: ...
    def plot(self, ax: Any = None, *, label: str | None = None, color: Any = None, **style: Any) -> Any:
        """Draws rotation, corner reactions, slip and tensions if there are any, and ground acceleration over time with Matplotlib.

        Several runs can share axes; each has its own colour.

        Parameters
        ----------
        ax : Axes or sequence of Axes, optional
            Axes to draw on: one for the rotation alone, or three for rotation, reactions and ground acceleration. By
            default the panels of pyplot's current figure, if it is empty or shows other runs, or else those of a new
            figure.
        label : str, optional
            Name of the run in legends; by default the block's parameters.
        color, **style
            Colour of the rotation, and options of `Axes.plot` for it.

        Returns
        -------
        Axes or array of Axes
            The axes drawn on.
        """
        from rocking_block import _plot

        rotation = self.peak.theta / self.block.alpha
        summary = f"{self.outcome}, |θ|/α = {rotation:.4g}, {self.counts.impacts} impacts"
        return _plot.run(self.block, self.columns, summary, ax, label, color, style)

    def __repr__(self) -> str:
        rotation = self.peak.theta / self.block.alpha
        return (
            f"<Run {self.outcome} at {self.end_time:.4g} s, |θ|/α = {rotation:.4g}, {self.counts.impacts} impacts, "
            f"{len(self)} rows>"
        )

    def _repr_html_(self) -> str:
        peak, counts, weight = self.peak, self.counts, self.block.mass * self.block.g
        rows = [
            ("greatest |θ|/α", f"{peak.theta / self.block.alpha:.4g}"),
            ("greatest reaction of a corner", f"{peak.N:.4g} N, {peak.N / weight:.3g} of the weight"),
            ("greatest horizontal reaction", f"{peak.H:.4g} N"),
            ("greatest uplift", f"{peak.uplift:.4g} m"),
            ("impacts, lift-offs", f"{counts.impacts}, {counts.liftoffs}"),
            *([("greatest slip", f"{peak.slip:.4g} m")] if math.isfinite(self.block.friction) else []),
            *(
                (f"greatest {force_of(name).partition('.')[2]} of {name.replace('_', ' ')}", f"{force:.4g} N{', broken' if broken else ''}")
                for name, force, broken in zip(
                    links(self.block), peak.tensions + peak.damper_forces, self.broken, strict=True
                )
            ),
            ("rows", f"{len(self)}, to t = {self.t[-1]:.4g} s"),
        ]
        return html_table(f"{self.outcome} at {self.end_time:.4g} s: {self.block!r}", (), rows)
