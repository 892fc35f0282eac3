"""A sketch of a block with its dimensions."""

from __future__ import annotations

import math
from typing import Any

from rocking_block import _engine
from rocking_block._plot import INK, _add, new_axes
from rocking_block._tie import links
from rocking_block._words import optional

with optional("plot", "matplotlib"):
    from matplotlib import pyplot
    from matplotlib.axes import Axes
    from matplotlib.patches import Arc, Circle, Rectangle, Wedge

_Point = tuple[float, float]

_TIE, _FILL, _FAINT = "#004488", "0.93", "0.5"
# Lengths relative to the larger side of the block: supports, their distance, room for labels, distance of dimensions.
_SUPPORT, _APART, _LABELS, _ROW = 0.14, 0.22, 0.38, 0.1
# How far from the block an anchor is drawn, likewise; longer ties are broken off.
_REACH, _DEPTH = 0.9, 0.4


def sketch(block: _engine.Block, ax: Axes | None) -> Axes:
    """Draws a block with its centre of mass, foundation, ties and dimensions, in metres."""
    axes = new_axes(ax, None, (7.0, 5.0))
    _add(axes, "block")
    slot = _slot(axes)
    b, body = block.width / 2, block.height
    h, offset = body / 2, block.eccentricity
    size = max(2 * b, body)
    ties = [_reach(link, b, body, size) for link in links(block).values()]
    ends = [end for start, end, _ in ties] + [start for start, _, _ in ties]
    left = min([-b - _LABELS * size, *(x - 0.05 * size for x, _ in ends)])
    right = max([b + _LABELS * size, *(x + 0.05 * size for x, _ in ends)])
    top = max([body, *(z for _, z in ends)])
    # Of a body as it is measured only the height of the centre of mass is known.
    is_measured = "center_height" in block.parameters()
    axes.add_patch(Rectangle((-b, 0), 2 * b, body, fc=_FILL, ec="none" if is_measured else INK, lw=1.8))
    if is_measured:
        axes.plot([-b, -b, b, b], [h, 0.0, 0.0, h], color=INK, lw=1.8)
        axes.plot([-b, -b, math.nan, b, b], [h, body, math.nan, h, body], color=_FAINT, lw=1, ls="--")
    below = _foundation(axes, block, b, size, (left, right) if ties else None)
    below = min([below, *(z for _, z in ends)])
    _angles(axes, b, h, offset, size)
    for name, (start, end, is_anchor) in zip(links(block), ties):
        axes.plot([start[0], end[0]], [start[1], end[1]], color=_TIE, lw=1.8, marker="o", ms=5, markevery=[0])
        axes.plot(*end, color=_TIE, marker="s" if is_anchor else (2, 0, 45), ms=7)
        at = (start[0] + 0.3 * (end[0] - start[0]), start[1] + 0.3 * (end[1] - start[1]))
        axes.text(*at, name[-1] if name.startswith("tie") else f"D{name[-1]}", ha="center", va="center", bbox={"boxstyle": "circle", "fc": "white", "ec": _TIE})
    for angle in (0, 180):
        axes.add_patch(Wedge((offset, h), 0.022 * size, angle, angle + 90, fc=INK, zorder=4))
    axes.add_patch(Circle((offset, h), 0.022 * size, fc="white", ec=INK, lw=1.2, zorder=3))
    if not is_measured:
        _vertical(axes, left - 0.3 * _ROW * size, -b, 0.0, body, f"2h = {body:.4g} m")
    _vertical(axes, right + 0.3 * _ROW * size, b, 0.0, h, f"h = {h:.4g} m")
    _horizontal(axes, below - _ROW * size, -b, b, below - 0.02 * size, f"2b = {2 * b:.4g} m")
    if offset:
        for x in (0.0, offset):
            axes.plot([x, x], [0.0, body + 0.08 * size], color=_FAINT, lw=0.8, ls="-.")
        _horizontal(axes, body + 0.06 * size, min(0.0, offset), max(0.0, offset), body, f"$e_x$ = {offset:.4g} m")
    low = below - 1.9 * _ROW * size
    high = max(body + (0.17 if offset else 0.05) * size, top + 0.05 * size)
    _write_values(axes, _values(block, offset), slot, (left - 1.2 * _ROW * size, right + 1.8 * _ROW * size), (low, high))
    return axes


def _slot(axes: Axes) -> _Point:
    """Returns width and height that the layout gives to axes without labels (inches)."""
    axes.set_axis_off()
    figure: Any = axes.figure.canvas.figure
    figure.draw_without_rendering()
    return axes.bbox.width / figure.dpi, axes.bbox.height / figure.dpi


