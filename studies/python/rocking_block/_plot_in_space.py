"""Matplotlib plots of blocks in space."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from rocking_block._plot import _COLOURS, _CUT, _make_room, INK
from rocking_block._words import optional

if TYPE_CHECKING:
    from rocking_block._in_space import RunInSpace

with optional("plot", "matplotlib"):
    from matplotlib import pyplot
    from matplotlib.axes import Axes

_NAMED = 4
"""Feet that have curves of their own; of more the least and the greatest force are drawn."""


def run(run: RunInSpace) -> npt.NDArray[np.object_]:
    """Draws a run in a new figure: tilt, twist, forces and slips of the feet, ground acceleration."""
    moves = any(np.any(run[name]) for name in ("a_gx", "a_gy", "a_gz"))
    heights = [2.0, 1.0, 1.4, 1.0, *([1.0] if moves else [])]
    figure = pyplot.figure()
    _make_room(figure, (9.0, 1.4 * sum(heights)))
    panels = figure.subplots(len(heights), 1, sharex=True, height_ratios=heights)
    ratio, weight = run["tilt/alpha"], run.block.mass * run.block.g
    tilt, twist, forces, slips, *ground = panels
    # Components of the tilt over the critical one in the direction of the lean.
    factor = np.divide(ratio, run.tilt, out=np.zeros_like(ratio), where=run.tilt > 0.0)
    tilt.plot(run.t, ratio, color=INK, lw=1.6, label="θ")
    tilt.plot(run.t, factor * run["tilt_x"], color=_COLOURS[0], lw=0.9, label="$θ_x$")
    tilt.plot(run.t, factor * run["tilt_y"], color=_COLOURS[1], lw=0.9, label="$θ_y$")
    if np.max(ratio) > _CUT:
        tilt.set_ylim(-_CUT, _CUT)
    tilt.set_ylabel("tilt θ/α")
    if np.max(ratio) > 0.2:
        tilt.axhline(1.0, color=INK, lw=0.8, ls=":")
    tilt.legend(loc="upper right", ncols=3, frameon=False)
    tilt.set_title(f"{run.block!r}"[1:-1] + "\n" + f"{run!r}"[1:-1], fontsize="small")
    twist.plot(run.t, np.degrees(run.twist), color=INK, lw=0.9)
    twist.set_ylabel("twist [°]")
    _of_feet(forces, run, "N", 1.0 / weight)
    forces.set_ylabel("N/(M g)")
    forces.legend(loc="upper right", ncols=4, frameon=False)
    _of_feet(slips, run, "slip", 1e3)
    slips.set_ylabel("slip [mm]")
    for panel in ground:
        for name, label, colour in zip(("a_gx", "a_gy", "a_gz"), ("x", "y", "z"), _COLOURS):
            if np.any(run[name]):
                panel.plot(run.t, run[name] / run.block.g, color=colour, lw=0.8, label=label)
        panel.set_ylabel("ground [g]")
        panel.legend(loc="upper right", ncols=3, frameon=False)
    for panel in panels[1:]:
        panel.axhline(0.0, color=INK, lw=0.5)
    panels[-1].set_xlabel("time [s]")
    panels[-1].set_xlim(run.t[0], run.t[-1])
    pyplot.sca(tilt)
    return np.asarray(panels, dtype=object)


def _of_feet(axes: Axes, run: RunInSpace, name: str, factor: float) -> None:
    """Draws a quantity of all feet: a curve of each of few, the range of many."""
    names = run.block.foot_names
    columns = [factor * run[f"{name}_{foot}"] for foot in names]
    if len(names) <= _NAMED:
        for foot, column, colour in zip(names, columns, _COLOURS):
            axes.plot(run.t, column, color=colour, lw=0.8, label=foot)
    else:
        least, greatest = np.min(columns, axis=0), np.max(columns, axis=0)
        axes.fill_between(run.t, least, greatest, color="0.8", label=f"of {len(names)} feet")
        axes.plot(run.t, greatest, color=INK, lw=0.8, label="the greatest")
