#!/usr/bin/env python3
"""Validation against first impacts of limestone blocks: the ratio of the angular velocities after and before.

    python lab/validation/limestone.py FOLDER [--json]

The folder holds `first_impacts.csv`: group, trial, height of the block (its width is 0.05 m) and the ratio. Parameters are
fitted to half of the groups and judged on the other half, both ways, over all divisions of the groups into halves.
Needs the Python package `rocking_block` and NumPy.

- Housner (1963): the ratio of a block that conserves its angular momentum about the new corner, with half width b and half
  height h: e = 1 − 3/2 sin² α, alpha = atan(b/h). Nothing is fitted.
- A constant.
- A restitution factor: the same multiple of Housner's ratio for all blocks.
- Another base: Housner's ratio of a base that is narrower or wider by the same factor for all blocks.
- Supports: the block on viscoelastic supports (Palmeri and Makris 2008), released at half its slenderness; its vertical
  circular frequency, taken to vary as H^(-1/2), and damping ratio are fitted on a grid.
- The floor: each trial predicted by the mean of the other trials of its group. No rule based on the block alone can do better.
"""

import argparse
import csv
import itertools
import json
import math
from pathlib import Path
from statistics import NormalDist

import numpy as np
import rocking_block as rb

HALF_WIDTH = 0.025


def housner(half_width, half_height):
    """Returns Housner's ratio of angular velocities for a homogeneous rectangle."""
    alpha = np.arctan2(half_width, half_height)
    return 1 - 1.5 * np.sin(alpha) ** 2


def on_supports(height, frequency, damping):
    """Returns the ratio of angular velocities after and before the first impact on supports.

    They are those just before the landing and when the other corner lifts. `frequency` (rad/s) is that of a block of 0.5 m.
    """
    half_height = height / 2
    alpha, radius = math.atan2(HALF_WIDTH, half_height), math.hypot(HALF_WIDTH, half_height)
    p = math.sqrt(0.75 * 9.81 / radius)
    block = rb.Block(alpha=alpha, p=p, eta=frequency * math.sqrt(0.5 / height) / p, xi_v=damping)
    run = block.run(theta=alpha / 2, duration=4 / p, step=2e-4 / p, progress=False)
    regimes = [event.after for event in run.events]
    landing = next(event.t for event in run.events if event.event == "landing")
    lifts = [event.t for event in run.events if event.event == "lift-off" and event.t > landing]
    if not lifts or "separated" in regimes:
        return math.nan
    rate = lambda t: abs(np.interp(t, run.t, run.theta_dot))
    return rate(lifts[0]) / rate(landing)


FREQUENCIES = (150.0, 300.0, 600.0, 1200.0, 2400.0)
DAMPINGS = (0.02, 0.05, 0.1, 0.2, 0.4)


def rules(heights):
    """Returns each rule's predictions for all trials, one row per candidate of the fit."""
    half = heights / 2
    e = housner(HALF_WIDTH, half)
    parts = np.linspace(0.8, 1.05, 251)
    widths = np.linspace(0.5, 1.5, 201)
    different = np.unique(heights)
    place = np.searchsorted(different, heights)
    pairs = list(itertools.product(FREQUENCIES, DAMPINGS))
    supports = np.array([[on_supports(height, *pair) for height in different] for pair in pairs])
    known = ~np.isnan(supports).any(axis=1)
    return {
        "Housner": e[None, :],
        "constant": np.linspace(0.85, 1.0, 151)[:, None] * np.ones(len(heights)),
        "restitution factor": parts[:, None] * e,
        "another base": np.array([housner(HALF_WIDTH * width, half) for width in widths]),
        "supports": supports[known][:, place],
    }, {
        "restitution factor": parts,
        "another base": widths,
        "supports": [pair for pair, is_known in zip(pairs, known) if is_known],
    }


def rms(errors):
    return float(np.sqrt(np.mean(np.square(errors))))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", metavar="FOLDER")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    arguments = parser.parse_args()
    with open(Path(arguments.folder) / "first_impacts.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    groups = np.array([row["g"] for row in rows])
    heights, ratios = (np.array([float(row[name]) for row in rows]) for name in ("H", "first"))
    names = np.unique(groups)
    predictions, fitted = rules(heights)
    errors = {name: [] for name in predictions}
    for chosen in itertools.combinations(names, len(names) // 2):
        fit = np.isin(groups, chosen)
        for name, candidates in predictions.items():
            best = np.argmin(np.square(candidates[:, fit] - ratios[fit]).sum(axis=1))
            errors[name].append(rms(candidates[best, ~fit] - ratios[~fit]))
    others = np.array([ratios[(groups == g) & (np.arange(len(ratios)) != i)].mean() for i, g in enumerate(groups)])
    spread = math.sqrt(sum(np.square(ratios[groups == g] - ratios[groups == g].mean()).sum() for g in names)
                       / (len(ratios) - len(names)))
    means = np.array([ratios[groups == g].mean() for g in groups])
    expected = sum(1 - NormalDist(mean, spread).cdf(1.0) for mean in means)
    e = predictions["Housner"][0]
    by_chance = sum(1 - NormalDist(mean, spread).cdf(1.0) for mean in e)
    results = {
        "trials": len(ratios),
        "groups": len(names),
        "Housner, mean error": float((ratios - e).mean()),
        "RMSE on groups that were not fitted": {name: float(np.mean(values)) for name, values in errors.items()},
        "of single divisions": {name: [min(values), max(values)] for name, values in errors.items()},
        "fitted to all": {
            name: fitted[name][int(np.argmin(np.square(candidates - ratios).sum(axis=1)))]
            for name, candidates in predictions.items() if name in fitted
        },
        "floor: by the other trials of the group": rms(others - ratios),
        "spread within groups": spread,
        "ratios above 1": int((ratios > 1).sum()),
        "ratios above 1 expected from that spread about the means of the groups": expected,
        "ratios above 1 expected from that spread about Housner's": by_chance,
    }
    if arguments.json:
        return print(json.dumps(results))
    print(f"{results['trials']} first impacts in {results['groups']} groups; measured less Housner's ratio: "
          f"{results['Housner, mean error']:+.4f} on average")
    print("root mean square error on unfitted groups: mean of all divisions into halves (least, greatest)")
    for name, value in results["RMSE on groups that were not fitted"].items():
        low, high = results["of single divisions"][name]
        print(f"  {name:22}{value:.4f}  ({low:.4f}, {high:.4f})")
    print(f"  {'floor':22}{results['floor: by the other trials of the group']:.4f}  by the other trials of the group")
    for name, value in results["fitted to all"].items():
        print(f"{name}, fitted to all: {value if isinstance(value, tuple) else round(float(value), 4)}")
    print(f"ratios above 1: {results['ratios above 1']}; a normal scatter of {spread:.3f} (as within the groups) about the "
          f"groups' means gives {expected:.1f}, about Housner's ratios {by_chance:.1f}")
    return None


if __name__ == "__main__":
    main()
