#!/usr/bin/env python3
"""Validation in space against shaking-table tests: does a rock on its real feet overturn?

    python lab/validation/shaking_table_in_space.py FOLDER [--members N] [--feet 16|all] [--json] [--plot FILE]

A folder holds `tests.csv`, `motions.npz`, `rocks.json` and `feet.json`, which has the feet and the inertia of each scan. Nothing is fitted
to a test. Needs the Python package `rocking_block` and NumPy.

The rule was stated before any outcome was compared with a run:

- Body: feet, height of the centre of mass and inertia tensor of a scan. Each rock has two scans, which alternate. `--feet 16` takes the
  sixteen feet that stand for the hull, with its second resting facet where a scan has such a set; `all` its 50 to 86 points.
- Unit of prediction: an ensemble of `--members` blocks for each rock, each shaken by all motions. Each number below takes the midpoints of
  equally likely parts of its distribution, in an order of its own (a Latin hypercube, seed 1).
- Supports: η = ω_v/p uniform in its logarithm from 60 to 200, with p = √(3 g/(4 R0)): the rock sinks by 0.01 to 0.1 mm; ξ_v from 0.05 to 0.5
  and κ from 0.5 to 2, likewise; μ uniform from 0.5 to 0.8, rock on a table.
- Scan: an independent normal error of each foot's gap of 0.3 mm, with which the barrier is as uncertain as the scans leave it (20 to 30 %);
  the block then settles on the three feet that carry it.
- Table: yaw −10°, 0 and 10° in equal parts, each the given way and turned by 180°, since the sign of the motion is not known.
- Motion: scaled by a lognormal factor of 10 %, as for the block in the plane.
- Probability of overturning: (overturned + 1/2)/(members + 1). Runs that fail or remain undecided count by half.
"""

import argparse
import itertools
import json
import math
import sys
from pathlib import Path
from statistics import NormalDist

import numpy as np
import rocking_block as rb

sys.path.insert(0, str(Path(__file__).parent))
from shaking_table import Folder, gain, judged, mcnemar, probabilities, reliability, rule, wilson  # noqa: E402

SCANS = {"SP1": ("SP1", "SP1_scan"), "SP2": ("SP2", "SP2_cloud")}
YAWS = [math.radians(turn + yaw) for turn in (0, 180) for yaw in (-10, 0, 10)]
GAP_ERROR = 3e-4


def ensemble(members, seed=1):
    """Returns the numbers of each member: a Latin hypercube."""
    generator = np.random.default_rng(seed)
    parts = lambda: (generator.permutation(members) + 0.5) / members
    logarithmic = lambda least, greatest: least * (greatest / least) ** parts()
    normal = np.array([NormalDist().inv_cdf(part) for part in parts()])
    return {
        "eta": logarithmic(60, 200),
        "xi_v": logarithmic(0.05, 0.5),
        "kappa": logarithmic(0.5, 2),
        "friction": 0.5 + 0.3 * parts(),
        "yaw": np.array(YAWS)[np.floor(len(YAWS) * parts()).astype(int)],
        "scale": np.exp(0.1 * normal),
        "seed": generator.integers(2**31, size=members),
    }


def turned(angle):
    """Returns the matrix of a rotation about the vertical."""
    sin, cos = math.sin(angle), math.cos(angle)
    return np.array([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]])


def settled(places, inertia):
    """Returns feet and inertia of a body after it has settled on the three lowest feet around its centre of mass.

    Of all planes below the feet, that which carries the body is the highest under its centre of mass.
    """
    x, y, z = places.T
    triples = np.array(list(itertools.combinations(range(len(places)), 3)))
    planes = np.stack([np.ones(triples.shape), x[triples], y[triples]], axis=-1)
    wide = np.abs(np.linalg.det(planes)) > 1e-9
    solved = np.linalg.solve(planes[wide], z[triples[wide]][..., None])[..., 0]
    gaps = z[None, :] - solved @ np.stack([np.ones(len(places)), x, y])
    below = np.flatnonzero(gaps.min(axis=1) > -1e-12)
    best = below[np.argmax(solved[below, 0])]
    normal = np.array([-solved[best, 1], -solved[best, 2], 1.0])
    normal /= np.linalg.norm(normal)
    axis, cos = np.cross(normal, [0, 0, 1]), normal[2]
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    rotation = np.eye(3) + cross + cross @ cross / (1 + cos)
    level = places @ rotation.T
    height = -level[triples[wide][best], 2].mean()
    feet = level + [0, 0, height]
    feet[triples[wide][best], 2] = 0.0
    feet[:, 2] = np.maximum(feet[:, 2], 0.0)
    return feet, height, rotation @ inertia @ rotation.T


def block(scan, which, number, draw):
    """Returns the block of a member."""
    feet = np.array(scan["contact_points"] if which == "all" else scan["feet"].get("16_valley", scan["feet"]["16"])["points"])
    places = feet - [0, 0, scan["h"]]
    places[:, 2] += GAP_ERROR * np.random.default_rng(draw["seed"][number]).standard_normal(len(places))
    rotation = turned(draw["yaw"][number])
    feet, height, inertia = settled(places @ rotation.T, rotation @ np.array(scan["inertia"]) @ rotation.T)
    numbers = {name: float(draw[name][number]) for name in ("xi_v", "kappa", "friction")}
    tensor = [inertia[0, 0], inertia[1, 1], inertia[2, 2], inertia[0, 1], inertia[0, 2], inertia[1, 2]]
    given = {"feet": feet, "center_height": height, "inertia_tensor": tensor, "mass": scan["mass_listed"]}
    p = rb.BlockInSpace(**given, **numbers, omega_v=1e3).p
    return rb.BlockInSpace(**given, **numbers, omega_v=float(draw["eta"][number]) * p)


