"""Pictures of incremental dynamic analysis and of clouds."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rocking_block._plot import INK, new_axes

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from rocking_block._cloud import Cloud
    from rocking_block._ida import Ida
    from rocking_block._words import Floats

_FRACTILES = ((0.16, ":"), (0.5, "-"), (0.84, "--"))


def ida(found: Ida, ax: Axes | None) -> Axes:
    """Draws the curves in grey and their fractiles in black."""
    axes = new_axes(ax, "ida", (7.0, 4.5))
    finite = [curve.peaks[np.isfinite(curve.peaks)] for curve in found.curves]
    edge = 1.1 * max((float(peaks.max(initial=0.0)) for peaks in finite), default=1.0) or 1.0
    for number, curve in enumerate(found.curves):
        label = "one block and ground motion" if number == 0 else None
        axes.plot(*_drawn(curve.levels, curve.peaks, edge), color="0.65", lw=0.8, label=label)
    for fraction, dashes in _FRACTILES:
        axes.plot(*_drawn(found.levels, found.fractile(fraction), edge), color=INK, ls=dashes, lw=1.8, label=f"peak that {100 * fraction:.0f} % do not exceed")
    unit = f" [{found.unit}]" if found.unit not in ("", "1") else ""
    axes.set(xlabel=f"peak {found.rotation}", ylabel=f"{found.im}{unit}", xlim=(0.0, edge), ylim=(0.0, None))
    axes.legend(loc="upper left", frameon=False, fontsize="small")
    return axes


def _drawn(levels: Floats, peaks: Floats, edge: float) -> tuple[Floats, Floats]:
    """Returns peaks and levels of a curve from rest, which leaves to the right at the level at which it overturns."""
    x, y = [0.0], [0.0]
    for level, peak in zip(levels, peaks, strict=True):
        if np.isinf(peak):
            x, y = [*x, x[-1], edge], [*y, level, level]
            break
        x, y = [*x, float(peak)], [*y, float(level)]
    return np.array(x), np.array(y)


def cloud(found: Cloud, ax: Axes | None) -> Axes:
    """Draws the runs that rock and stand, the median and one standard deviation to either side."""
    axes = new_axes(ax, "cloud", (7.0, 4.5))
    axes.plot(found.measures, found.rotations, "o", color="0.55", ms=3.5, mew=0.0, label=f"{len(found.measures)} runs that rock and stand")
    x = np.geomspace(found.measures.min(), found.measures.max(), 50)
    axes.plot(x, found.median(x), color=INK, lw=1.8, label=f"median, b = {found.b:.3g}")
    for sign in (-1.0, 1.0):
        label = f"β = {found.beta:.3g}" if sign < 0.0 else None
        axes.plot(x, found.median(x) * np.exp(sign * found.beta), color=INK, lw=1.2, ls="--", label=label)
    unit = f" [{found.unit}]" if found.unit not in ("", "1") else ""
    share = found.overturning
    axes.set(xscale="log", yscale="log", xlabel=f"{found.im}{unit}", ylabel="peak |θ|/α")
    axes.set_title(f"{share.exceeded} of {share.rows} runs overturn", fontsize="small", loc="left")
    axes.legend(loc="upper left", frameon=False, fontsize="small")
    return axes
