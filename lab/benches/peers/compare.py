"""Compares this project's core with the solvers that engineers would otherwise use; `run` calls this script.

Prints the cost of an error for each solver, writes every point to docs/code/peers.csv, and draws the work-precision diagram
docs/pictures/peers.png. A run without some solvers or cases writes both to target/peers. README.md in this folder describes the comparison.
"""

import argparse
import csv
import json
import math
import os
import subprocess
import sys
from dataclasses import asdict, fields
from pathlib import Path

import cases
import diagram
from work import Point, cheapest

HERE = Path(__file__).resolve().parent
BUILT = cases.ROOT / "target" / "peers"

OURS = "this project"
# Command of each solver, and its methods for pulses and for records. At samples, "restart" starts again, "stop" stops and
# continues with the history, and "through" steps over the kinks.
SOLVERS = {
    OURS: ([BUILT / "release" / "ours"], ["dop853"], ["dop853"]),
    "CVODE Adams": (
        [BUILT / "cvode"],
        ["adams-fixed", "adams-newton"],
        [f"adams-{by}-{at}" for by in ("fixed", "newton") for at in ("restart", "stop", "through")],
    ),
    "CVODE BDF": ([BUILT / "cvode"], ["bdf-newton"], [f"bdf-newton-{at}" for at in ("restart", "stop", "through")]),
    "Boost.odeint": (
        [BUILT / "odeint"],
        ["dopri5", "fehlberg78", "bulirsch-stoer"],
        [f"{name}-{at}" for name in ("dopri5", "fehlberg78") for at in ("restart", "stop", "through")],
    ),
    "differential-equations": (
        [BUILT / "release" / "differential_equations"],
        ["dop853", "verner76", "verner98"],
        [f"{name}-{at}" for name in ("dop853", "verner76", "verner98") for at in ("restart", "through")],
    ),
    # Under the record it passed by lift-offs right after a sample.
    "heyoka": ([sys.executable, HERE / "heyoka_peer.py"], ["taylor"], []),
    "SciPy DOP853": (
        [sys.executable, HERE / "scipy_peer.py"], ["DOP853"], ["DOP853-restart", "DOP853-through"]
    ),
    "SciPy LSODA": ([sys.executable, HERE / "scipy_peer.py"], ["LSODA"], ["LSODA-restart", "LSODA-through"]),
}
OPENSEES = "OpenSees"
# Integrator, penalty of the contacts, their horizontal stiffness (both relative to the stiffness of a support).
OPENSEES_METHODS = ["trbdf2-1e2-10", "trbdf2-1e3-3", "trbdf2-1e3-10", "trbdf2-1e3-30", "trbdf2-1e4-10", "hht-1e3-10"]
OPENSEES_STEPS = [1e-3, 2.5e-4, 1e-4]
SLOW = {"heyoka", "SciPy DOP853", "SciPy LSODA"}
SHOWN = ["sine_eta40", cases.RECORD]
ORDER = [*cases.PULSES, cases.RECORD, cases.ELASTIC]
ERRORS = [10.0**-digit for digit in range(6, 12)]


def tolerances(solver, case, quick):
    """Returns the tolerances of a solver on a case."""
    if quick:
        return [1e-5, 1e-8, 1e-11]
    if case == cases.RECORD and solver in SLOW:
        return [1e-6, 1e-8, 1e-10, 1e-12, 1e-13]
    # Half decades for the cases of the diagram. SciPy accepts no tolerance below 1e-13.
    halves = 2 if case in SHOWN and solver not in SLOW else 1
    return [10.0 ** (-exponent / halves) for exponent in range(3 * halves, 13 * halves + 1)]


def elastic_runs(arguments):
    """Returns the runs of the OpenSees case; the step takes the place of the tolerance."""
    command = [sys.executable, HERE / "opensees_peer.py"]
    methods, steps = OPENSEES_METHODS, OPENSEES_STEPS
    if arguments.quick:
        methods, steps = ["trbdf2-1e3-10"], [2.5e-4]
    ours = SOLVERS[OURS][0]
    runs = [(tolerance, OURS, "dop853", ours) for tolerance in (1e-2, 1e-4, 1e-6, 1e-8)]
    if OPENSEES in arguments.without:
        return runs
    return runs + [(step, OPENSEES, method, command) for step in steps for method in methods]


