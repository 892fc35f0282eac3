#!/usr/bin/env python3
"""Compares this project's block in space with the same equations in C on SUNDIALS CVODE: error, evaluations and CPU time.

    lab/benches/peers/space/compare.py                    # builds both programs, and prints a table for docs/code/performance.md
    lab/benches/peers/space/compare.py --records FOLDER   # with the folder of the records that may not be redistributed

The cases are `two_axis`, `friction` and, if its records are at hand, `rinaldi` of tests/reference_space. The error is the greatest difference of
tilt_x, tilt_y and twist from the reference over α, at ten times; each is the end of a separate run. CPU time is the least of runs for 0.2 s.
Work at an error is interpolated on logarithmic scales along the points that no other point of the same method beats in both.
"""

import argparse
import csv
import json
import math
import subprocess
from itertools import pairwise
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[4]
REFERENCES = ROOT / "tests/reference_space"
OUT = ROOT / "target/peers"
LIBRARIES = ["cvode", "nvecserial", "sunmatrixdense", "sunlinsoldense", "sunnonlinsolfixedpoint", "generic"]
TOLERANCES = {"ours": [10.0**-k for k in range(5, 13)], "cvode": [10.0**-k for k in range(5, 14)]}
GOAL = 1e-8


def build():
    subprocess.run(["cargo", "build", "--release", "--manifest-path", ROOT / "lab/benches/peers/rust/Cargo.toml", "--target-dir", OUT,
                    "--bin", "space"], check=True)
    subprocess.run(["gcc", "-O3", "-std=gnu11", "-Wall", "-Wextra", Path(__file__).with_name("cvode_space.c"), "-o", OUT / "cvode_space",
                    *(f"-lsundials_{name}" for name in LIBRARIES), "-lm"], check=True)


def samples(path, motion):
    """Reads the accelerations of an AT2 file from the start of the case on, in m/s²."""
    words = " ".join(path.read_text().splitlines()[4:]).split()
    first = round(motion["start"] / motion["dt"])
    return np.array(words[first:], float) * motion["scale"] * 9.81


def write_case(case, records, path):
    """Writes the numbers that both programs read; returns False if a record is missing."""
    n, motions = case["numbers"], case["excitation"]
    sines, recorded = [], []
    for axis in ("a_gx", "a_gy", "a_gz"):
        motion = motions[axis] or {}
        sines.append([motion["a"], motion["omega"], motion["start"]] if "omega" in motion else [0.0, 1.0, 0.0])
        if "file" in motion:
            if not (records / motion["file"]).exists():
                return False
            recorded.append(samples(records / motion["file"], motion))
    count, step = (min(map(len, recorded)), motions["a_gx"]["dt"]) if recorded else (0, 1.0)
    inertia = np.array(n["inertia"])
    head = [len(n["feet"]), n["M"], n["g"], n["K"], n["C"], n["K_h"], n["C_h"], n["friction"], n["R0"], n["alpha"], case["parameters"]["p"],
            n["omega_v"], count, step]
    state = [*case["initial"]["X"], *case["initial"]["q"], *case["initial"]["V"], *case["initial"]["omega"]]
    feet = [[x, y, -n["center_height"], f] for (x, y), f in zip(n["feet"], n["f"], strict=True)]
    parts = [head, inertia.ravel(), np.linalg.inv(inertia).ravel(), np.ravel(sines), state, np.ravel(feet), *(a[:count] for a in recorded)]
    path.write_text("\n".join(" ".join(repr(float(x)) for x in part) for part in parts))
    return True


def attitude(q):
    """Returns tilt_x, tilt_y and twist of a quaternion."""
    w, x, y, z = np.array(q) / np.linalg.norm(q)
    axis = [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)]
    across = math.hypot(*axis[:2])
    tilt = math.atan2(across, axis[2])
    r = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z)], [2 * (x * y + w * z), 1 - 2 * (x * x + z * z)]])
    twist = math.atan2(r[1, 0] - r[0, 1], r[0, 0] + r[1, 1])
    return np.array([tilt * axis[0] / across, tilt * axis[1] / across, twist]) if across else np.array([0.0, 0.0, twist])


