"""Matplotlib plots."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from rocking_block import _engine
from rocking_block._tie import force_of, links
from rocking_block._words import Floats, optional

with optional("plot", "matplotlib"):
    from matplotlib import pyplot
    from matplotlib.axes import Axes
    from matplotlib.cbook import normalize_kwargs
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D
    from matplotlib.ticker import LogLocator, NullFormatter

# Colours of different lightness, which colour-blind readers and grey prints can distinguish (P. Tol, Colour Schemes,
# SRON/EPS/TN/09-002 (2021), "high-contrast"); from the fourth curve on the dashes differ as well.
_COLOURS = ("#004488", "#DDAA33", "#BB5566", "#000000")
_DASHES = ("-", (0, (6, 2)), (0, (2, 1.5)), (0, (6, 2, 1.5, 2)))
INK, _BAND = "#404040", "0.93"
# Rotations |θ|/α beyond this are clipped.
_CUT = 1.5

Columns = Mapping[str, npt.NDArray[Any]]


class _Fit(Protocol):
    """The drawn attributes of a fragility curve."""

    im: str
    unit: str
    ci: float

    @property
    def range(self) -> tuple[float, float]: ...
    def marks(self) -> list[Floats]: ...
    @property
    def median(self) -> float: ...
    @property
    def beta(self) -> float: ...
    def curve(self, x: npt.ArrayLike) -> Floats: ...
    def band(self, x: npt.ArrayLike) -> tuple[Floats, Floats]: ...


def run(
    block: _engine.Block, columns: Columns, summary: str, ax: Any, label: str | None, color: Any, style: dict[str, Any]
) -> Any:
    """Draws a run on one axes or several: rotation, reactions, ground acceleration."""
    has_ground = bool(np.any(columns["a_gx"]) or np.any(columns["a_gz"]))
    kinds = [_rotation, _reactions, *([_slip] if np.isfinite(block.friction) else []), *([_forces] if links(block) else [])]
    panels = _panels(ax, [*kinds, _ground] if has_ground else kinds)
    number = _drawn(panels[0], "run")
    first = number == 0
    base = "rigid base" if np.isnan(block.eta) else f"η = {block.eta:.4g}"
    label = label or f"α = {block.alpha:.3g}, p = {block.p:.3g} rad/s, {base}"
    curve_style = _curve_style(number, color)
    for panel, default in zip(panels, (_rotation, _reactions, _ground, None, None)):
        panel._rocking_block = {"run": number + 1}
        draw = getattr(panel, "_rocking_kind", default)
        if draw is not None and draw in (*kinds, _ground):
            draw(panel, block, columns, first, label, _style(curve_style, style if draw is _rotation else {}))
    rotation = panels[0]
    title = f"{label}\n{summary}"
    rotation.set_title(title if first else "", fontsize="medium")
    if not first:
        rotation.legend(loc="upper right", ncols=3, fontsize="small")
    if first:
        panels[-1].set_xlabel("time [s]")
        panels[-1].set_xlim(columns["t"][0], columns["t"][-1])
    elif columns["t"][-1] > panels[-1].get_xlim()[1]:
        panels[-1].set_xlim(right=columns["t"][-1])
    if ax is None:
        # The title goes above the top panel.
        pyplot.sca(rotation)
    return rotation if isinstance(ax, Axes) else panels


def _panels(ax: Any, kinds: Sequence[Any]) -> npt.NDArray[Any]:
    if isinstance(ax, Axes):
        return np.array([ax])
    if ax is not None:
        panels = np.ravel(np.asarray(ax, dtype=object))
        if not 1 <= len(panels) <= 3 or not all(isinstance(panel, Axes) for panel in panels):
            raise TypeError(f"ax = {ax!r}; expected one, two or three Axes of Matplotlib")
        return panels
    figure = pyplot.gcf()
    if figure.axes and not all(_drawn(panel, "run") for panel in figure.axes):
        figure = pyplot.figure()
    if not figure.axes:
        heights = [{_rotation: 2.0, _reactions: 1.4}.get(kind, 1.0) for kind in kinds]
        _make_room(figure, (9.0, 1.5 * sum(heights)))
        for panel, kind in zip(figure.subplots(len(heights), 1, sharex=True, height_ratios=heights), kinds, strict=True):
            panel._rocking_kind = kind
    return np.array(figure.axes)


def _rotation(axes: Axes, block: _engine.Block, run: Columns, first: bool, label: str, style: dict[str, Any]) -> None:
    if first:
        _contact(axes, run)
        axes.axhline(0.0, color=INK, lw=0.5)
        for balance in (-block.alpha_L, block.alpha_R):
            axes.axhline(balance / block.alpha, color=INK, lw=0.8, ls=":")
        axes.set_ylabel("rotation θ/α")
    rotation = run["theta"] / block.alpha
    axes.plot(run["t"], rotation, **_style({"linewidth": 1.2, "label": label}, style))
    _cut(axes, rotation)


def _reactions(axes: Axes, block: _engine.Block, run: Columns, first: bool, label: str, style: dict[str, Any]) -> None:
    weight = block.mass * block.g
    axes.plot(run["t"], run["N_L"] / weight, **style, linewidth=0.8, label="left corner" if first else None)
    axes.plot(run["t"], run["N_R"] / weight, **style, linewidth=0.8, alpha=0.45, label="right corner" if first else None)
    # A landing on stiff supports or a rigid base may reach hundreds of times the weight for an instant.
    highest = float(np.max(np.maximum(run["N_L"], run["N_R"]))) / weight
    if first:
        _contact(axes, run, label="both corners touch")
        axes.set_ylabel("reaction N/(M g)")
        axes.set_ylim(0.0, 1.05 * max(1.0, highest))
        axes.legend(loc="lower right", bbox_to_anchor=(1.0, 0.97), ncols=3, frameon=False)
    elif 1.05 * highest > axes.get_ylim()[1]:
        axes.set_ylim(top=1.05 * highest)


def _slip(axes: Axes, block: _engine.Block, run: Columns, first: bool, label: str, style: dict[str, Any]) -> None:
    axes.plot(run["t"], 1e3 * run["slip"], **style, linewidth=0.8)
    if first and np.max(np.abs(run["slip"])) < 1e-9:
        # Round-off would fill the panel.
        axes.set_ylim(-1.0, 1.0)
    axes.set_ylabel("slip [mm]")


def _forces(axes: Axes, block: _engine.Block, run: Columns, first: bool, label: str, style: dict[str, Any]) -> None:
    weight = block.mass * block.g
    names = list(links(block))
    for number, name in enumerate(names, 1):
        paler = {"alpha": 1.0 / number**0.7}
        named = name.replace("_", " ") if first else None
        axes.plot(run["t"], run[force_of(name)] / weight, **style, **paler, linewidth=0.8, label=named)
    axes.set_ylabel("force T/(M g)" if block.dampers else "tension T/(M g)")
    if first and len(names) > 1:
        axes.legend(loc="lower right", bbox_to_anchor=(1.0, 0.97), ncols=len(names), frameon=False)


def loops(block: _engine.Block, run: Columns, ax: Axes | None) -> Axes:
    """Draws the forces of dampers and of ties that yield over their elongations."""
    names = [name for name in links(block) if f"{name}.elongation" in run]
    if not names:
        raise ValueError("no loops: the block has no damper, and no tie of it yields; expected Block(dampers=...)")
    axes = new_axes(ax, None, (5.0, 4.0))
    weight = block.mass * block.g
    for name in names:
        axes.plot(1e3 * run[f"{name}.elongation"], run[force_of(name)] / weight, linewidth=0.8, label=name.replace("_", " "))
    axes.set_xlabel("elongation [mm]")
    axes.set_ylabel("force T/(M g)")
    axes.legend(frameon=False)
    return axes


def pushover(table: Columns, landmarks: Sequence[Any], cycle: Columns | None, weight: float, ax: Axes | None) -> Axes:
    """Draws the lateral force over the rotation, with numbered landmarks, and a cycle."""
    axes = new_axes(ax, None, (6.0, 4.5))
    axes.plot(table["theta"], table["force/weight"], linewidth=2.5, color=_COLOURS[0], label="slow rotation")
    if cycle is not None:
        axes.plot(cycle["theta"], cycle["force/weight"], linewidth=0.8, color=INK, label="cycle")
    places: dict[float, list[str]] = {}
    for landmark in landmarks[1:]:
        places.setdefault(landmark.theta, []).append(landmark.name)
    for order, (theta, names) in enumerate(places.items(), 1):
        force = next(landmark.force for landmark in landmarks[1:] if landmark.theta == theta) / weight
        axes.plot(theta, force, "o", color="white", markeredgecolor=INK, label=f"{order} {', '.join(names)}")
        axes.annotate(str(order), (theta, force), (5, 5), textcoords="offset points")
    axes.margins(0.08)
    axes.set_xlabel("θ [rad]")
    axes.set_ylabel("lateral force F/(M g)")
    axes.legend(frameon=False)
    return axes


def _ground(axes: Axes, block: _engine.Block, run: Columns, first: bool, label: str, style: dict[str, Any]) -> None:
    both = bool(np.any(run["a_gz"]))
    axes.plot(run["t"], run["a_gx"], **style, linewidth=0.7, label="horizontal" if both else None)
    if both:
        axes.plot(run["t"], run["a_gz"], **style, linewidth=0.7, alpha=0.45, label="vertical")
        axes.legend(loc="lower right", bbox_to_anchor=(1.0, 0.97), ncols=2, frameon=False)
    axes.set_ylabel("ground [m/s²]")


def _contact(axes: Axes, run: Columns, label: str | None = None) -> None:
    """Shades the times at which both corners touch."""
    shade: dict[str, Any] = {"color": _BAND, "lw": 0, "label": label}
    where = run["regime"] == 0
    axes.fill_between(run["t"], 0.0, 1.0, where=where, transform=axes.get_xaxis_transform(), step="post", **shade)


def record(record: _engine.Record, times: Floats, ax: Axes | None, style: dict[str, Any]) -> Axes:
    """Draws a record's acceleration."""
    axes = new_axes(ax, "record", (9.0, 3.0))
    curve_style = _curve_style(_add(axes, "record"), None)
    axes.plot(times, record.acceleration, **_style({"linewidth": 0.7, "label": record.name or "record"} | curve_style, style))
    axes.set(xlabel="time [s]", ylabel="acceleration [m/s²]")
    if len(axes.lines) > 1:
        axes.legend()
    else:
        axes.set_title(f"{record.name}  PGA {record.pga:.3g} m/s²".strip(), fontsize="medium")
        axes.margins(x=0)
    return axes


