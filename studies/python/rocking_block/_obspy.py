"""Traces of ObsPy → samples, unit and name. ObsPy itself is not needed here."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from rocking_block import _engine

if TYPE_CHECKING:
    from collections.abc import Iterable

    from rocking_block._words import Floats

# Units of ground motions in responses, without blanks and brackets; those of accelerations as the units of this package.
RESPONSE_UNITS = {"M/S**2": "m/s2", "M/S^2": "m/s2", "M/S/S": "m/s2", "CM/S**2": "cm/s2", "CM/S^2": "cm/s2", "CM/S/S": "cm/s2"}
NAMED = 'unit="m/s2" or another, the unit of trace.data'


def samples_of(trace: Any, unit: str | None, g: float) -> tuple[Floats, float, str]:
    """Returns samples [m/s²], time step [s] and name of a trace; refuses gaps and samples in an unknown unit."""
    check_trace(trace)
    stats = trace.stats
    name = f"{trace.id} {stats.starttime}"
    refuse_masked(trace.data, f"{name}: ", lambda i: f" at {stats.starttime + i * stats.delta}")
    samples = np.asarray(trace.data, dtype=np.float64)
    if unit is None:
        unit, sensitivity = unit_of(stats, name)
        samples = samples / sensitivity
    return samples * _engine.unit_factor(unit, g), float(stats.delta), name


def check_trace(trace: object) -> None:
    """Refuses whatever is no trace."""
    if not hasattr(trace, "stats") or not hasattr(trace, "data"):
        raise TypeError(f"trace = {trace!r}; expected a Trace of ObsPy; records_from takes a Stream")


def refuse_masked(data: object, name: str, place: Any = lambda _: "") -> None:
    """Refuses a masked array with masked samples: numpy drops the mask, and gaps become samples."""
    if not isinstance(data, np.ma.MaskedArray):
        return
    masked = np.flatnonzero(np.ma.getmaskarray(data))
    if len(masked):
        first = int(masked[0])
        message = f"{name}sample {first}{place(first)} is masked, the first of {len(masked)}: a gap"
        raise ValueError(f"{message}; expected a value for each sample")


def unit_of(stats: Any, name: str) -> tuple[str, float]:
    """Returns the unit of a trace and the samples in one of it, from its response and the steps of its processing."""
    steps = [step.split(": ", 1)[-1] for step in stats.get("processing", [])]
    if any(step.startswith(("differentiate(", "integrate(")) for step in steps):
        raise ValueError(f"{name}: its samples were differentiated or integrated; expected {NAMED}")
    removed = next((step for step in steps if step.startswith(("remove_response(", "remove_sensitivity("))), "")
    output = removed.partition("output='")[2].partition("'")[0]
    if output == "ACC":
        return "m/s2", 1.0
    if output in ("VEL", "DISP"):
        raise ValueError(f"{name}: its response was removed with output='{output}'; expected output='ACC'")
    sensitivity = getattr(stats.get("response"), "instrument_sensitivity", None)
    if sensitivity is None:
        calib = f", and stats.calib = {stats.calib:g}" if stats.calib != 1.0 else ""
        raise ValueError(f"{name}: no response with a sensitivity{calib}; expected {NAMED}")
    stated = str(sensitivity.input_units)
    unit = RESPONSE_UNITS.get("".join(c for c in stated.upper() if c not in " ()"))
    if unit is None:
        message = f"{name}: its sensor measures {stated}"
        raise ValueError(f"{message}; expected M/S**2, or trace.remove_response(output='ACC') before")
    if removed:
        return unit, 1.0
    value = sensitivity.value
    if not value or not np.isfinite(value):
        raise ValueError(f"{name}: the sensitivity of its response is {value}; expected a number other than 0")
    return unit, float(value)


def check_gaps(stream: Iterable[Any]) -> list[Any]:
    """Returns the traces of a stream in its order; refuses several of one channel, with the place of the gap between them."""
    # A text is iterable, too.
    if isinstance(stream, str | bytes) or not hasattr(stream, "__iter__"):
        raise TypeError(f"stream = {stream!r}; expected a Stream of ObsPy or a list of traces")
    traces = list(stream)
    by_channel: dict[str, list[Any]] = {}
    for trace in traces:
        check_trace(trace)
        by_channel.setdefault(trace.id, []).append(trace)
    for name, parts in by_channel.items():
        for before, after in pairwise(sorted(parts, key=lambda trace: trace.stats.starttime)):
            end, start, step = before.stats.endtime, after.stats.starttime, before.stats.delta
            gap = float(start - end) - step
            if gap > step / 2:
                raise ValueError(f"{name}: a gap of {gap:.6g} s from {end} to {start}; expected none")
            if gap < -step / 2:
                raise ValueError(f"{name}: an overlap of {-gap:.6g} s from {start} to {end}; expected none")
            raise ValueError(f"{name}: two traces meet at {start}; expected one, as stream.merge() makes it")
    return traces
