"""Ties between a block and the ground."""

from __future__ import annotations

from dataclasses import dataclass, fields

from rocking_block._words import number


@dataclass(frozen=True, kw_only=True)
class Tie:
    """A tendon, guy or restraint, which pulls a point of the block towards a point of the ground and never pushes.

    Coordinates are measured from the middle of the base of the block at rest without ties, x to the right and z up [m]. Stretched by s from its
    length there, minus the slack and plus pretension/stiffness, a tie pulls with k s + c ds/dt while s and this force are positive.

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

    Examples
    --------
    >>> import rocking_block as rb
    >>> guy = rb.Tie(block_z=3.0, ground_x=4.0, stiffness=2e5, slack=0.01)
    >>> rb.Block(ties=[guy]).ties[0].ground_x
    4.0
    """

    block_x: float = 0.0
    block_z: float = 0.0
    ground_x: float = 0.0
    ground_z: float = 0.0
    stiffness: float
    pretension: float = 0.0
    slack: float = 0.0
    damping: float = 0.0
    strength: float = 0.0

    def __post_init__(self) -> None:
        for field in fields(self):
            object.__setattr__(self, field.name, number(field.name, getattr(self, field.name)))
        if not self.stiffness > 0.0:
            raise ValueError(f"stiffness = {self.stiffness}; expected a stiffness of the tie > 0 N/m")