def fragility(
    fit: _Fit, limit: str, ax: Axes | None, label: str | None, color: Any, runs: bool, style: dict[str, Any]
) -> Axes:
    """Draws a curve and its band; marks at 0 and 1 are runs, rings the fraction of those that exceed the limit."""
    axes = new_axes(ax, "fragility", (7.0, 4.5))
    number = _add(axes, "fragility")
    first, curve_style = number == 0, _curve_style(number, color)
    low, high = fit.range
    x = np.geomspace(low, high, 200)
    label = label or f"{fit.im}: median {fit.median:.3g}, β = {fit.beta:.2f}"
    (line,) = axes.plot(x, fit.curve(x), **_style({"linewidth": 1.8, "label": label} | curve_style, style))
    band = f"{100 * fit.ci:g} % confidence" if first else None
    axes.fill_between(x, *fit.band(x), color=line.get_color(), alpha=0.18, lw=0, label=band)
    if runs:
        ink = INK if first else line.get_color()
        # Of many rows, some 10,000 spread evenly.
        measures, fractions = fit.marks()
        order = np.argsort(measures)
        classes = [rows for rows in np.array_split(order, min(10, len(order) // 5 or 1)) if rows.size]
        middle = [np.exp(np.mean(np.log(measures[rows]))) for rows in classes]
        share = [np.mean(fractions[rows]) for rows in classes]
        axes.plot(middle, share, "o", color=ink, ms=5, mfc="white", label=f"share of {len(classes[0])} runs" if first else None)
        axes.plot(measures, fractions, "|", color=ink, ms=7, alpha=0.35)
    axes.set_xscale("log")
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.xaxis.set_major_formatter("{x:g}")
    axes.xaxis.set_minor_formatter(NullFormatter())
    abscissa, ordinate = f"{fit.im} [{fit.unit}]" if fit.unit else fit.im, f"probability: {limit}"
    if not first:
        left, right = axes.get_xlim()
        low, high = min(low, left), max(high, right)
        abscissa = abscissa if axes.get_xlabel() == abscissa else "intensity measure"
        ordinate = ordinate if axes.get_ylabel() == ordinate else "probability"
    axes.set(xlabel=abscissa, ylabel=ordinate, ylim=(-0.04, 1.04), xlim=(low, high))
    # Curves rise from the left, and the marks of the runs are above them.
    axes.legend(loc="upper left", bbox_to_anchor=(0.0, 0.95), frameon=False, fontsize="small")
    return axes


def fit(tests: Sequence[Any], axes: Any) -> npt.NDArray[Any]:
    """Draws measured and fitted values of tests, and their residuals."""
    if axes is None:
        heights = [2.0, 1.0] * len(tests)
        figure, axes = pyplot.subplots(
            2 * len(tests), 1, figsize=(7.0, 4.2 * len(tests)), layout="constrained", height_ratios=heights
        )
    panels = np.ravel(axes)
    if len(panels) != 2 * len(tests):
        raise ValueError(f"{len(panels)} axes; expected two for each of {len(tests)} tests")
    for number, (test, upper, lower) in enumerate(zip(tests, panels[::2], panels[1::2], strict=True), 1):
        unit = "" if test.unit == "1" else f" [{test.unit}]"
        name = f"test_{number}: {test.output}" if len(tests) > 1 else test.output
        upper.plot(test.t, test.measured, ".", color="0.6", markersize=3.0, label="measured")
        upper.plot(test.t, test.fitted, color=_COLOURS[0], linewidth=1.0, label="fitted")
        upper.set_ylabel(f"{name}{unit}")
        upper.legend()
        lower.axhline(0.0, color=INK, linewidth=0.6)
        lower.plot(test.t, test.residuals, ".", color=_COLOURS[0], markersize=2.0)
        lower.set_ylabel("measured less fitted")
        lower.set_title(f"Durbin–Watson {test.durbin_watson:.2f}, white noise 2", fontsize="small", loc="left")
        lower.set_xlabel("time [s]")
    return panels


def annual_rate(found: _engine.AnnualRate, im: str, unit: str, ax: Axes | None, style: dict[str, Any]) -> Axes:
    """Draws the density of the rate over the logarithm of the measure, its median and the range of 90 %."""
    axes = new_axes(ax, "rate", (7.0, 4.0))
    number = _add(axes, "rate")
    low, high = found.quantile(0.001), found.quantile(0.999)
    edges = np.geomspace(low, high, 301)
    parts = [found.between(a, b) for a, b in zip(edges[:-1], edges[1:], strict=True)]
    density = np.array(parts) / np.diff(np.log(edges)) / found.rate
    middle = np.sqrt(edges[:-1] * edges[1:])
    (line,) = axes.plot(middle, density, **_style({"label": f"{found.rate:.3g} per year"} | _curve_style(number, None), style))
    inside = (middle >= found.quantile(0.05)) & (middle <= found.quantile(0.95))
    axes.fill_between(middle, density, where=inside.tolist(), color=line.get_color(), alpha=0.18, lw=0, label="90 % of the rate")
    axes.axvline(found.quantile(0.5), color=line.get_color(), lw=0.8, ls="--")
    axes.set_xscale("log")
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.xaxis.set_major_formatter("{x:g}")
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.set(xlabel=f"{im} [{unit}]" if unit else im, ylabel="share of the rate per unit of ln IM")
    axes.set_ylim(bottom=0.0)
    axes.legend(loc="best", frameon=False, fontsize="small")
    return axes


def new_axes(ax: Axes | None, kind: str | None, size: tuple[float, float]) -> Axes:
    """Returns the axes to draw on. Current axes with a plot of another kind, or of any if `kind` is None, are left alone."""
    if ax is not None:
        if not isinstance(ax, Axes):
            raise TypeError(f"ax = {ax!r}; expected Axes of Matplotlib")
        return ax
    figure = pyplot.gcf()
    if figure.axes:
        axes = pyplot.gca()
        others = set(getattr(axes, "_rocking_block", {})) - {kind, "limit", "lane"}
        if not others:
            return axes
        figure = pyplot.figure()
    _make_room(figure, size)
    return figure.add_subplot()


def _make_room(figure: Figure, size: tuple[float, float]) -> None:
    """Sets the size of an empty figure with the default size, and a layout with room for legends."""
    if tuple(figure.get_size_inches()) == tuple(pyplot.rcParams["figure.figsize"]):
        figure.set_size_inches(*size)
    if figure.get_layout_engine() is None:
        figure.set_layout_engine("constrained")


def _drawn(axes: Axes, kind: str) -> int:
    """Returns the number of plots of a kind on the axes."""
    return int(getattr(axes, "_rocking_block", {}).get(kind, 0))


def _add(axes: Axes, kind: str) -> int:
    """Counts a plot on the axes; returns the previous count."""
    before = _drawn(axes, kind)
    counts = getattr(axes, "_rocking_block", {})
    axes._rocking_block = counts | {kind: before + 1}  # type: ignore[attr-defined]
    return before


def _curve_style(number: int, color: Any) -> dict[str, Any]:
    """Returns colour and dashes of the n-th curve."""
    dashes = _DASHES[number // len(_COLOURS) % len(_DASHES)]
    return {"color": color if color is not None else _COLOURS[number % len(_COLOURS)], "linestyle": dashes}


def _style(defaults: dict[str, Any], explicit: dict[str, Any]) -> dict[str, Any]:
    """Returns options of `Axes.plot`; explicit ones, including their short forms, override the defaults."""
    return defaults | dict(normalize_kwargs(explicit, Line2D))


def _cut(axes: Axes, rotation: npt.NDArray[Any]) -> None:
    """Clips rotations beyond the limit, and states the largest."""
    finite = np.abs(rotation[np.isfinite(rotation)])
    greatest = max(float(finite.max(initial=0.0)), getattr(axes, "_rocking_block_greatest", 0.0))
    axes._rocking_block_greatest = greatest  # type: ignore[attr-defined]
    if greatest < _CUT:
        return
    axes.set_ylim(-_CUT if axes.get_ylim()[0] < 0.0 else 0.0, _CUT)
    if greatest == _CUT:
        return
    for text in [text for text in axes.texts if text.get_gid() == "rocking_block.cut"]:
        text.remove()
    note = f"cut at {_CUT}; up to {greatest:.3g}"
    axes.text(0.995, 0.98, note, transform=axes.transAxes, ha="right", va="top", fontsize="small", color=INK,
              gid="rocking_block.cut")
