"""The cases of tests/reference: their parameters in the form that all solvers read, and their reference rotations."""

import csv
import json
import math
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
REFERENCE = ROOT / "tests" / "reference"

PULSES = [
    "sine_eta20", "sine_eta40", "sine_eta80", "cosine_small_block", "free_095", "tilted_release", "sine_rigid",
]
RECORD = "rinaldi"
# sine_eta20 for a finite-element program: without impact map, and with more damping, since landings that nothing else damps would
# amplify any difference. Its only reference is our own core at 1e-12.
ELASTIC = "sine_eta20_elastic"
RECORD_FILE = "paper/NGA_no_1063_RRS228.AT2"

# The lines of a case file, in this order; the samples of a record (m/s^2) follow.
KEYS = [
    "alpha", "p", "eta", "xi_v", "epsilon", "gamma", "gravity", "rigid", "shape", "a_p", "omega_p", "settled", "theta",
    "theta_dot", "t_end", "dt", "record_dt", "record_samples",
]
SHAPES = {None: 0, "record": 0, "sine": 1, "cosine": 2}


class MissingRecord(Exception):
    """The case's record is missing; it may not be redistributed."""


def read_at2(path, gravity):
    """Returns time step (s) and samples (m/s^2) of a PEER file."""
    lines = path.read_text().splitlines()
    count, time_step = (float(x) for x in lines[3].replace(",", " ").split()[:2])
    samples = [gravity * float(x) for line in lines[4:] for x in line.split()]
    assert len(samples) == int(count), f"{path} has {len(samples)} samples; its header says {int(count)}"
    return time_step, samples


def numbers(name, records):
    """Returns the case as a dictionary of KEYS, and its record's samples."""
    if name == ELASTIC:
        values, samples = numbers("sine_eta20", records)
        return {**values, "epsilon": 1.0, "xi_v": 0.4}, samples
    case = next(case for case in json.loads((REFERENCE / "cases.json").read_text()) if case["name"] == name)
    motion, initial = case["a_gx"], case.get("initial", {})
    record_dt, samples = 0.0, []
    if motion.get("kind") == "record":
        path = records / RECORD_FILE
        if not path.exists():
            raise MissingRecord(f"{name}: {path} is missing")
        record_dt, samples = read_at2(path, motion["scale"] * case["g"])
    values = {
        **{key: case.get(key, 0.0) for key in ("alpha", "p", "eta", "xi_v", "epsilon", "t_end", "dt")},
        "gamma": case.get("gamma", 3.0),
        "gravity": case["g"],
        "rigid": int(case.get("foundation") == "rigid"),
        "shape": SHAPES[motion.get("kind")],
        "a_p": motion.get("a_p", 0.0),
        "omega_p": motion.get("omega_p", 0.0),
        "settled": int("theta" in initial),
        "theta": initial.get("theta", 0.0),
        "theta_dot": initial.get("theta_dot", 0.0),
        "record_dt": record_dt,
        "record_samples": len(samples),
    }
    return values, samples


def write(path, values, samples):
    """Writes a case file."""
    lines = [f"{key} {values[key]!r}" for key in KEYS] + [repr(sample) for sample in samples]
    path.write_text("\n".join(lines) + "\n")


def read(path):
    """Reads a file of `write`."""
    lines = path.read_text().splitlines()
    values = {key: float(line.split()[1]) for key, line in zip(KEYS, lines, strict=False)}
    return values, [float(line) for line in lines[len(KEYS):]]


def rotations(name):
    """Returns the reference rotation (rad) at multiples of its dt."""
    with (REFERENCE / f"{name}.csv").open() as file:
        return [float(row["theta"]) for row in csv.DictReader(file)]


def error(theta, reference, alpha):
    """Returns the largest error in units of alpha; infinite if values are missing or not finite."""
    worst = 0.0
    for ours, right in zip(theta, reference, strict=True):
        if not math.isfinite(ours):
            return math.inf
        worst = max(worst, abs(ours - right) / alpha)
    return worst
