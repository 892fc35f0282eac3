"""Blocks and ground motions → the table of their outcomes."""

from __future__ import annotations

import dataclasses
import hashlib
import os
import warnings
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import Executor
from typing import Any, get_args

import numpy as np
import numpy.typing as npt

from rocking_block import _engine, _parts
from rocking_block._pulse import Pulse, as_pulse
from rocking_block._record import Record, as_record
from rocking_block._table import Table
from rocking_block._tie import Damper, Tie, links
from rocking_block._words import OF_EVERY_BLOCK, Floats, Polarity, chosen, ticking

# One record or several, as objects or as files.
Records = Record | str | os.PathLike[str] | Iterable[Record | str | os.PathLike[str]]

# Parameters that a table of blocks defined by their dimensions has if they vary.
_DIMENSIONS = ("width", "height", "K", "C")
# Parameters that every table has if they vary.
_MORE_PARAMETERS = tuple(
    name for name in _engine.Block._names() if name not in (*OF_EVERY_BLOCK, *_DIMENSIONS) and hasattr(_engine.Block, name)
)
# Parameters of ties and dampers, by their kinds.
_OF_LINKS = {kind: tuple(field.name for field in dataclasses.fields(of)) for kind, of in (("tie", Tie), ("damper", Damper))}
# Columns of numbers that are made here.
_UNITS = {"scale": "1", "PGA.vertical": "m/s2", "2pi/p": "s", "omega_p/p": "1"}


