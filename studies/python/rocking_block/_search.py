"""Searches for the values at which the outcome of a run changes."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any

from rocking_block import _engine
from rocking_block._pulse import Pulse, as_pulse
from rocking_block._record import Record, as_record
from rocking_block._words import OnSeparation, number, run_options, ticking


@dataclass(frozen=True)
class Search:
    """The result of a search.

    Outcomes of rocking blocks are not monotonic: a block may survive a strong pulse and overturn under a weaker one.
    """

    parameter: str
    """Name and unit of the searched parameter."""
    least: float | None
    """The value found; None if the range has none."""
    bound: str
    """How `least` bounds the true value.

    "none" if `least` is the true value; "upper" if the range begins at it, so that the true value is at most that (or
    runs below it failed); "lower" if the true value lies beyond the range.
    """
    stretches: tuple[tuple[float, float, str], ...]
    """Intervals of equal outcome, in order: from, to, outcome."""
    spacing: float
    """Distance between the scanned values; a narrower interval may be missed."""
    resolution: float
    """Width to which each change is bisected."""

    def __repr__(self) -> str:
        bound = {"upper": "at most ", "lower": "more than "}.get(self.bound, "")
        least = "none in the range" if self.least is None else f"{bound}{self.least:.6g}"
        stretches = "; ".join(f"{outcome} {low:.6g} to {high:.6g}" for low, high, outcome in self.stretches[:5])
        more = f"; {len(self.stretches) - 5} more" if len(self.stretches) > 5 else ""
        return f"<Search over {self.parameter}: least {least}; {stretches}{more}>"


def search_overturning(
    block: _engine.Block | _engine.BlockInSpace,
    *,
    pulse: Pulse | None = None,
    record: Record | str | os.PathLike[str] | None = None,
    record_y: Record | str | os.PathLike[str] | None = None,
    vertical: Record | str | os.PathLike[str] | None = None,
    azimuth: float = 0.0,
    from_: float | None = None,
    to: float | None = None,
    points: int = 201,
    resolution: float = 1e-6,
    tolerance: float = 1e-6,
    on_separation: OnSeparation = "fly",
    threads: int | None = None,
    progress: bool | None = None,
) -> Search:
    """Finds the least amplitude of a pulse, or factor on a record, that overturns a block.

    It scans a range of strengths and bisects every change of outcome that the scan finds, as `rocking search
    overturning` does.

    Parameters
    ----------
    block : Block or BlockInSpace
        The block, in the plane or in space.
    pulse : Pulse
        Shape, period and start of a pulse. Its own amplitude is ignored; the search is over the amplitude [m/s²].
    record, vertical : Record or path
        Records instead of a pulse; the search is over the factor on them [1].
    record_y : Record or path
        Second horizontal component of a block in space, a quarter turn ahead of `record`.
    azimuth : float
        Direction of `record` or of the pulse for a block in space, from +x towards +y [degrees].
    from_, to : float, optional
        Range of the amplitude or factor. By default it ends at ten times a PGA of g tan α, in space over the nearest edge. It begins at 0
        or, on a rigid base without a vertical record, at g tan α, below which no block rocks there.
    points : int
        Number of scanned values, evenly spaced.
    resolution : float
        Width to which a change is bisected, in the unit of the amplitude or factor.
    tolerance : float
        As in `Block.run`; looser by default, which is enough for outcomes.
    on_separation
        As in `Block.run`.
    threads : int, optional
        Number of threads; by default one per core.
    progress : bool, optional
        Whether to show a tqdm progress bar.

    Raises
    ------
    ValueError
        An invalid option.

    Examples
    --------
    >>> import rocking_block as rb
    >>> block = rb.Block(alpha=0.25, p=1.0, foundation="rigid")
    >>> found = rb.search_overturning(block, pulse=rb.Pulse("one-sine", period=1.2566), points=41)
    >>> f"{found.least:.4f} m/s²"
    '7.2226 m/s²'
    >>> pillar = rb.BlockInSpace(width=0.4, depth=0.8, height=2.0, eta=60, xi_v=0.2)
    >>> sine = rb.Pulse("one-sine", period=0.5)
    >>> found = [rb.search_overturning(pillar, pulse=sine, azimuth=azimuth, points=21, resolution=1e-2) for azimuth in (0, 90)]
    >>> [f"{search.least:.1f} m/s²" for search in found]
    ['4.5 m/s²', '14.4 m/s²']
    """
    scan = _scan(from_, to, points, resolution, threads)
    options = run_options(tolerance, on_separation)
    if not isinstance(block, _engine.Block | _engine.BlockInSpace):
        raise TypeError(f"block = {block!r}; expected a Block or a BlockInSpace")
    pulse = as_pulse(pulse)
    given = {"record": record, "record_y": record_y, "vertical": vertical}
    components = [None if found is None else as_record(name, found, block.g) for name, found in given.items()]
    direction = number("azimuth", azimuth)
    with ticking(progress) as tick:
        found = _engine.search_overturning(block, pulse, components, direction, scan, options, tick)
    least, bound, stretches, spacing = found
    parameter = "scale [1]" if pulse is None else "a_p [m/s2]"
    return Search(parameter, least, bound, tuple(stretches), spacing, resolution)


def search_damping(
    block: _engine.Block,
    *,
    rate: float = 0.95,
    from_: float = 0.0,
    to: float = 1.0,
    points: int = 201,
    resolution: float = 1e-6,
    tolerance: float = 1e-6,
    threads: int | None = None,
    progress: bool | None = None,
) -> Search:
    """Finds the least damping ratio ξ_v above which a block in free vibration never separates.

    This is Figure 9 of Palmeri & Makris (2008), as computed by `rocking search damping`.

    Parameters
    ----------
    block : Block
        The block on viscoelastic supports; its own ξ_v is ignored.
    rate : float
        Rate of rotation at the start over α p [1].
    from_, to : float
        Range of ξ_v [1].
    points, resolution, tolerance, threads, progress
        As in `search_overturning`.

    Raises
    ------
    ValueError
        An invalid option, or a rigid base.
    """
    scan = _scan(from_, to, points, resolution, threads)
    options = run_options(tolerance, "terminate")
    with ticking(progress) as tick:
        least, bound, stretches, spacing = _engine.search_damping(block, rate, scan, options, tick)
    return Search("xi_v [1]", least, bound, tuple(stretches), spacing, resolution)


def _scan(
    from_: float | None, to: float | None, points: int, resolution: float, threads: int | None
) -> dict[str, Any]:
    return {"from": from_, "to": to, "points": points, "resolution": resolution, "threads": threads}
