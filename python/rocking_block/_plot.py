"""Pictures, by Matplotlib."""

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

if TYPE_CHECKING:
    from rocking_block._run import Run

_BLUE, _ORANGE, _INK, _BAND = "#1f5fa8", "#c8641e", "#404040", "0.93"


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
    reaction.legend(loc="upper right", ncols=2, frameon=False)
    ground.plot(t, run.a_gx, color=_INK, lw=0.7)
    if np.any(run.a_gz != 0.0):
        ground.plot(t, run.a_gz, color=_ORANGE, lw=0.5, label="vertical")
        ground.legend(loc="upper right", frameon=False)
    ground.set(ylabel="ground [m/s²]", xlabel="time [s]")
    ground.set_xlim(t[0], t[-1])
    rotation.set_title(f"{run.outcome}: |θ|/α = {run.peak.theta / block.alpha:.3f}, {run.counts.impacts} impacts", loc="left")
    return figure
