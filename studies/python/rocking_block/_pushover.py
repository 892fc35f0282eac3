"""The lateral force of a block over a slow rotation, and the loop of a cycle."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from rocking_block import _engine
from rocking_block._table import Table
from rocking_block._words import number

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True)
class Landmark:
    """A named point of a curve."""

    name: str
    """What happens: "at rest", "L lifts", "tie 1 yields", "greatest force", "balance" and so on."""
    theta: float
    """Rotation [rad], positive to the right."""
    u: float
    """Displacement of the centre of mass [m], positive to the right."""
    force: float
    """Lateral force at the centre of mass [N], positive to the right."""
    moment: float
    """Its moment about the foot [N.m], positive clockwise."""


@dataclass(frozen=True, eq=False)
class Cycle:
    """A closed cycle of rotations between ±amplitude, after a first one."""

    amplitude: float
    """Amplitude [rad]."""
    table: Table
    """The first rotation to the amplitude and the closed cycle after it, in the columns of `Pushover.table`."""
    energy: dict[str, float]
    """Energy lost by yielding in the closed cycle [J], by the names of ties and dampers."""
    energy_before: dict[str, float]
    """That before the closed cycle [J]."""
    equivalent_damping: float
    """Equivalent viscous damping ratio of yielding alone [1]: `E_D/(2π M_A A)`, with the energy E_D lost in a cycle of amplitude A and the mean M_A
    of the moments at its ends (Jacobsen 1930). Landings take energy beside it. NaN where the moments do not resist."""
    recentring_ratio: float
    """Moment of weight, supports and ties over that of the dampers at the amplitude [1]; infinite without dampers. Above 1 a lifted
    corner lands again; on supports `residual_theta` may remain."""
    residual_theta: float
    """Greatest rotation left when the lateral force is taken away slowly after the amplitude [rad]."""


@dataclass(frozen=True, eq=False, repr=False)
class Pushover:
    """The lateral force of a block over a slow rotation; made by `Block.pushover`."""

    block: _engine.Block
    """The block."""
    table: Table
    """Rows along the curve, two at one rotation where the force jumps: theta, u, v, moment, force, force/weight, N_L, N_R, H, regime,
    and the force and moment of each tie and damper."""
    landmarks: tuple[Landmark, ...]
    """The landmarks, in order."""
    cycle: Cycle | None
    """The cycle, for a given amplitude."""

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draws the lateral force over the rotation, with the landmarks and the cycle, with Matplotlib.

        Parameters
        ----------
        ax : Axes, optional
            Axes to draw on; by default those of a new figure.
        """
        from rocking_block import _plot

        of_cycle = None if self.cycle is None else self.cycle.table
        return _plot.pushover(self.table, self.landmarks, of_cycle, self.block.mass * self.block.g, ax)

    def __repr__(self) -> str:
        names = ", ".join(f"{landmark.name} at {landmark.theta:.4g}" for landmark in self.landmarks[1:])
        cycle = "" if self.cycle is None else f"; ξ_eq = {self.cycle.equivalent_damping:.4g} at ±{self.cycle.amplitude:.4g} rad"
        return f"<Pushover of {self.table.rows} rows: {names}{cycle}>"


def pushover(
    block: _engine.Block, side: str, to: float | None, amplitude: float | None, points: int
) -> Pushover:
    """Turns a block slowly over a corner, then in cycles if there is an amplitude."""
    to = None if to is None else number("to", to)
    amplitude = None if amplitude is None else number("amplitude", amplitude)
    columns, landmarks, found = _engine.pushover(block, side, to, amplitude, points)
    cycle = None
    if amplitude is not None and found is not None:
        of_cycle, energy, damping, recentring, residual = found
        closed, before = ({name: pair[which] for name, *pair in energy} for which in (0, 1))
        cycle = Cycle(amplitude, _table(of_cycle), closed, before, damping, recentring, residual)
    return Pushover(block, _table(columns), tuple(Landmark(*each) for each in landmarks), cycle)


def _table(columns: list[_engine._Column]) -> Table:
    units = {name: unit for name, unit, _ in columns if unit is not None}
    return Table({name: values for name, _, values in columns}, units)