def call(command, *arguments):
    """Runs a solver and returns its answer; if it fails, prints one line and returns None."""
    command = [str(word) for word in (*command, *arguments)]
    environment = {**os.environ, "RUST_BACKTRACE": "0"}
    done = subprocess.run(command, check=False, capture_output=True, text=True, env=environment)
    try:
        result = json.loads(done.stdout)
    except json.JSONDecodeError:
        lines = [line for line in done.stderr.strip().splitlines() if not line.startswith("note:")]
        result = {"error": lines[-1] if lines else "no message"}
    if "error" in result:
        print(f"  {' '.join(Path(word).name for word in command)}: {result['error']}", file=sys.stderr)
        return None
    return result


def measure(case, folder, records, arguments):
    """Returns all points of a case."""
    values, samples = cases.numbers(case, records)
    path = folder / f"{case}.case"
    cases.write(path, values, samples)
    points, runs = {}, []
    if case == cases.ELASTIC:
        reference = call(SOLVERS[OURS][0], path, "dop853", 1e-12, "trace")["theta"]
        planned = elastic_runs(arguments)
    else:
        reference = cases.rotations(case)
        planned = [
            (tolerance, solver, method, SOLVERS[solver][0])
            for solver in arguments.solvers
            for tolerance in tolerances(solver, case, arguments.quick)
            for method in SOLVERS[solver][2 if samples else 1]
        ]
    for run in planned:
        tolerance, solver, method, command = run
        result = call(command, path, method, tolerance, "trace")
        if result is not None:
            error = cases.error(result["theta"], reference, values["alpha"])
            points[solver, method, tolerance] = Point(case, solver, method, tolerance, error, 0, 0, 0, math.inf)
            runs.append(run)
    # Solvers take turns, so that other load on the machine affects all of them; the shortest time counts.
    runs.sort(key=lambda run: -run[0])
    for _ in range(arguments.rounds):
        for tolerance, solver, method, command in runs:
            result = call(command, path, method, tolerance, "time", arguments.seconds)
            if result is not None:
                point = points[solver, method, tolerance]
                point.rhs, point.steps, point.events = result["rhs"], result["steps"], result["events"]
                point.cpu = min(point.cpu, result["cpu"])
    return [point for point in points.values() if math.isfinite(point.cpu)]


def summary(points, names, error):
    """Prints the cost of an error for each solver, and its ratio to ours."""
    for case in names:
        here = [point for point in points if point.case == case]
        if not here:
            continue
        print(f"\n{case}, at an error of {error:g} alpha")
        print(f"{'solver':24} {'CPU time':>12} {'x ours':>8}  {'method':22} {'calls':>9} {'x ours':>8}  method")
        ours = {
            quantity: cheapest([point for point in here if point.solver == OURS], error, quantity)[0]
            for quantity in ("cpu", "rhs")
        }
        for solver in SOLVERS:
            mine = [point for point in here if point.solver == solver]
            if not mine:
                continue
            cpu, by_cpu = cheapest(mine, error, "cpu")
            rhs, by_rhs = cheapest(mine, error, "rhs")
            if cpu is None:
                least = min(point.error for point in mine)
                print(f"{solver:24} never reaches it: its least error is {least:.1e} alpha")
                continue
            cpu_ratio, rhs_ratio = (
                f"{value / ours[quantity]:.2f}" if ours[quantity] else "-"
                for value, quantity in ((cpu, "cpu"), (rhs, "rhs"))
            )
            print(
                f"{solver:24} {1e6 * cpu:9.0f} us {cpu_ratio:>8}  {by_cpu:22} {rhs:9.0f} {rhs_ratio:>8}  {by_rhs}"
            )


def elastic(points):
    """How near OpenSees comes, and what it takes."""
    here = [point for point in points if point.case == cases.ELASTIC]
    if not here:
        return
    print(f"\n{cases.ELASTIC}: epsilon = 1, against our core at 1e-12")
    print(f"{'solver':14} {'method':16} {'step or tolerance':>18} {'error':>10} {'CPU time':>12}")
    for point in here:
        error = f"{point.error:.1e} alpha"
        print(f"{point.solver:14} {point.method:16} {point.tolerance:18.1e} {error} {1e6 * point.cpu:9.0f} us")
    theirs = [point for point in here if point.solver == OPENSEES]
    if theirs:
        nearest = min(theirs, key=lambda point: point.error)
        ours, _ = cheapest([point for point in here if point.solver == OURS], nearest.error, "cpu")
        print(
            f"OpenSees at its nearest: {nearest.error:.1e} alpha with {nearest.method}, a step of "
            f"{nearest.tolerance:g} s and {nearest.cpu:.2f} s of CPU time, {nearest.cpu / ours:.0f} times ours for that"
        )


