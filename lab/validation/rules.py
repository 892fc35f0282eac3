#!/usr/bin/env python3
"""Least overturning velocities: a rule of thumb, and curves fitted to least levels against curves fitted to all levels.

    python lab/validation/rules.py [--blocks 62] [--json]

Blocks of alpha 0.1 to 0.35 rad and p 1 to 4 rad/s on a rigid base, drawn with a fixed seed, under both records of the project. v0 is the
velocity that overturns a block at rest when its base starts to move abruptly. Ishiyama (1982) takes 0.4 v0 for the least peak velocity of the
ground that overturns it. Needs the Python package `rocking_block`, NumPy and SciPy.
"""

import argparse
import json
import math
import warnings
from pathlib import Path

import numpy as np
import rocking_block as rb

RECORDS = Path(__file__).resolve().parents[2] / "examples/records"
LEVELS = np.geomspace(0.08, 3.0, 48)
# Peak velocities over v0, 2.5 % apart.
RATIOS = np.geomspace(0.15, 2.0, 106)


def sudden_velocity(block):
    """(R0/h) √(8/3 g R0 (1 − cos α)): the energy after the impulse is that of the balance."""
    return math.sqrt(8 / 3 * block.g * block.R0 * (1 - math.cos(block.alpha))) / math.cos(block.alpha)


def runs(blocks, record, levels):
    """A table of one record whose column PGV has these levels."""
    return rb.outcomes(blocks, [record], scale=levels / record.pgv, progress=False)


def curve(levels, overturned):
    """Median and dispersion of the curve that is fitted to all runs."""
    outcome = np.where(overturned, "overturned", "completed")
    fit = rb.fragility({"PGV": np.broadcast_to(levels, overturned.shape).ravel(), "outcome": outcome.ravel()}, "PGV", progress=False)
    return fit.median, fit.beta


def least_in_trains(block, cycles):
    """The least ratio of peak ground velocity to v0 that overturns a block, over trains of sines with these cycles under a half-sine envelope."""
    ratios = []
    for period in np.geomspace(0.5, 6.0, 20):
        t = np.arange(0.0, (cycles + 0.005) * period, period / 200)
        train = rb.Record(np.sin(2 * np.pi * t / period) * np.sin(np.pi * t / (cycles * period)), period / 200)
        overturned = runs([block], train, RATIOS * sudden_velocity(block))["outcome"] == "overturned"
        ratios += RATIOS[overturned][:1].tolist()
    return min(ratios)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--blocks", type=int, default=62, help="number of blocks drawn (default: %(default)s)")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    arguments = parser.parse_args()
    # Fast, large blocks need strong motions.
    warnings.filterwarnings("ignore", "scale = ")
    generator = np.random.default_rng(1)
    drawn = zip(generator.uniform(0.1, 0.35, arguments.blocks), generator.uniform(1, 4, arguments.blocks))
    blocks = [rb.Block(alpha=alpha, p=p, foundation="rigid") for alpha, p in drawn]
    records = [rb.read_record(path) for path in sorted(RECORDS.glob("*.smc"))]
    ratios = []
    for record in records:
        for block in blocks:
            overturned = runs([block], record, RATIOS * sudden_velocity(block))["outcome"] == "overturned"
            # A block that stands at all of them has a greater ratio than all others.
            ratios.append(RATIOS[overturned.argmax()] if overturned.any() else math.inf)
    # A site whose motions are stretched in time, and one statue: as many levels as the curve needs, from no to all overturning.
    motions = [rb.Record(record.acceleration, record.dt * stretch) for record in records for stretch in np.linspace(0.5, 1.5, 11)]
    statue = [rb.Block(alpha=0.16, p=p, foundation="rigid") for p in np.linspace(1.8, 2.4, 8)]
    # One row per block and motion, one column per level.
    overturned = np.concatenate([
        (runs(statue, motion, LEVELS)["outcome"] == "overturned").reshape(len(LEVELS), len(statue)).T for motion in motions
    ])
    after = np.maximum.accumulate(overturned, axis=1)
    first = np.where(after.any(axis=1), after.argmax(axis=1), -1)
    capacities = np.log(LEVELS[first[first >= 0]])
    results = {
        "cases": len(ratios),
        "least ratio": float(min(ratios)),
        "16 % fractile": float(np.quantile(ratios, 0.16, method="lower")),
        "median ratio": float(np.quantile(ratios, 0.5, method="lower")),
        "below 0.4": sum(bool(ratio < 0.4) for ratio in ratios),
        **{f"least of {cycles} cycles": least_in_trains(statue[4], cycles) for cycles in (1, 2, 4, 8, 16, 32)},
        "curves": len(overturned),
        "without overturning": int(np.sum(first < 0)),
        "not monotonic": int(np.sum((after & ~overturned).any(axis=1))),
        "standing above the least": float(np.mean(~overturned[after])),
        "least levels": (float(np.exp(capacities.mean())), float(capacities.std(ddof=1))),
        "all levels": curve(LEVELS, overturned),
        "all above the least overturned": curve(LEVELS, after),
    }
    print(json.dumps(results) if arguments.json else "\n".join(f"{name:32} {value}" for name, value in results.items()))


if __name__ == "__main__":
    main()
