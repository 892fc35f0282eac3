#!/usr/bin/env python3
"""Variants of the model: other supports, restitutions, spreads and an unsymmetric block, on unfitted tests.

    python lab/validation/variants.py FOLDER [--json]

FOLDER is as for shaking_table.py. Each variant is a grid of parameters. The maximum-likelihood candidate on one half of the
motions, with all their scales, is judged on the other half; 25 random divisions, both ways, the same for all variants.

The unsymmetric block, with different half widths on its sides, is computed here with fixed steps: Housner's equations, with
angular momentum conserved about the landing corner. With equal half widths its outcomes are compared with the package's.
"""

import argparse
import itertools
import json
import math
from statistics import NormalDist

import numpy as np
from shaking_table import ALPHAS, GRAVITY, ROCKS, SPREAD, Folder, judged, over_slenderness, probabilities, rule

DIVISIONS = 25
# Slendernesses of the sides of the unsymmetric block.
SIDES = (0.09, 0.11, 0.13, 0.16, 0.20, 0.30)


def scales(samples):
    return np.array([math.exp(SPREAD * NormalDist().inv_cdf((i + 0.5) / samples)) for i in range(samples)])


def unsymmetric(folder, rock, pairs, samples, substeps=2):
    """Returns the probability of overturning for each pair of slendernesses (left, right) and each test."""
    height, inertia = folder.rocks[rock]["h"], folder.rocks[rock]["i_y"]
    dt = 0.005 / substeps
    longest = max(len(record.acceleration) for record in folder.records)
    ground = np.zeros((len(folder.records), longest + 1))
    for row, record in zip(ground, folder.records):
        row[: len(record.acceleration)] = record.acceleration
    axes = np.meshgrid(np.arange(len(ground)), scales(samples), np.arange(len(pairs)), indexing="ij")
    test, scale, pair = (axis.ravel() for axis in axes)
    left, right = np.array(pairs)[pair].T
    # By side: 0 left, 1 right.
    alpha = np.array([left, right])
    radius = height / np.cos(alpha)
    rate = radius / (inertia + radius**2)
    kept = (inertia + height**2 * (1 - np.tan(left) * np.tan(right))) / (inertia + radius**2)
    theta, omega = np.zeros(len(test)), np.zeros(len(test))
    over = np.zeros(len(test), dtype=bool)

    def acceleration(which, angle, sign, a_g):
        side = (sign > 0).astype(int)
        tilt = alpha[side, which] - sign * angle
        return -rate[side, which] * (sign * GRAVITY * np.sin(tilt) + a_g * np.cos(tilt))

    moving = np.zeros(len(test), dtype=bool)
    sign = np.ones(len(test))
    for sample, part in itertools.product(range(longest), range(substeps)):
        ahead = part / substeps, (part + 1) / substeps
        now, then = (ground[:, sample] * (1 - x) + ground[:, sample + 1] * x for x in ahead)
        # At rest until the ground tips the block over a corner.
        a_g = now[test] * scale
        tipped = ~moving & ~over & ((a_g > GRAVITY * np.tan(left)) | (a_g < -GRAVITY * np.tan(right)))
        sign[tipped] = np.where(a_g[tipped] > 0, -1.0, 1.0)
        moving |= tipped
        i = np.flatnonzero(moving)
        if not i.size:
            continue
        s = sign[i]
        middle = omega[i] + 0.5 * dt * acceleration(i, theta[i], s, a_g[i])
        angle = theta[i] + dt * middle
        speed = middle + 0.5 * dt * acceleration(i, angle, s, then[test[i]] * scale[i])
        # Blocks that land in this step finish it on the other corner.
        landed = np.flatnonzero(s * angle < 0)
        j, other = i[landed], -s[landed]
        part_left = dt * angle[landed] / (angle[landed] - theta[j])
        impact = speed[landed] - part_left * (speed[landed] - omega[j]) / dt
        after = impact * kept[(other > 0).astype(int), j]
        pull = acceleration(j, 0.0, other, then[test[j]] * scale[j])
        angle[landed] = after * part_left + 0.5 * pull * part_left**2
        speed[landed] = after + pull * part_left
        sign[j] = other
        theta[i], omega[i] = angle, speed
        still = landed[(np.abs(after) < 2e-3) | (other * angle[landed] < 0)]
        theta[i[still]] = omega[i[still]] = 0.0
        moving[i[still]] = False
        fell = np.abs(angle) > math.pi / 2
        over[i[fell]] = True
        moving[i[fell]] = False
    shape = (len(ground), samples, len(pairs))
    return ((over.reshape(shape).sum(axis=1) + 0.5) / (samples + 1)).T