def _write_values(axes: Axes, lines: list[str], slot: _Point, x: _Point, y: _Point) -> None:
    """Sets the view to these ranges of the drawing and as much room at the right as the lines need."""
    width, height = slot
    length = max(len(line.replace("$", "").replace("_", "")) for line in lines)
    # Letters are 0.58 of the font size wide on average, in points.
    room = min(length * 0.58 * pyplot.rcParams["font.size"] / 72, 0.6 * width)
    scale = min(height / (y[1] - y[0]), (width - room) / (x[1] - x[0]))
    axes.set(xlim=(x[0], x[0] + width / scale), ylim=y, aspect="equal")
    axes.text(x[1], y[1], "\n".join(lines), va="top", linespacing=1.5)


def _reach(tie: Any, b: float, body: float, size: float) -> tuple[_Point, _Point, bool]:
    """Returns the ends of the drawn part of a tie, and whether the second one is its anchor.

    A tie is cut where its line leaves the surroundings of the block. An end on the block that is outside is moved to their edge.
    """
    limits = ((-b - _REACH * size, b + _REACH * size), (-_DEPTH * size, body + _DEPTH * size))
    ground = (tie.ground_x, tie.ground_z)
    start = [min(max(at, low), high) for at, (low, high) in zip((tie.block_x, tie.block_z), limits)]
    part = 1.0
    for at, end, (low, high) in zip(start, ground, limits):
        if end != at:
            part = min(part, max(((high if end > at else low) - at) / (end - at), 0.0))
    x, z = (at + part * (end - at) for at, end in zip(start, ground))
    return (start[0], start[1]), (x, z), part == 1.0


def _foundation(axes: Axes, block: _engine.Block, b: float, size: float, surface: tuple[float, float] | None) -> float:
    """Draws supports and ground; returns the height of its lower end. `surface` is the ground beside the block."""
    if block.foundation == "rigid":
        low, high = surface or (-b - 0.1 * size, b + 0.1 * size)
        _ground(axes, low, high, 0.0, size)
        return -0.04 * size
    bottom = -_SUPPORT * size
    outward = max(0.0, _APART * size / 2 - b)
    middles = (-b - outward, b + outward)
    wall = 0.1 * size
    if surface:
        for low, high in ((surface[0], middles[0] - wall), (middles[1] + wall, surface[1])):
            _ground(axes, low, high, 0.0, size)
        for x in (middles[0] - wall, middles[1] + wall):
            axes.plot([x, x], [0.0, bottom], color=INK, lw=1.8)
    _ground(axes, middles[0] - wall, middles[1] + wall, bottom, size)
    for corner, middle in zip((-b, b), middles):
        _support(axes, corner, middle, bottom, size)
    axes.text(middles[0] - 0.055 * size, 0.5 * bottom, "K", ha="right", va="center")
    axes.text(middles[1] + 0.055 * size, 0.5 * bottom, "C", ha="left", va="center")
    return bottom - 0.04 * size


def _ground(axes: Axes, left: float, right: float, top: float, size: float) -> None:
    """Draws a hatched surface."""
    axes.add_patch(Rectangle((left, top - 0.03 * size), right - left, 0.03 * size, fc="none", ec=INK, lw=0, hatch="////"))
    axes.plot([left, right], [top, top], color=INK, lw=1.8)


def _support(axes: Axes, corner: float, middle: float, bottom: float, size: float) -> None:
    """Draws a spring and a dashpot under a bar that reaches to the corner."""
    spring, dashpot, bar = middle - 0.03 * size, middle + 0.03 * size, 0.1 * bottom
    line: dict[str, Any] = {"color": INK, "lw": 1.1, "solid_joinstyle": "miter"}
    axes.plot([corner, corner], [0.0, bar], **line)
    axes.plot([min(spring, corner), max(dashpot, corner)], [bar, bar], **line)
    turns = [(spring + (-1) ** i * 0.013 * size, bottom * (0.24 + 0.62 * i / 6)) for i in range(7)]
    points = [(spring, bar), (spring, 0.19 * bottom), *turns, (spring, 0.91 * bottom), (spring, bottom)]
    axes.plot([x for x, _ in points], [y for _, y in points], **line)
    half = 0.016 * size
    axes.plot([dashpot, dashpot], [bar, 0.5 * bottom], **line)
    thick: dict[str, Any] = {**line, "lw": 2.2}
    axes.plot([dashpot - 0.7 * half, dashpot + 0.7 * half], [0.5 * bottom] * 2, **thick)
    pot = [(-half, 0.35), (-half, 0.72), (half, 0.72), (half, 0.35)]
    axes.plot([dashpot + x for x, _ in pot], [part * bottom for _, part in pot], **line)
    axes.plot([dashpot, dashpot], [0.72 * bottom, bottom], **line)


