"""Pictures, by Matplotlib."""

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

if TYPE_CHECKING:
    from rocking_block._fragility import Fragility
    from rocking_block._run import Run

_BLUE, _ORANGE, _INK, _BAND = "#1f5fa8", "#c8641e", "#404040", "0.93"
# A legend that hides no curve: in a line over the axes.
_ABOVE: dict[str, Any] = {"loc": "lower right", "bbox_to_anchor": (1.0, 0.98), "ncols": 3, "frameon": False}


def run(run: "Run") -> Figure:
    """Rotation, reactions of the corners and ground acceleration over time; grey where both corners touch."""
    # A figure of its own leaves pyplot's state alone; notebooks show it as the value of a cell.
    figure = Figure(figsize=(9, 6.5), layout="constrained")
    rotation, reaction, ground = figure.subplots(3, 1, sharex=True, height_ratios=[2, 1.4, 1])
    block, t = run.block, run.t
    for axes in (rotation, reaction):
        low, high = 0.0, 1.0
        axes.fill_between(
            t, low, high, where=run.regime == 0, transform=axes.get_xaxis_transform(), color=_BAND, lw=0, step="post"
        )
    rotation.plot(t, run.theta / block.alpha, color=_BLUE, lw=1.2)
    rotation.set_ylabel("rotation θ/α")
    rotation.axhline(0.0, color=_INK, lw=0.5)
    weight = block.mass * block.g
    reaction.plot(t, run.N_L / weight, color=_BLUE, lw=0.8, label="left corner")
    reaction.plot(t, run.N_R / weight, color=_ORANGE, lw=0.8, label="right corner")
    reaction.set_ylabel("reaction N/(M g)")
    reaction.set_ylim(0.0, 1.05 * max(1.0, float(np.max(np.maximum(run.N_L, run.N_R))) / weight))
    reaction.legend(**_ABOVE)
    ground.plot(t, run.a_gx, color=_INK, lw=0.7, label="horizontal")
    if np.any(run.a_gz != 0.0):
        ground.plot(t, run.a_gz, color=_ORANGE, lw=0.5, label="vertical")
        ground.legend(**_ABOVE)
    ground.set(ylabel="ground [m/s²]", xlabel="time [s]")
    ground.set_xlim(t[0], t[-1])
    rotation.set_title(f"{run.outcome}: |θ|/α = {run.peak.theta / block.alpha:.3f}, {run.counts.impacts} impacts", loc="left")
    return figure


def fragility(fit: "Fragility") -> Figure:
    """The curve and its band; runs as marks at 0 and 1, and the share of those that exceed in ten classes of equal size."""
    figure = Figure(figsize=(7, 4.5), layout="constrained")
    axes = figure.subplots()
    low, high = fit.measures.min(), fit.measures.max()
    x = np.geomspace(low, high, 200)
    axes.fill_between(x, *fit.band(x), color=_BLUE, alpha=0.18, lw=0, label=f"{100 * fit.ci:g} % confidence")
    axes.plot(x, fit.curve(x), color=_BLUE, lw=1.8, label=f"median {fit.median:.3g}, β = {fit.beta:.2f}")
    order = np.argsort(fit.measures)
    classes = [rows for rows in np.array_split(order, min(10, len(order) // 5 or 1)) if rows.size]
    middle = [np.exp(np.mean(np.log(fit.measures[rows]))) for rows in classes]
    share = [np.mean(fit.fractions[rows]) for rows in classes]
    axes.plot(middle, share, "o", color=_INK, ms=5, mfc="white", label=f"share of {len(classes[0])} runs")
    axes.plot(fit.measures, fit.fractions, "|", color=_INK, ms=7, alpha=0.35)
    axes.set_xscale("log")
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.xaxis.set_major_formatter("{x:g}")
    axes.xaxis.set_minor_formatter(NullFormatter())
    what = f"|θ|/α > {fit.limit:g}" if isinstance(fit.limit, float | int) else fit.limit
    axes.set(xlabel=f"{fit.im} [{fit.unit}]", ylabel=f"probability: {what}", ylim=(-0.04, 1.04), xlim=(low, high))
    axes.legend(**_ABOVE)
    return figure