def table_of_outcomes(
    many: _engine.Blocks,
    shape: tuple[int, ...],
    records: Records | None,
    vertical: Records | None,
    scale: npt.ArrayLike,
    periods: npt.ArrayLike,
    pulse: Pulse | None,
    g: float,
    friction_demand: float | None,
    options: dict[str, Any],
    threads: int | None,
    progress: bool | None,
    more: Mapping[str, Floats] | None = None,
    blocks: Sequence[_engine.Block] = (),
    parts: int | None = None,
    executor: Executor | None = None,
    polarity: Polarity = "as-recorded",
) -> Table:
    """Returns the table of the outcomes; `more` has further columns of the blocks, which an executor needs one by one."""
    horizontal, vertical_records = read_several("records", records, g), read_several("vertical", vertical, g)
    pulse = as_pulse(pulse)
    if not horizontal and not vertical_records and pulse is None:
        raise ValueError("nothing moves the ground; expected records or a pulse")
    if horizontal and vertical_records and len(horizontal) != len(vertical_records):
        raise ValueError(f"found {len(vertical_records)} vertical and {len(horizontal)} horizontal records; expected equal numbers")
    both = chosen("polarity", polarity, get_args(Polarity)) == "both"
    if both:
        if not horizontal:
            raise ValueError("polarity has no effect without horizontal records")
        horizontal = _in_both_polarities(horizontal)
        vertical_records = [record for record in vertical_records for _ in range(2)]
    number = max(len(horizontal), len(vertical_records), 1)
    nothing: list[Record | None] = [None] * number
    pairs = list(zip(horizontal or nothing, vertical_records or nothing, strict=True))
    scales = np.asarray(scale, dtype=np.float64)
    if scales.ndim > 1:
        raise ValueError(f"scale has shape {scales.shape}; expected a factor or a list of factors")
    if scales.size == 0:
        raise ValueError("scale = []; expected at least one factor")
    if len(np.unique(scales)) < scales.size:
        raise ValueError(f"scale = {scale!r}; expected each factor once")
    if not horizontal and not vertical_records and not np.array_equal(scales, 1.0):
        raise ValueError("scale has no effect without records")
    spectral_periods = np.atleast_1d(np.asarray(periods, dtype=np.float64)).tolist()
    if not horizontal and spectral_periods:
        raise ValueError("periods has no effect without horizontal records")
    factors = scales.ravel().tolist()
    settings = _parts.Settings(spectral_periods, g, pulse, friction_demand, options)
    if executor is not None:
        found, failure = _parts.outcomes(blocks, pairs, factors, settings, parts, executor, threads, progress)
    else:
        with ticking(progress) as tick:
            found, failure = _engine.outcomes(many, pairs, factors, *settings, threads, None, tick)

    def motion_column(values: Sequence[Any], count: int) -> npt.NDArray[Any]:
        """Returns a column of values of the records, or of the scales, repeated for each record."""
        return np.tile(np.repeat(np.array(values), len(many) * count), number * len(factors) // (len(values) * count))

    columns: dict[str, npt.ArrayLike] = {}
    names, vertical_names = named(horizontal), named(vertical_records)
    _warn_of_records(pairs, names or vertical_names, factors)
    if horizontal:
        columns["record"] = motion_column(names, len(factors))
    if vertical_records:
        columns["vertical"] = motion_column(vertical_names, len(factors))
    unnamed = [""] * number
    motions = _engine.motion_words(pairs, list(zip(names or unnamed, vertical_names or unnamed, strict=True)))
    if motions is not None:
        columns["motion"] = motion_column(motions, len(factors))
    if horizontal or vertical_records:
        columns["scale"] = motion_column(factors, 1)
    if vertical_records:
        pga = motion_column([record.pga for record in vertical_records], len(factors))
        columns["PGA.vertical"] = pga * np.abs(columns["scale"])
    columns["foundation"] = np.tile(np.array(many.foundations()), number * len(factors))
    of_blocks = {name: many.column(name) for name in OF_EVERY_BLOCK} | dict(more or {})
    columns.update({name: np.tile(column, number * len(factors)) for name, column in of_blocks.items()})
    frequencies = np.asarray(columns["p"])
    columns["2pi/p"] = 2 * np.pi / frequencies
    if pulse is not None:
        columns["omega_p/p"] = 2 * np.pi / pulse.period / frequencies
    units = {name: _UNITS.get(name) or _engine.parameter_unit(name) for name in columns if name in _UNITS or name in of_blocks}
    columns.update({name: values for name, _, values in found})
    units.update({name: unit for name, unit, _ in found if unit is not None})
    warn_of_failures(columns["outcome"], failure)
    single = not both and isinstance(vertical if records is None else records, Record | str | os.PathLike | None)
    axes = (*(() if single else (number,)), *scales.shape, *shape)
    return Table(columns, units, axes)


def varying(blocks: Sequence[_engine.Block]) -> dict[str, Floats]:
    """Returns the varying parameters beyond those of every table, by their names in the FMU; nan for a tie or damper that a block lacks."""
    by_dimensions = any("width" in block.parameters() for block in blocks)
    names = (*(_DIMENSIONS if by_dimensions else ()), *_MORE_PARAMETERS)
    columns = {name: np.array([getattr(block, name) for block in blocks]) for name in names}
    of_blocks = [links(block) for block in blocks]
    for link in dict.fromkeys(name for of_block in of_blocks for name in of_block):
        for name in _OF_LINKS[link.partition("_")[0]]:
            columns[f"{link}.{name}"] = np.array([getattr(of_block.get(link), name, np.nan) for of_block in of_blocks])
    return {name: column for name, column in columns.items() if len(np.unique(column)) > 1}


def _in_both_polarities(records: Sequence[Record]) -> list[Record]:
    """Returns each record, followed by the reversed one, under names that tell them to be one motion."""

    def of(record: Record, name: str, sign: float) -> Record:
        return Record(sign * record.acceleration, record.dt, name, record.start)

    pairs = ((of(record, name, 1.0), of(record, f"{name} (reversed)", -1.0)) for record, name in zip(records, named(records), strict=True))
    return [record for pair in pairs for record in pair]


def read_several(name: str, records: Records | None, g: float) -> list[Record]:
    if records is None:
        return []
    several = [records] if isinstance(records, Record | str | os.PathLike) else records
    listed = [as_record(name, record, g) for record in several]
    if not listed:
        raise ValueError(f"{name} = []; expected at least one")
    return listed


def named(records: Sequence[Record]) -> list[str]:
    """Returns names that tell different contents apart, here and in other tables: a missing name is a checksum of the content, and
    repeated names of different contents have it appended.
    """
    checksums = [_checksum(record) for record in records]
    contents: dict[str, set[str]] = {}
    for record, checksum in zip(records, checksums, strict=True):
        contents.setdefault(record.name, set()).add(checksum)

    def name(record: Record, checksum: str) -> str:
        if not record.name:
            return f"record {checksum}"
        return f"{record.name} ({checksum})" if len(contents[record.name]) > 1 else record.name

    return [name(record, checksum) for record, checksum in zip(records, checksums, strict=True)]


def _checksum(record: Record) -> str:
    """Returns a checksum of samples, time step and start."""
    content = np.concatenate([[record.dt, record.start], record.acceleration]).astype("<f8").tobytes()
    return hashlib.blake2b(content, digest_size=4).hexdigest()


def _warn_of_records(pairs: Sequence[tuple[Record | None, Record | None]], names: Sequence[str], scales: Sequence[float]) -> None:
    """Warns of equal records, which intervals count as one motion, of those given more than once, and of scales that amplify noise."""
    first: dict[tuple[str, ...], str] = {}
    repeated = []
    for pair, name in zip(pairs, names, strict=False):
        content = tuple("" if record is None else _checksum(record) for record in pair)
        if content not in first:
            first[content] = name
        elif first[content] != name:
            warnings.warn(f"{first[content]} and {name} hold the same samples: intervals count them as one motion", stacklevel=4)
        elif name not in repeated:
            repeated.append(name)
            warnings.warn(f"{name} is given more than once: its rows are made and counted as often", stacklevel=4)
    for doubt in _engine.strong_scales({"each record": max(map(abs, scales))} if names else {}):
        warnings.warn(doubt, stacklevel=4)


def warn_of_failures(found: npt.ArrayLike, failure: str | None, stacklevel: int = 3) -> None:
    if failure is not None:
        has_failed = np.asarray(found) == "failed"
        failed = np.flatnonzero(has_failed)
        message = f"{len(failed)} of {len(has_failed)} runs failed, the first in row {failed[0]}: {failure}"
        warnings.warn(message, RuntimeWarning, stacklevel=stacklevel)
