"""Buildings and the motions of their floors."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rocking_block import _engine
from rocking_block._record import Record, as_record
from rocking_block._words import Floats


class Building(_engine.Building):
    """An elastic building with classical damping: a shear building, or one of given modes.

    Attributes are `floors`, and for each mode `frequencies` [Hz], `damping` [1], `participation` [1] and `shapes` [1].

    Parameters
    ----------
    floor_masses : sequence of float
        Mass of each floor [kg], from the first floor up.
    storey_stiffnesses : sequence of float
        Lateral stiffness of the storey below each floor [N/m].
    frequencies : sequence of float
        Natural frequencies [Hz], instead of masses and stiffnesses.
    participation : sequence of float
        Participation factor of each mode, in the scale of its shape [1].
    shapes : sequence of sequences of float
        For each mode a value per floor, from the first floor up [1].
    damping : float or sequence of float
        Damping ratio of all modes, or of each, 0.001 to less than 1.
    rayleigh : (float, (int, int))
        Instead, damping proportional to mass and stiffness: a ratio and the two modes, from 1, that have it.

    Raises
    ------
    ValueError
        A parameter that is invalid; the message names it.

    Examples
    --------
    >>> import rocking_block as rb
    >>> building = rb.Building(floor_masses=[2e5, 2e5], storey_stiffnesses=[1e8, 1e8], damping=0.05)
    >>> building.frequencies.round(3)
    array([2.199, 5.758])
    """

    __slots__ = ()

    def __repr__(self) -> str:
        first = self.frequencies[0]
        return f"<Building {self.floors} floors, {len(self.frequencies)} modes: {first:.4g} Hz, {self.damping[0]:.3g} first>"


@dataclass(frozen=True, eq=False)
class FloorMotions:
    """The motions of some floors under a record; made by `floor_motions`."""

    floors: tuple[int, ...]
    """Numbers of the floors; 0 is the ground."""
    records: tuple[Record, ...]
    """Absolute horizontal acceleration of each floor, exact at its samples: the ground motion of a block that stands on it."""
    PFA: Floats
    """Peak floor acceleration of each floor [m/s²]: greatest absolute acceleration."""
    PFV: Floats
    """Peak floor velocity of each floor [m/s]: greatest absolute velocity, that of the ground included."""


def floor_motions(
    record: Record | str | os.PathLike[str], building: Building, floors: Sequence[int] | None = None, *, g: float = 9.81
) -> FloorMotions:
    """Computes the motions of the floors of a building under a horizontal record, once for all blocks on them.

    The result is exact for an acceleration that is linear between the samples of the record. It lasts until the free vibration of the
    building has decayed. Floors do not move vertically relative to the ground, and blocks do not act on the building.

    Parameters
    ----------
    record : Record or path
        Horizontal ground acceleration.
    building : Building
        The building.
    floors : sequence of int, optional
        Numbers of the floors, 0 for the ground; by default all floors above it.
    g : float
        Gravity that converts files in g [m/s²].

    Raises
    ------
    ValueError
        A floor that the building does not have.

    Examples
    --------
    >>> import rocking_block as rb
    >>> building = rb.Building(floor_masses=[2e5, 2e5], storey_stiffnesses=[1e8, 1e8], damping=0.05)
    >>> motions = rb.floor_motions(rb.Record([0.0, 3.0, -3.0, 0.0], dt=0.1), building)
    >>> motions.PFA.round(2)
    array([3.47, 4.27])
    >>> table = rb.outcomes(rb.blocks(alpha=0.2, p=[2.0, 3.0], eta=60, xi_v=0.1), motions.records)
    """
    ground = as_record("record", record, g)
    if not isinstance(building, _engine.Building):
        raise TypeError(f"building = {building!r}; expected a Building")
    chosen = list(range(1, building.floors + 1)) if floors is None else list(floors)
    for floor in chosen:
        if floor not in range(building.floors + 1):
            raise ValueError(f"floors has {floor}; expected floors from 0, the ground, to {building.floors}")
    motions = building.motions(ground)
    name = f"{ground.name}, " if ground.name else ""
    return FloorMotions(
        floors=tuple(chosen),
        records=tuple(Record(motions[floor][1], ground.dt, f"{name}floor {floor}", ground.start) for floor in chosen),
        PFA=np.array([motions[floor][2] for floor in chosen]),
        PFV=np.array([motions[floor][3] for floor in chosen]),
    )