def in_space(folder, scans, rock, members, which):
    """Returns the probability of overturning for each test, with the shares of failed and undecided runs."""
    overturned, unknown = np.zeros(len(folder.records)), np.zeros(len(folder.records))
    draw = ensemble(members)
    for number in range(members):
        scan = scans[SCANS[rock][number % len(SCANS[rock])]]
        outcome = block(scan, which, number, draw).outcomes(folder.records, scale=float(draw["scale"][number]))["outcome"]
        overturned += outcome == "overturned"
        unknown += (outcome == "undecided") | (outcome == "failed")
        print(f"{rock}: {number + 1} of {members} blocks", file=sys.stderr, flush=True)
    return (overturned + 0.5 * unknown + 0.5) / (members + 1), float(unknown.sum()) / (members * len(folder.records))


def assess(folder, scans, rock, members, which):
    """Returns all predictions for one rock."""
    happened = folder.overturned(rock)
    found, unknown = in_space(folder, scans, rock, members, which)
    plane = probabilities(folder, rock, rule(folder, rock), 9)
    predictions = {"in space, on the scanned feet": found, "in the plane, equal barrier": plane, "always stays": np.zeros(len(happened))}
    only_space, only_plane, chance = mcnemar(happened, found, plane)
    return {
        "tests": len(happened),
        "overturned": int(happened.sum()),
        "unknown runs": unknown,
        "predictions": {name: judged(happened, p) for name, p in predictions.items()},
        "mean probability": float(found.mean()),
        "reliability": reliability(happened, found),
        "McNemar": {"only in space right": only_space, "only in the plane right": only_plane, "p": chance},
        "gain": gain(happened, found, plane, folder.motions()),
        "probabilities": {"happened": happened.tolist(), "space": found.tolist(), "plane": plane.tolist()},
    }


def show(results):
    for rock, found in results.items():
        print(f"\n{rock}: {found['tests']} tests, {found['overturned']} overturned; {found['mean probability'] * found['tests']:.1f} predicted")
        print(f"  {'':34}accuracy  precision  recall    AUC  Brier")
        for name, judge in found["predictions"].items():
            numbers = (judge["accuracy"], judge["precision"], judge["recall"], judge["AUC"], judge["Brier"])
            print(f"  {name:34}" + "{:8.3f}{:11.3f}{:8.3f}{:7.3f}{:7.3f}".format(*numbers))
        print("  reliability in space: predicted, happened, tests")
        for predicted, frequency, count in found["reliability"]:
            print(f"    {predicted:6.2f} {frequency:6.2f} {count:6d}")
        test = found["McNemar"]
        print(f"  only in space right {test['only in space right']}, only in the plane {test['only in the plane right']}")
        mean, low, high = found["gain"]
        print(f"  accuracy in space over that in the plane: {mean:+.3f} ({low:+.3f} to {high:+.3f}, 95 % by motions)")
        print(f"  runs that failed or remained undecided: {found['unknown runs']:.2%}")


def draw(results, path):
    """Draws the reliability of the model in space, with 95 % intervals of the frequencies."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axis = plt.subplots(figsize=(4.6, 4.0), layout="constrained")
    for (rock, found), (colour, marker) in zip(results.items(), (("#0072b2", "o"), ("#d55e00", "s"))):
        predicted, frequency, count = map(np.array, zip(*found["reliability"]))
        bars = np.abs(wilson(frequency, count) - frequency)
        axis.errorbar(predicted, frequency, bars, fmt=marker + "-", color=colour, capsize=3, label=f"{rock}, in space, nothing fitted")
    axis.plot([0, 1], [0, 1], color="0.6", linewidth=1)
    axis.set(xlabel="predicted probability of overturning", ylabel="observed frequency", xlim=(0, 1), ylim=(-0.02, 1.02))
    axis.legend(frameon=False, loc="lower right")
    figure.savefig(path, dpi=200)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", help="tests, motions and feet")
    parser.add_argument("--members", type=int, default=12, help="blocks of each rock (default: %(default)s)")
    parser.add_argument("--feet", choices=["16", "all"], default="16", help="feet of a scan (default: %(default)s)")
    parser.add_argument("--plot", metavar="FILE", help="reliability as a picture (needs matplotlib)")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    arguments = parser.parse_args()
    folder = Folder(arguments.folder)
    scans = json.loads((Path(arguments.folder) / "feet.json").read_text())["rocks"]
    results = {rock: assess(folder, scans, rock, arguments.members, arguments.feet) for rock in SCANS}
    if arguments.plot:
        draw(results, arguments.plot)
    if arguments.json:
        print(json.dumps(results))
    else:
        print(f"{len(folder.rows)} tests ({folder.left_out} without a motion left out), {arguments.members} blocks of each rock")
        show(results)


if __name__ == "__main__":
    main()
