"""The comparison with other solvers: its script with a solver that answers at once, and the figures that README and docs take from its table."""

import json
import re
import sys
from argparse import Namespace

import pytest
from conftest import ROOT

pytest.importorskip("matplotlib")
sys.path.insert(0, str(ROOT / "lab/benches/peers"))
import cases  # noqa: E402
import compare  # noqa: E402
from work import cheapest  # noqa: E402

OURS = compare.OURS
POINTS = compare.read(ROOT / "docs/code/peers.csv")


def test_a_run_measures_each_solver(tmp_path, monkeypatch):
    """A stand-in gives the reference's rotations, and then its work."""
    stand_in = tmp_path / "solver.py"
    answer = json.dumps({"theta": list(cases.rotations("sine_eta20"))})
    work = json.dumps({"rhs": 100, "steps": 10, "events": 3, "cpu": 1e-4})
    stand_in.write_text(f"import sys\nprint({answer!r} if sys.argv[4] == 'trace' else {work!r})\n")
    monkeypatch.setattr(compare, "SOLVERS", {OURS: ([sys.executable, stand_in], ["a"], ["a"])})
    arguments = Namespace(solvers=[OURS], quick=True, without=[], rounds=1, seconds=0.01)
    points = compare.measure("sine_eta20", tmp_path, tmp_path, arguments)
    assert [(point.error, point.rhs, point.steps, point.events, point.cpu) for point in points] == [(0.0, 100, 10, 3, 1e-4)] * 3


def cost(case, solver, quantity="cpu"):
    return cheapest([point for point in POINTS if point.case == case and point.solver == solver], 1e-8, quantity)[0]


def ratio(case, solver):
    return cost(case, solver) / cost(case, OURS)


def rounded(value):
    """As the table prints a ratio: with two digits below ten."""
    return f"{value:.2f}" if value < 9.995 else f"{value:.1f}" if value < 99.95 else f"{value:.0f}"


NAMES = {
    "differential-equations": "differential-equations", "heyoka": "heyoka", "Boost.odeint": "Boost.odeint",
    "CVODE in C": "CVODE Adams", "SciPy": "SciPy DOP853",
}


def test_the_table_of_single_runs_is_that_of_the_measured_points():
    text = (ROOT / "docs/code/performance.md").read_text()
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in text.splitlines() if line.startswith("| ")]
    head = next(row for row in rows if "sine_rigid" in row)
    assert head[1:] == [*cases.PULSES, cases.RECORD]
    ours = next(row for row in rows if row[0] == "this project, µs")
    assert ours[1:] == [f"{1e6 * cost(case, OURS):.0f}" for case in head[1:]]
    for name, solver in NAMES.items():
        row = next(row for row in rows if row[0].startswith(name))
        assert row[1:] == ["—" if solver == "heyoka" and case == cases.RECORD else rounded(ratio(case, solver)) for case in head[1:]], name


def test_the_readme_gives_the_ranges_of_that_table():
    text = " ".join((ROOT / "README.md").read_text().split())
    times = [1e3 * cost(case, OURS) for case in cases.PULSES]
    assert f"a pulse takes {min(times):.2f} to {max(times):.1f} ms" in text
    assert f"a record of 20 s {1e3 * cost(cases.RECORD, OURS):.1f} ms" in text

    def extent(solver, names):
        ratios = [ratio(case, solver) for case in names]
        return min(ratios), max(ratios)

    every = [*cases.PULSES, cases.RECORD]
    for words, solver, names, digits in (("best Rust solver needs", "differential-equations", every, 1), ("heyoka", "heyoka", cases.PULSES, 1),
                                         ("CVODE", "CVODE Adams", every, 0)):
        low, high = extent(solver, names)
        assert re.search(rf"{words} {low:.{digits}f} to {high:.{digits}f} times", text), (words, low, high)
    assert f"{ratio(cases.RECORD, 'SciPy DOP853'):.0f} times ours (SciPy)" in text
    frames = [point for point in POINTS if point.solver == "OpenSees"]
    least = min(point.error for point in frames)
    time = min(point.cpu for point in frames if point.error < 1.01 * least)
    assert f"{time:.1f} s for a pulse, at {least:.1e} α".replace("e-0", "e-") in text, (time, least)
