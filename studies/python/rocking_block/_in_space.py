"""A block in space, shaken in three directions."""

from __future__ import annotations

import itertools
import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import numpy.typing as npt

from rocking_block import _engine
from rocking_block._outcomes import Records, named, read_several, warn_of_failures
from rocking_block._pulse import Pulse, as_pulse
from rocking_block._record import Record, as_record
from rocking_block._table import Table
from rocking_block._words import Floats, OnOverturning, OnSeparation, Outcome, number, optional, run_options, ticking

if TYPE_CHECKING:
    import pandas
    from typing_extensions import Self


class BlockInSpace(_engine.BlockInSpace):
    """An immutable rigid block on feet in space, each a viscoelastic support with friction.

    x is to the right, y away from the viewer, z up. The base is a rectangle of four feet, a circle of feet, or a list of feet. `alpha`, `p`,
    `eta` and `width` are those of the motion along x. Which parameters belong together is as in `rocking simulate`.

    Parameters
    ----------
    alpha, p, width, height, center_height, eta, xi_v, K, C, mass, gamma, g, eccentricity : float
        As in `Block`; `K` and `C` are those of one foot.
    depth : float, optional
        Depth of a rectangular base, across `width` [m]; by default the width.
    depth_ratio : float, optional
        Depth over width, instead of `depth` [1].
    base : {"rectangle", "circle"}
        Shape of the base.
    feet : int, array of shape (n, 2) or (n, 3), or path, optional
        Number of feet of a circle, 3 to 64, by default 32; or x and y of each foot from the centre of mass and, if any, the gap below it [m].
        Such a block needs `center_height`, `inertia_tensor`, `mass`, and `omega_v` or `K` and `C`.
    inertia_tensor : sequence of 3 or 6 floats, optional
        I_xx, I_yy, I_zz about the centre of mass and, if any, the entries xy, xz, yz of the tensor [kg m²], instead of `gamma`.
    eccentricity_y : float, optional
        Distance of the centre of mass from the middle of the base along y [m]; `eccentricity` is that along x.
    omega_v : float, optional
        Circular frequency of the block that moves vertically on its feet [rad/s], instead of `eta`.
    kappa : float, default 1
        Horizontal over vertical stiffness of a foot [1].
    xi_h : float, optional
        Horizontal damping ratio of the feet [1]; by default `xi_v`.
    friction : float, optional
        Coulomb's coefficient of friction μ of the feet [1]; by default 10, which no foot reaches.

    Raises
    ------
    ValueError
        A parameter that is invalid, has no effect, or exists in the plane only; the message names it.

    Examples
    --------
    >>> import rocking_block as rb
    >>> rb.BlockInSpace(width=0.5, depth=0.8, height=2.0, eta=60)
    <BlockInSpace on 4 feet, 1000 kg: alpha=0.244979, p=2.67167, omega_v=160.3, xi_v=0.1, kappa=1, friction=10>
    >>> rb.BlockInSpace(alpha=0.2, p=2.0, foundation="rigid")
    Traceback (most recent call last):
        ...
    ValueError: foundation="rigid" is for a block in the plane; in space a block stands on feet; expected eta of 100 to 300 for a hard base
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
        depth: float | None = None,
        depth_ratio: float | None = None,
        height: float | None = None,
        center_height: float | None = None,
        base: Literal["rectangle", "circle"] | None = None,
        feet: int | npt.ArrayLike | str | os.PathLike[str] | None = None,
        inertia_tensor: Sequence[float] | None = None,
        eccentricity: float | None = None,
        eccentricity_y: float | None = None,
        omega_v: float | None = None,
        K: float | None = None,
        C: float | None = None,
        kappa: float | None = None,
        xi_h: float | None = None,
        friction: float | None = None,
        mass: float | None = None,
        gamma: float | None = None,
        g: float | None = None,
        **of_the_plane: Any,
    ) -> Self:
        """Returns the block of these parameters, which the engine checks."""
        given = {name: value for name, value in locals().items() if name not in ("cls", "of_the_plane")} | of_the_plane
        if feet is not None and not isinstance(feet, int | str | os.PathLike):
            given["feet"] = np.asarray(feet, dtype=np.float64).tolist()
        if inertia_tensor is not None:
            given["inertia_tensor"] = np.asarray(inertia_tensor, dtype=np.float64).tolist()
        return _engine.BlockInSpace.__new__(cls, **given)

    def replace(self, **changes: Any) -> BlockInSpace:
        """Returns the block with some parameters replaced; None drops one."""
        return BlockInSpace(**(self.parameters() | changes))

    __replace__ = replace

    @property
    def feet(self) -> Floats:
        """x and y of each foot from the centre of mass, and its gap [m], of shape (n, 3)."""
        return np.array(self._feet)

    @property
    def inertia(self) -> Floats:
        """Inertia tensor about the centre of mass [kg m²], of shape (3, 3)."""
        xx, yy, zz, xy, xz, yz = self._inertia
        return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])

    def run(
        self,
        x: Record | str | os.PathLike[str] | None = None,
        *,
        y: Record | str | os.PathLike[str] | None = None,
        vertical: Record | str | os.PathLike[str] | None = None,
        scale: float = 1.0,
        azimuth: float = 0.0,
        pulse: Pulse | None = None,
        tilt_x: float = 0.0,
        tilt_y: float = 0.0,
        twist: float = 0.0,
        omega_x: float = 0.0,
        omega_y: float = 0.0,
        omega_z: float = 0.0,
        v: float | None = None,
        v_dot: float | None = None,
        tolerance: float = 1e-8,
        on_separation: OnSeparation = "fly",
        on_overturning: OnOverturning = "terminate",
        duration: float | None = None,
        step: float | None = None,
        progress: bool | None = None,
    ) -> RunInSpace:
        """Simulates the block under records or a pulse, or in free motion.

        Results equal those of `rocking simulate` with the same parameters to the last bit.

        Parameters
        ----------
        x, y, vertical : Record or path, optional
            Components of the ground acceleration, each followed exactly. They need equal time steps, starts and lengths.
        scale : float
            Factor on all components [1].
        azimuth : float
            Direction of `x` and of the pulse from +x towards +y, which turns `y`, if any, with them [degrees].
        pulse : Pulse, optional
            A horizontal pulse, alone or added to the records.
        tilt_x, tilt_y, twist : float
            Components of the tilt, and twist before it, at the start [rad].
        omega_x, omega_y, omega_z : float
            Angular velocity at the start [rad/s].
        v, v_dot, tolerance, on_separation, on_overturning, duration, step, progress
            As in `Block.run`.

        Raises
        ------
        ValueError
            An invalid option, components that do not belong together, no excitation, or a failed run.

        Examples
        --------
        >>> import rocking_block as rb
        >>> run = rb.BlockInSpace(width=0.5, depth=0.8, height=2.0, eta=60).run(pulse=rb.Pulse("one-sine", 3.5, 0.6), azimuth=30)
        >>> run
        <RunInSpace completed at 2.846 s, θ/α = 0.3696, 15 landings, 286 rows>
        """
        initial: dict[str, float | None] = {"tilt_x": tilt_x, "tilt_y": tilt_y, "twist": twist}
        initial |= {"omega_x": omega_x, "omega_y": omega_y, "omega_z": omega_z, "v": v, "v_dot": v_dot}
        initial = {name: None if value is None else number(name, value) for name, value in initial.items()}
        options = run_options(tolerance, on_separation, on_overturning, duration, step)
        given = {"x": x, "y": y, "vertical": vertical}
        components = [None if record is None else as_record(name, record, self.g) for name, record in given.items()]
        factor, direction = number("scale", scale), number("azimuth", azimuth)
        with ticking(progress) as tick:
            result = _engine.history_in_space(self, components, factor, direction, as_pulse(pulse), initial, options, tick)
        return RunInSpace.of(self, result)

    def outcomes(
        self,
        x: Records | None = None,
        *,
        y: Records | None = None,
        vertical: Records | None = None,
        scale: npt.ArrayLike = 1.0,
        azimuth: npt.ArrayLike = 0.0,
        periods: npt.ArrayLike = (),
        pulse: Pulse | None = None,
        tolerance: float = 1e-6,
        on_separation: OnSeparation = "fly",
        duration: float | None = None,
        threads: int | None = None,
        progress: bool | None = None,
    ) -> Table:
        """Returns the outcome of the block under each motion, at each scale and azimuth.

        Parameters
        ----------
        x, y, vertical : Record, path, or several, optional
            Components of one or several motions, in the same order.
        scale, azimuth : float or sequence of floats
            Factors on all components [1], and directions of `x` from +x towards +y [degrees].
        periods : array_like
            Periods of further measures, the spectral accelerations Sa and velocities Sv [s].
        pulse : Pulse, optional
            A horizontal pulse, alone or added to the records.
        tolerance, on_separation, duration, threads, progress
            As in `outcomes`.

        Returns
        -------
        Table
            A row for each motion, scale and azimuth, in this order, with the measures of both components, the outcome, the peaks and
            the counts of events: the columns of a sweep of blocks in space.

        Examples
        --------
        >>> import numpy as np
        >>> import rocking_block as rb
        >>> block = rb.BlockInSpace(width=0.3, depth=0.6, height=2.0, eta=60)
        >>> table = block.outcomes(pulse=rb.Pulse("one-sine", 3.0, 0.6), azimuth=[0, 45, 90])
        >>> table["outcome"].tolist()
        ['overturned', 'completed', 'completed']
        """
        several = {"x": x, "y": y, "vertical": vertical}
        components = {name: read_several(name, records, self.g) for name, records in several.items()}
        counts = {name: len(records) for name, records in components.items() if records}
        if not counts and pulse is None:
            raise ValueError("nothing moves the ground; expected records or a pulse")
        if len(set(counts.values())) > 1:
            found = ", ".join(f"{count} of {name}" for name, count in counts.items())
            raise ValueError(f"found {found}; expected equal numbers of components")
        count = max(counts.values(), default=1)
        nothing: list[Record | None] = [None] * count
        motions = list(zip(*(records or nothing for records in components.values()), strict=True))
        scales, azimuths = (_numbers(name, values) for name, values in (("scale", scale), ("azimuth", azimuth)))
        if not counts and scales != [1.0]:
            raise ValueError("scale has no effect without records")
        options = run_options(tolerance, on_separation, duration=duration)
        spectral_periods = np.atleast_1d(np.asarray(periods, dtype=np.float64)).tolist()
        with ticking(progress) as tick:
            of_runs, failure = _engine.outcomes_in_space(
                self, motions, scales, azimuths, spectral_periods, as_pulse(pulse), options, threads, tick
            )
        each = list(itertools.product(range(count), scales, azimuths))
        columns: dict[str, npt.ArrayLike] = {}
        headings = {"x": "record", "y": "record_y", "vertical": "vertical"}
        for name, records in components.items():
            if records:
                names = named(records)
                columns[headings[name]] = np.array([names[motion] for motion, _, _ in each])
        if counts:
            columns["scale"] = np.array([factor for _, factor, _ in each])
        columns["azimuth"] = np.array([direction for _, _, direction in each])
        columns |= {name: values for name, _, values in of_runs}
        warn_of_failures(columns["outcome"], failure)
        units = {"scale": "1", "azimuth": "deg"} | {name: unit for name, unit, _ in of_runs if unit is not None}
        return Table(columns, {name: unit for name, unit in units.items() if name in columns})

    def __repr__(self) -> str:
        names = ("alpha", "p", "omega_v", "xi_v", "kappa", "friction")
        numbers = ", ".join(f"{name}={getattr(self, name):.6g}" for name in names)
        return f"<BlockInSpace on {len(self.foot_names)} feet, {self.mass:g} kg: {numbers}>"


def _numbers(name: str, values: npt.ArrayLike) -> list[float]:
    """Returns one or several numbers as a list."""
    array = np.atleast_1d(np.asarray(values, dtype=np.float64))
    if array.ndim > 1 or array.size == 0:
        raise ValueError(f"{name} has shape {np.shape(values)}; expected a number or a list of numbers")
    numbers: list[float] = array.tolist()
    return numbers


@dataclass(frozen=True)
class EventInSpace:
    """A change of contact of a foot."""

    t: float
    """Time [s]."""
    event: str
    """"lift-off", "landing", "slides", "sticks" or "overturning"."""
    foot: str | None
    """Name of the foot: "SW", "NW", "SE" or "NE" of a rectangle, with y to the north, else its number from 1."""


@dataclass(frozen=True)
class PeakInSpace:
    """Largest values of a run, including those between its rows."""

    tilt: float
    """Angle between the block's axis and the vertical [rad]."""
    tilt_over_alpha: float
    """Tilt over the critical tilt in the direction of the lean, at which the centre of mass stands over an edge of the base [1]."""
    twist: float
    """Rotation about the vertical, in either sense [rad]."""
    uplift: float
    """Height of a foot above its support [m]."""
    N: float
    """Vertical reaction of a foot [N]."""
    slip: float
    """Way that a foot has slid [m]."""
    drift: float
    """Distance of the middle of the base from its initial place [m]."""