def variants(folder, rock, samples):
    """Returns a dictionary: name → parameters of each candidate and its probabilities."""
    near = [alpha for alpha in ALPHAS if alpha < 0.18]
    made = lambda alpha, **options: probabilities(folder, rock, alpha, samples, **options)
    grid = np.array([made(alpha) for alpha in ALPHAS])
    reference = [({"alpha": alpha}, row) for alpha, row in zip(ALPHAS, grid)]
    yield "rigid base, fitted slenderness", reference
    yield "rigid base, equal barrier", [({"alpha": rule(folder, rock)}, made(rule(folder, rock)))]
    yield (
        "restitution factor",
        reference
        + [
            ({"alpha": alpha, "factor": factor}, made(alpha, restitution_factor=factor))
            for alpha, factor in itertools.product(near, (0.85, 0.9, 0.95))
        ],
    )
    yield (
        "viscoelastic supports",
        [
            ({"alpha": alpha, "eta": eta, "xi_v": xi_v}, made(alpha, foundation="viscoelastic", eta=eta, xi_v=xi_v))
            for alpha, eta, xi_v in itertools.product(near[::2], (20, 60), (0.1, 0.5))
        ],
    )
    yield (
        "viscoelastic supports, bouncing",
        [
            (
                {"alpha": alpha, "eta": 60, "epsilon": epsilon},
                made(alpha, foundation="viscoelastic", eta=60, xi_v=0.1, epsilon=epsilon),
            )
            for alpha, epsilon in itertools.product(near[::2], (0.3, 0.6))
        ],
    )
    yield "ensemble over slenderness", [
        ({"alpha": alpha, "spread": spread}, row) for alpha, spread, row in over_slenderness(grid)
    ]
    pairs = list(itertools.product(SIDES, SIDES))
    found = unsymmetric(folder, rock, pairs, samples)
    yield "equal half widths, computed here", [
        ({"alpha": a}, row) for (a, b), row in zip(pairs, found) if a == b
    ]
    yield "two half widths", [({"left": a, "right": b}, row) for (a, b), row in zip(pairs, found)]


def log_score(happened, probability):
    """Returns the mean natural logarithm of the probability of the actual outcome; 0 is best."""
    return float(np.log(np.where(happened, probability, 1 - probability)).mean())


def judge_all(folder, rock, samples, seed=1):
    happened, motions = folder.overturned(rock), folder.motions()
    names, generator = np.unique(motions), np.random.default_rng(seed)
    halves = []
    for _ in range(DIVISIONS):
        half = np.isin(motions, generator.permutation(names)[: len(names) // 2])
        halves += [half, ~half]
    results, first = {}, None
    for name, candidates in variants(folder, rock, samples):
        grid = np.array([row for _, row in candidates])
        rows, chosen = [], []
        for fit in halves:
            best = max(range(len(grid)), key=lambda k: log_score(happened[fit], grid[k][fit]))
            chosen.append(best)
            judge = judged(happened[~fit], grid[best][~fit])
            rows.append((log_score(happened[~fit], grid[best][~fit]), judge["accuracy"], judge["AUC"], judge["Brier"]))
        rows = np.array(rows)
        first = rows if first is None else first
        most = max(set(chosen), key=chosen.count)
        results[name] = dict(zip(("log score", "accuracy", "AUC", "Brier"), rows.mean(axis=0).tolist())) | {
            "better than the first": float(np.mean(rows[:, 0] > first[:, 0])),
            "chosen most often": {key: float(value) for key, value in candidates[most][0].items()},
            "candidates": len(candidates),
        }
    return results


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", metavar="FOLDER")
    parser.add_argument("--samples", type=int, default=5, help="runs of an ensemble (default: %(default)s)")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    arguments = parser.parse_args()
    folder = Folder(arguments.folder)
    results = {rock: judge_all(folder, rock, arguments.samples) for rock in ROCKS}
    if arguments.json:
        return print(json.dumps(results))
    print(f"means over {2 * DIVISIONS} unfitted halves of the motions; better: share of halves in which the log")
    print("score is above that of the first variant")
    for rock, found in results.items():
        print(f"\n{rock}")
        print(f"  {'':34}log score  accuracy    AUC  Brier  better  chosen most often")
        for name, judge in found.items():
            chosen = ", ".join(f"{key} {value:.3g}" for key, value in judge["chosen most often"].items())
            print(
                f"  {name:34}{judge['log score']:9.3f}{judge['accuracy']:10.3f}{judge['AUC']:7.3f}{judge['Brier']:7.3f}"
                f"{judge['better than the first']:8.2f}  {chosen}"
            )
    return None


if __name__ == "__main__":
    main()