def fewest_calls(points):
    """Which solver takes the fewest calls at each error on the pulse cases, and ours beside it."""
    print("\nRight-hand-side calls on pulses: the fewest, and ours")
    for case in cases.PULSES:
        here = [point for point in points if point.case == case]
        if not here:
            continue
        print(case)
        for error in ERRORS:
            rivals = {}
            for solver in SOLVERS:
                rhs, method = cheapest([point for point in here if point.solver == solver], error, "rhs")
                if rhs is not None:
                    rivals[solver] = rhs, method
            others = {solver: value for solver, value in rivals.items() if solver != OURS}
            first = min(others, key=lambda solver: others[solver][0], default=None)
            best = f"{first} ({others[first][1]}) {others[first][0]:.0f}" if first else "no peer reaches it"
            ours = f"{rivals[OURS][0]:.0f}" if OURS in rivals else "not reached"
            won = OURS in rivals and (first is None or rivals[OURS][0] <= others[first][0])
            print(f"  {error:.0e} alpha: {best:46} ours {ours:>6}{'  ours is the fewest' if won else ''}")


def parse():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="three tolerances, one round, three cases; writes nothing")
    parser.add_argument("--rounds", type=int, default=3, help="how often each run is timed (3)")
    parser.add_argument("--seconds", type=float, default=0.03, help="least CPU time of one timing (0.03)")
    parser.add_argument("--records", type=Path, default=cases.ROOT.parent / "shared" / "records")
    parser.add_argument("--cases", nargs="*", default=None, help="only these cases")
    parser.add_argument("--without", nargs="*", action="extend", default=[], help="not these solvers")
    parser.add_argument("--read", action="store_true", help="no runs: tables and diagram from docs/code/peers.csv")
    arguments = parser.parse_args()
    if arguments.quick:
        arguments.rounds = 1
    arguments.cases = arguments.cases or ([*SHOWN, cases.ELASTIC] if arguments.quick else ORDER)
    arguments.solvers = [solver for solver in SOLVERS if solver not in arguments.without]
    return arguments


def read(path):
    with path.open() as file:
        rows = list(csv.DictReader(file))
    return [Point(**{field.name: field.type(row[field.name]) for field in fields(Point)}) for row in rows]


def write(path, points):
    with path.open("w", newline="") as file:
        table = csv.DictWriter(file, [field.name for field in fields(Point)], lineterminator="\n")
        table.writeheader()
        for point in points:
            numbers = {"tolerance": f"{point.tolerance:.2e}", "error": f"{point.error:.3e}", "cpu": f"{point.cpu:.4e}"}
            table.writerow({**asdict(point), **numbers})


def main():
    arguments = parse()
    table, missing = cases.ROOT / "docs/code/peers.csv", []
    if arguments.read:
        points = read(table)
    else:
        folder = BUILT / "cases"
        folder.mkdir(parents=True, exist_ok=True)
        points = []
        for case in arguments.cases:
            print(case, flush=True)
            try:
                points += measure(case, folder, arguments.records, arguments)
            except cases.MissingRecord as error:
                missing.append(case)
                print(f"  left out: {error}; the record may not be redistributed")
    summary(points, [case for case in arguments.cases if case != cases.ELASTIC], 1e-8)
    elastic(points)
    fewest_calls(points)
    if arguments.quick:
        print("\n--quick: nothing written")
        return
    if not arguments.read:
        # The points of two runs must not stand in one table: ratios are those of one machine in one state.
        if arguments.cases != ORDER or arguments.without or missing:
            table = BUILT / table.name
        write(table, points)
    diagram.draw(points, SHOWN, table.with_suffix(".png"))
    print(f"\nwritten: {table}, {table.with_suffix('.png').name}")


if __name__ == "__main__":
    main()
