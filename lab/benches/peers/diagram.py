"""The work-precision diagram: error against CPU time and against right-hand-side calls."""

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
from work import best, cheapest

# Curves differ without colour: in marker, fill, line and shade.
STYLES = {
    "this project": {"marker": "o", "linestyle": "-", "color": "black", "linewidth": 1.8, "markersize": 5},
    "CVODE Adams": {"marker": "s", "linestyle": "--", "color": "0.25", "markerfacecolor": "white"},
    "CVODE BDF": {"marker": "D", "linestyle": ":", "color": "0.25", "markerfacecolor": "white"},
    "Boost.odeint": {"marker": "v", "linestyle": "--", "color": "0.5", "markerfacecolor": "white"},
    "differential-equations": {"marker": "^", "linestyle": "-", "color": "0.5"},
    "heyoka": {"marker": "P", "linestyle": ":", "color": "0.5", "markerfacecolor": "white"},
    "SciPy DOP853": {"marker": "x", "linestyle": "-.", "color": "0.25"},
    "SciPy LSODA": {"marker": "+", "linestyle": (0, (1, 3)), "color": "0.25", "markersize": 9},
}
QUANTITIES = {"cpu": "CPU time of a run (s)", "rhs": "evaluations of the equations of motion"}
CASES = {"sine_eta40": "one-sine pulse on supports, η = 40", "rinaldi": "Rinaldi record on supports"}
SOLVERS = {
    "differential-equations": "differential-equations (Rust)", "CVODE Adams": "CVODE, Adams (C)", "CVODE BDF": "CVODE, BDF (C)",
    "Boost.odeint": "Boost.odeint (C++)", "heyoka": "heyoka (Taylor, LLVM)", "SciPy DOP853": "SciPy, DOP853", "SciPy LSODA": "SciPy, LSODA",
}


def line_of(points, quantity):
    """Returns the solver's cheapest method for an error of 1e-8, or its most accurate one, and that method's best points."""
    _, method = cheapest(points, 1e-8, quantity)
    if method is None:
        method = min(points, key=lambda point: point.error).method
    return method, best([point for point in points if point.method == method], quantity)


def draw(points, names, path):
    """Draws two panels for each case that was measured."""
    names = [name for name in names if any(point.case == name for point in points)]
    if not names:
        return
    figure, axes = plt.subplots(len(names), 2, figsize=(8, 3.2 * len(names) + 0.9), squeeze=False, layout="constrained")
    lines = {}
    for row, name in zip(axes, names, strict=True):
        for panel, (quantity, label) in zip(row, QUANTITIES.items(), strict=True):
            for solver, style in STYLES.items():
                mine = [point for point in points if point.case == name and point.solver == solver]
                if not mine:
                    continue
                _, kept = line_of(mine, quantity)
                (lines[solver],) = panel.loglog(
                    [getattr(point, quantity) for point in kept], [point.error for point in kept],
                    label=SOLVERS.get(solver, solver), **{"markersize": 4, "linewidth": 1.1, **style},
                )
            panel.axhline(1e-8, color="0.7", linewidth=0.8, zorder=0)
            panel.set(xlabel=label)
            panel.set_title(CASES.get(name, name), fontsize=10)
            panel.grid(True, which="major", color="0.9", linewidth=0.6)
        row[0].set_ylabel("largest error of θ/α")
    shown = [lines[solver] for solver in STYLES if solver in lines]
    figure.legend(handles=shown, loc="outside lower center", ncols=4, fontsize=8.5, frameon=False, handlelength=3.5)
    figure.savefig(path, dpi=200)