def _angles(axes: Axes, b: float, h: float, offset: float, size: float) -> None:
    """Draws the lines from the corners to the centre of mass, with their angles from the vertical."""
    for sign, name in ((-1, r"\alpha_L"), (1, r"\alpha_R")):
        corner = sign * b
        axes.plot([corner, offset], [0.0, h], color=_FAINT, lw=1, ls="--")
        if sign < 0 and not offset:
            continue
        angle = math.atan2(b - sign * offset, h)
        # The arc of a squat block stays below its top.
        radius = min(0.5 * math.hypot(b - sign * offset, h), 1.6 * h)
        start, end = sorted((90.0, 90.0 + sign * math.degrees(angle)))
        axes.add_patch(Arc((corner, 0.0), 2 * radius, 2 * radius, theta1=start, theta2=end, ec=INK, lw=0.9))
        middle = (corner - sign * radius * math.sin(angle / 2), radius * math.cos(angle / 2))
        label = (corner + sign * 0.035 * size, min(middle[1], h) - 0.05 * size)
        axes.annotate(
            f"${name if offset else 'α'}$ = {math.degrees(angle):.4g}°", middle, label, va="center",
            ha="left" if sign > 0 else "right", arrowprops={"arrowstyle": "-", "color": _FAINT, "lw": 0.8},
        )


def _vertical(axes: Axes, x: float, side: float, low: float, high: float, label: str) -> None:
    """Draws a vertical dimension, with extension lines from a side of the block."""
    for y in (low, high):
        axes.plot([side, x], [y, y], color=_FAINT, lw=0.6, zorder=0.5)
    axes.annotate("", (x, low), (x, high), arrowprops={"arrowstyle": "<|-|>", "fc": INK, "lw": 0.8, "shrinkA": 0, "shrinkB": 0})
    aside = -1 if x < side else 1
    axes.annotate(label, (x, (low + high) / 2), (4 * aside, 0), textcoords="offset points", rotation=90,
                  ha="right" if aside < 0 else "left", va="center")


def _horizontal(axes: Axes, y: float, left: float, right: float, end: float, label: str) -> None:
    """Draws a horizontal dimension with its text at the right, and extension lines from a height."""
    for x in (left, right):
        axes.plot([x, x], [end, y], color=_FAINT, lw=0.6, zorder=0.5)
    axes.annotate("", (left, y), (right, y), arrowprops={"arrowstyle": "<|-|>", "fc": INK, "lw": 0.8, "shrinkA": 0, "shrinkB": 0})
    axes.annotate(label, (right, y), (6, 0), textcoords="offset points", ha="left", va="center")


def _values(block: _engine.Block, offset: float) -> list[str]:
    """Returns the lines of the column of values."""
    b, h = block.width / 2, block.height / 2
    sides = {r"$α_L$": b + offset, r"$α_R$": b - offset} if offset else {"α": b}
    angles = [(name, math.atan2(side, h)) for name, side in sides.items()]
    lines = [f"{name} = {angle:.4g} rad = {math.degrees(angle):.4g}°" for name, angle in angles]
    lines += [f"$R_0$ = {block.R0:.4g} m", f"p = {block.p:.4g} rad/s, γ = {block.gamma:.4g}", f"M = {block.mass:.4g} kg", ""]
    if block.foundation == "rigid":
        lines += [f"rigid base, e = {block.e:.4g}"]
    else:
        lines += ["each support:", f"K = {block.K:.4g} N/m", f"C = {block.C:.4g} N s/m",
                  rf"η = {block.eta:.4g}, $ξ_v$ = {block.xi_v:.4g}, ε = {block.epsilon:.4g}"]
    if math.isfinite(block.friction):
        lines += [f"friction μ = {block.friction:.4g}"]
    for name, tie in links(block).items():
        ends = f"({tie.block_x:.4g}, {tie.block_z:.4g}) to ({tie.ground_x:.4g}, {tie.ground_z:.4g}) m"
        lines += ["", f"{name.replace('_', ' ')}: {ends}", f"k = {tie.stiffness:.4g} N/m"]
        for key, unit in _engine.link_numbers():
            if key not in ("block_x", "block_z", "ground_x", "ground_z", "stiffness") and getattr(tie, key, None):
                lines += [f"{key.replace('_', ' ')} {getattr(tie, key):.4g} {'' if unit == '1' else unit.replace('.', ' ')}"]
    return lines