def run(program, method, case, tolerance, end, seconds):
    words = subprocess.run([program, case, method, str(tolerance), str(end), str(seconds)], check=False,
                           capture_output=True, text=True)
    if words.returncode != 0:
        return None
    *state, cpu, rhs, steps, events = map(float, words.stdout.split())
    return state, cpu, int(rhs), int(steps), int(events)


def measure(name, case, path):
    with (REFERENCES / f"{name}.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    t_end, alpha = case["t_final"], case["parameters"]["alpha"]
    chosen = [rows[round(k * t_end / 10 / case["dt"])] for k in range(1, 11)]
    points = {}
    methods = [("ours", OUT / "release/space", "-")]
    methods += [(f"CVODE {method}", OUT / "cvode_space", method) for method in ("adams", "bdf")]
    if case["excitation"]["a_gx"].get("file"):
        methods.append(("CVODE adams-through", OUT / "cvode_space", "adams-through"))
    for label, program, method in methods:
        for tolerance in TOLERANCES["ours" if label == "ours" else "cvode"]:
            error = 0.0
            for row in chosen:
                found = run(program, method, path, tolerance, float(row["t"]), 0)
                if found is None:
                    error = math.inf
                    break
                expected = [float(row[column]) for column in ("tilt_x", "tilt_y", "twist")]
                error = max(error, float(np.abs(attitude(found[0][3:7]) - expected).max()) / alpha)
            if math.isfinite(error):
                _, cpu, rhs, steps, events = run(program, method, path, tolerance, t_end, 0.2)
                points.setdefault(label, []).append((error, cpu, rhs))
                print(f"{name:10} {label:20} {tolerance:8.0e} {error:10.2e} {1e3 * cpu:10.3f} ms {rhs:8} calls {steps:6} steps {events:4} events",
                      flush=True)
            else:
                print(f"{name:10} {label:20} {tolerance:8.0e} fails", flush=True)
    return points


def at_error(points, goal, work):
    """Returns the work at an error, that of the loosest tolerance if even its error is less."""
    front, least = [], math.inf
    for error, *works in sorted(points):
        if works[work] < least:
            least = works[work]
            front.append((error, least))
    if front[-1][0] <= goal:
        return front[-1][1]
    for (e_0, w_0), (e_1, w_1) in pairwise(front):
        if e_0 <= goal <= e_1:
            share = math.log(goal / e_0) / math.log(e_1 / e_0)
            return math.exp((1 - share) * math.log(w_0) + share * math.log(w_1))
    return None


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--records", type=Path, default=ROOT / "../shared/records")
    parser.add_argument("--no-build", action="store_true")
    arguments = parser.parse_args()
    OUT.mkdir(parents=True, exist_ok=True)
    if not arguments.no_build:
        build()
    cases = {case["name"]: case for case in json.loads((REFERENCES / "cases.json").read_text())}
    print_rows = []
    for name in ("two_axis", "friction", "rinaldi"):
        path = OUT / f"space_{name}.txt"
        if not write_case(cases[name], arguments.records, path):
            print(f"{name} is left out: its records are missing")
            continue
        points = measure(name, cases[name], path)
        mine = [at_error(points["ours"], GOAL, work) for work in (0, 1)]
        for label, found in points.items():
            cpu, rhs = (at_error(found, GOAL, work) for work in (0, 1))
            if cpu is None or mine[0] is None:
                print_rows.append(f"| {name} | {label} | does not reach {GOAL:g} | | |")
            else:
                print_rows.append(f"| {name} | {label} | {1e3 * cpu:.3f} | {rhs:.0f} | {cpu / mine[0]:.1f} |")
    print(f"\n| case | solver | CPU time at {GOAL:g} α (ms) | calls | CPU time over ours |\n| --- | --- | --- | --- | --- |")
    print("\n".join(print_rows))


if __name__ == "__main__":
    main()
