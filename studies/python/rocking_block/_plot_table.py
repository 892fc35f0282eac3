"""Pictures of tables."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from rocking_block import _engine
from rocking_block._plot import _COLOURS, _CUT, _DASHES, INK, Columns, _add, _curve_style, _cut, _style, new_axes
from rocking_block._words import OF_EVERY_BLOCK, optional

with optional("plot", "matplotlib"):
    from matplotlib.axes import Axes
    from matplotlib.collections import LineCollection
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch
    from matplotlib.transforms import ScaledTranslation, Transform

_ROTATION = "peak.theta/alpha"
_MARKS = {"completed": "o", "overturned": "x", "separated": "^", "undecided": "s", "failed": "*"}
# Fillings of lanes, those that others may cover first.
_FILLS = {"separated": "0.65", "overturned": INK, "undecided": "0.86", "failed": "#BB5566"}
_FILL_NAMES = {"separated": "complete separation", "overturned": "overturned", "undecided": "undecided", "failed": "run failed"}
# Distance of two lanes, width of a lane, and distance of the first one from the axis [pt].
_LANE, _LANE_WIDTH, _FIRST_LANE = 9.0, 6.0, 11.0
# Default horizontal axes of a table: the first of these that varies.
_ABSCISSAS = ("2pi/p", "PGV", "PGA", "scale", "p", *(name for name in OF_EVERY_BLOCK if name != "p"))
_MOTIONS = ("record", "vertical", "scale")
_DIMENSIONS = ("width", "height", "center_height", "inertia", "K", "C", "mass")
_OF_BLOCK = ("foundation", *_engine.Block._names())
# Columns that follow from others and need no curves of their own.
_FOLLOWS: dict[str, tuple[str, ...]] = {"2pi/p": ("p",), "omega_p/p": ("p",)}


def table(
    table: Columns,
    heading: Callable[[str], str],
    x: str | None,
    y: str,
    by: str | Sequence[str] | None,
    ax: Axes | None,
    style: dict[str, Any],
) -> Axes:
    """Draws one column over another, as curves or points."""
    varying = [name for name in table if _rows(table) and len(np.unique(table[name])) > 1]
    if x is None:
        # A spectrum has curves over the size; runs under many records have points over a measure of the records.
        known = (*_ABSCISSAS, *(name for name in varying if _is_parameter(name)))
        fitting = [name for name in known if name in varying and table[name].dtype.kind in "fiu"]
        if "2pi/p" in fitting and not _makes_curves(table, "2pi/p", _distinguishing(varying, "2pi/p", y)):
            fitting.remove("2pi/p")
        if not fitting:
            raise ValueError(f"no column to draw over varies; expected x, one of {', '.join(table)}")
        x = fitting[0]
    for name in (x, y, *([by] if isinstance(by, str) else by or ())):
        if name not in table:
            raise ValueError(f"there is no column {name!r}; expected one of {', '.join(table)}")
    for name in (x, y):
        if table[name].dtype.kind not in "fiub":
            raise ValueError(f"column {name!r} has {table[name].dtype} values; expected numbers")
    if by is None:
        by = _distinguishing(varying, x, y)
        without = [name for name in by if name not in _DIMENSIONS]
        if _makes_curves(table, x, without):
            # Sizes follow from the abscissa.
            by = without
        single = _makes_curves(table, x, by)
        if not single:
            by = ["outcome"] if "outcome" in table else []
    else:
        by = [by] if isinstance(by, str) else list(by)
        single = _makes_curves(table, x, by)
    groups = _groups(table, by)
    axes = new_axes(ax, "table", (8.0, 4.5))
    ordinates, has_lanes = table[y], False
    if y == _ROTATION and "outcome" in table:
        # A block that overturned, or whose run ended otherwise, has no peak rotation: a lane under the curves shows it. Points of
        # overturned blocks are on the edge.
        has_lanes = single and bool(np.any(table["outcome"] != "completed"))
        hidden = table["outcome"] != "completed" if single else table["outcome"] == "overturned"
        ordinates = np.where(hidden, np.nan if single else _CUT, ordinates)
    for key, rows in groups.items():
        rows = rows[np.argsort(table[x][rows], kind="stable")] if single else rows
        if not has_lanes and not np.any(np.isfinite(ordinates[rows])):
            continue
        number = _add(axes, "table")
        curve_style, values = _curve_style(number, None), ordinates[rows]
        if not single:
            others = tuple(_MARKS.values())
            mark = _MARKS.get(key[0], "o") if by == ["outcome"] else others[number // len(_COLOURS) % len(others)]
            curve_style = {"color": curve_style["color"], "linestyle": "", "marker": mark, "markersize": 4, "alpha": 0.7}
            # Points beyond the edge are drawn on it, so that all are visible.
            values = np.minimum(values, _CUT) if y == _ROTATION else values
        label = ", ".join(_named(name, value) for name, value in zip(by, key))
        (line,) = axes.plot(
            table[x][rows], values, clip_on=single, **_style({"linewidth": 1.2, "label": label or None} | curve_style, style)
        )
        if has_lanes:
            _lane(axes, line, table[x][rows], _fillings(table, rows))
    axes.set(xlabel=_typeset(heading(x)), ylabel=_typeset(heading(y)))
    if y == _ROTATION:
        axes.set_ylabel("greatest rotation |θ|/α")
        if _add(axes, "limit") == 0:
            axes.axhline(1.0, color=INK, lw=0.8, ls=":")
        axes.set_ylim(bottom=0.0)
        _cut(axes, ordinates)
    handles = [*axes.get_legend_handles_labels()[0], *_fill_patches(axes)]
    if handles:
        axes.legend(handles=handles, fontsize="small")
    return axes


def _fillings(table: Columns, rows: npt.NDArray[np.intp]) -> dict[str, npt.NDArray[np.bool_]]:
    """Returns which of these blocks had each outcome of a lane. Blocks that leave the ground and land have separated, too."""
    outcome = table["outcome"][rows]
    found = {word: np.asarray(outcome == word) for word in _FILLS}
    if "flights" in table:
        found["separated"] |= (table["flights"][rows] > 0) & ~found["overturned"]
    return found


def _lane(axes: Axes, line: Line2D, x: npt.NDArray[Any], fillings: dict[str, npt.NDArray[np.bool_]]) -> None:
    """Draws a lane between the axis and its labels that shows where the blocks of a curve separate or overturn."""
    number = _add(axes, "lane")
    distance = _FIRST_LANE + _LANE * number
    axes.tick_params(axis="x", pad=distance + _LANE)
    axes.update_datalim([(x[0], 0.0), (x[-1], 0.0)])
    axes.autoscale_view(scaley=False)
    below = ScaledTranslation(0.0, -distance / 72.0, axes.figure.dpi_scale_trans)

    def draw(parts: list[tuple[float, float]], colour: Any, width: float, across: Transform, dashes: Any = "-") -> None:
        segments = [[(start, 0.0), (end, 0.0)] for start, end in parts]
        lines = LineCollection(segments, colors=colour, linewidths=width, linestyles=dashes, capstyle="butt", transform=across + below)
        lines.set_clip_on(False)
        axes.add_collection(lines, autolim=False)

    across = axes.get_xaxis_transform()
    draw([(-0.06, -0.015)], line.get_color(), line.get_linewidth(), axes.transAxes, _DASHES[number // len(_COLOURS) % len(_DASHES)])
    draw([(x[0], x[-1])], INK, _LANE_WIDTH + 1.0, across)
    draw([(x[0], x[-1])], "white", _LANE_WIDTH, across)
    # A block fills its surroundings, half way to the next one.
    edges = np.concatenate([x[:1], 0.5 * (x[1:] + x[:-1]), x[-1:]])
    for word, colour in _FILLS.items():
        # Neighbours are one part: a seam between them would show.
        steps = np.diff(np.concatenate([[0], fillings[word].astype(int), [0]]))
        parts = list(zip(edges[np.flatnonzero(steps == 1)], edges[np.flatnonzero(steps == -1)], strict=True))
        if parts:
            draw(parts, colour, _LANE_WIDTH, across)
            axes._rocking_block_fills = getattr(axes, "_rocking_block_fills", frozenset()) | {word}  # type: ignore[attr-defined]


def _fill_patches(axes: Axes) -> list[Patch]:
    """Returns entries of the legend for the fillings of the lanes on these axes."""
    shown = getattr(axes, "_rocking_block_fills", ())
    return [Patch(color=colour, label=_FILL_NAMES[word]) for word, colour in _FILLS.items() if word in shown]


def _distinguishing(varying: Sequence[str], x: str, y: str) -> list[str]:
    """Returns the parameters that distinguish curves over x."""
    return [name for name in varying if _is_parameter(name) and name not in (x, y, *_FOLLOWS.get(x, ()))]


def _is_parameter(name: str) -> bool:
    return name in _MOTIONS or name in _OF_BLOCK or name.startswith(("pulse.", "initial.", "tie_"))


def _makes_curves(table: Columns, x: str, by: Sequence[str]) -> bool:
    """Whether each of a few groups has a single row per x."""
    groups = _groups(table, by)
    return len(groups) <= 8 and all(len(np.unique(table[x][rows])) == len(rows) > 1 for rows in groups.values())


def _groups(table: Columns, by: Sequence[str]) -> dict[tuple[Any, ...], npt.NDArray[np.intp]]:
    """Returns the rows of each combination of values, in order of first appearance."""
    groups: dict[tuple[Any, ...], list[int]] = {}
    # Indices of unique values, since nan does not equal itself.
    unique = [np.unique(table[name], return_inverse=True) for name in by]
    keys = zip(*(indices.tolist() for _, indices in unique), strict=True) if by else [()] * _rows(table)
    for row, key in enumerate(keys):
        groups.setdefault(key, []).append(row)
    return {
        tuple(values[index] for (values, _), index in zip(unique, key, strict=True)): np.array(rows, dtype=np.intp)
        for key, rows in groups.items()
    }


def _rows(table: Columns) -> int:
    return len(next(iter(table.values()), ()))


def _typeset(heading: str) -> str:
    """Returns a label of an axis with its symbols as formulas."""
    for name, formula in (("2pi/p", r"$2\pi/p$"), ("omega_p/p", r"$\omega_p/p$")):
        heading = heading.replace(name, formula)
    return heading


def _named(name: str, value: Any) -> str:
    if isinstance(value, str):
        return value
    return f"{name} = {value:.4g}" if isinstance(value, float) else f"{name} = {value}"