@dataclass(frozen=True)
class CountsInSpace:
    """Counters of a run."""

    lift_offs: int
    landings: int
    slides: int
    sticks: int
    steps: int
    """Accepted steps of the integrator."""
    rejected: int
    """Rejected steps, repeated with a smaller size."""
    evaluations: int
    """Evaluations of the equations of motion."""


@dataclass(frozen=True, eq=False, repr=False)
class RunInSpace:
    """The history of a block in space, in rows at evenly spaced times and at the end of the run; made by `BlockInSpace.run`.

    `run["tilt"]` gives a column by its name, an array of shape (n,) in SI units, with angles in radians: those of the table of `rocking
    simulate`, among them `tilt`, `tilt/alpha` over the critical tilt, `tilt_x`, `tilt_y`, `azimuth` and `twist`, and of each foot `N`, `uplift`, `slip` and `slides`, as in
    `run["N_SW"]`.
    """

    block: BlockInSpace
    """The block."""
    columns: dict[str, Floats]
    """All columns by name."""
    units: dict[str, str]
    """Their units."""
    events: tuple[EventInSpace, ...]
    """Events in order of time."""
    peak: PeakInSpace
    """Largest values."""
    counts: CountsInSpace
    """Counters."""
    outcome: Outcome
    """How the run ended, as in `Run.outcome`."""
    end_time: float
    """End of the run [s]."""
    is_at_rest: bool
    """Whether ground and block are at rest at the end."""
    separated: bool
    """Whether no foot touched at some time."""

    @staticmethod
    def of(block: BlockInSpace, result: dict[str, Any]) -> RunInSpace:
        """Builds a run from the engine's result."""
        for column in result["columns"].values():
            column.setflags(write=False)
        made = {
            "events": tuple(EventInSpace(*event) for event in result["events"]),
            "peak": PeakInSpace(*result["peak"]),
            "counts": CountsInSpace(*itertools.chain(*result["counts"])),
        }
        return RunInSpace(block=block, **(result | made))

    def __getitem__(self, name: str) -> Floats:
        return self.columns[name]

    def __len__(self) -> int:
        return len(self.t)

    @property
    def t(self) -> Floats:
        """Time [s]."""
        return self.columns["t"]

    @property
    def tilt(self) -> Floats:
        """Angle between the block's axis and the vertical [rad]."""
        return self.columns["tilt"]

    @property
    def twist(self) -> Floats:
        """Rotation about the vertical [rad], positive from +x towards +y."""
        return self.columns["twist"]

    def plot(self) -> npt.NDArray[Any]:
        """Draws tilt, twist, forces and slips of the feet, and ground acceleration over time with Matplotlib, in a new figure.

        Of more than four feet the range of their forces and slips is drawn.

        Returns
        -------
        array of Axes
            The panels.
        """
        from rocking_block import _plot_in_space

        return _plot_in_space.run(self)

    def to_frame(self) -> pandas.DataFrame:
        """Returns the columns as a pandas DataFrame with the index `t` [s]."""
        with optional("to_frame", "pandas"):
            import pandas

        columns = {name: column for name, column in self.columns.items() if name != "t"}
        return pandas.DataFrame(columns, index=pandas.Index(self.t, name="t"))

    def __repr__(self) -> str:
        return (
            f"<RunInSpace {self.outcome} at {self.end_time:.4g} s, θ/α = {self.peak.tilt_over_alpha:.4g}, "
            f"{self.counts.landings} landings, {len(self)} rows>"
        )
