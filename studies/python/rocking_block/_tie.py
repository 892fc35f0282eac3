"""Ties and dampers between a block and the ground."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

from rocking_block._words import number

if TYPE_CHECKING:
    from rocking_block import _engine


@dataclass(frozen=True, kw_only=True)
class _Link:
    """A tie or a damper."""

    block_x: float = 0.0
    block_z: float = 0.0
    ground_x: float = 0.0
    ground_z: float = 0.0
    stiffness: float = 0.0
    damping: float = 0.0
    strength: float = 0.0
    yield_force: float = 0.0
    hardening: float = 0.0

    def __post_init__(self) -> None:
        """Refuses values that are no numbers, a stiffness of zero or below, and a damper with neither stiffness nor damping."""
        for field in fields(self):
            object.__setattr__(self, field.name, number(field.name, getattr(self, field.name)))
        is_dashpot = isinstance(self, Damper) and self.stiffness == 0.0
        if is_dashpot and not self.damping > 0.0:
            raise ValueError(f"stiffness = 0.0 and damping = {self.damping}; expected one of the damper > 0")
        if not is_dashpot and not self.stiffness > 0.0:
            kind = type(self).__name__.lower()
            raise ValueError(f"stiffness = {self.stiffness}; expected a stiffness of the {kind} > 0 N/m")


@dataclass(frozen=True, kw_only=True)
class Damper(_Link):
    """A damper, which pulls and pushes a point of the block along the line to a point of the ground.

    Coordinates are measured from the middle of the base of the block at rest without ties, x to the right and z up [m]. Elongated by s from its
    length there, a damper has the force k (s - s_p) + c ds/dt, positive in tension. The spring yields where its force reaches the lines
    r k s ± (1 - r) F_y, and the plastic elongation s_p grows then: kinematic hardening after Prager.

    Parameters
    ----------
    block_x, block_z : float
        Its end on the block [m].
    ground_x, ground_z : float
        Its end on the ground [m].
    stiffness : float
        Stiffness k [N/m]; 0 for a dashpot, which has a damping alone.
    damping : float
        Damping c [N s/m].
    strength : float
        Force at which it breaks for good, in tension and in compression [N]; 0 for one that does not break.
    yield_force : float
        Force F_y of the spring at which it yields first, in tension and in compression [N]; 0 for an elastic one.
    hardening : float
        Stiffness after yielding over that before, r [1], 0 <= r < 1. A damper of friction is a stiff one with r = 0.

    Examples
    --------
    >>> import rocking_block as rb
    >>> absorber = rb.Damper(block_x=-0.5, ground_x=-0.5, ground_z=-1.0, stiffness=2e6, yield_force=5e3, hardening=0.02)
    >>> rb.Block(mass=5000, dampers=[absorber]).dampers[0].yield_force
    5000.0
    """


@dataclass(frozen=True, kw_only=True)
class Tie(_Link):
    """A tendon, guy or restraint, which pulls a point of the block towards a point of the ground and never pushes.

    Coordinates are measured from the middle of the base of the block at rest without ties, x to the right and z up [m]. Stretched by s from its
    length there, minus the slack and plus pretension/stiffness, a tie pulls with k (s - s_p) + c ds/dt while s - s_p and this force are positive.

    Parameters
    ----------
    block_x, block_z : float
        Its end on the block [m].
    ground_x, ground_z : float
        Its end on the ground [m].
    stiffness : float
        Stiffness k [N/m], > 0.
    pretension : float
        Tension at its length at rest [N].
    slack : float
        Stretch beyond its length at rest before it pulls, without pretension [m].
    damping : float
        Damping c [N s/m].
    strength : float
        Tension at which it breaks for good [N]; 0 for an unbreakable tie.
    yield_force : float
        Tension of the spring at which it yields first [N]; 0 for an elastic tie. The plastic elongation s_p follows the law of `Damper`.
    hardening : float
        Stiffness after yielding over that before [1], 0 <= r < 1.

    Examples
    --------
    >>> import rocking_block as rb
    >>> guy = rb.Tie(block_z=3.0, ground_x=4.0, stiffness=2e5, slack=0.01)
    >>> rb.Block(mass=5000, ties=[guy]).ties[0].ground_x
    4.0
    """

    pretension: float = 0.0
    slack: float = 0.0


def force_of(link: str) -> str:
    """Returns the column of the force of a tie or a damper with this name."""
    return f"{link}.tension" if link.startswith("tie") else f"{link}.force"


def links(block: _engine.Block) -> dict[str, Tie | Damper]:
    """Returns the ties and dampers of a block by their names in the FMU, in the order of the engine."""
    of_kind: list[tuple[str, Tie | Damper]] = [(f"tie_{i}", tie) for i, tie in enumerate(block.ties, 1)]
    return dict(of_kind + [(f"damper_{i}", damper) for i, damper in enumerate(block.dampers, 1)])
