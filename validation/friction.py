#!/usr/bin/env python3
"""Friction needed by the runs of a typical sweep: the longest time for which |H|/(N_L + N_R) is above 0.3, 0.5 and 0.7.

    python validation/friction.py [--runs 200] [--json]

Blocks of alpha 0.1 to 0.35 rad and p 1 to 5 rad/s on supports of eta 20 to 100 and xi_v 0.05 to 0.4, drawn with a fixed seed,
under the two records of the project at 1 to 6 times their strength; those that leave full contact count. Needs the Python
package `rocking_block` and NumPy.
"""

import argparse
import json
from pathlib import Path

import numpy as np
import rocking_block as rb

RECORDS = Path(__file__).resolve().parents[1] / "records"
STEP = 2.5e-4
LEVELS = (0.3, 0.5, 0.7)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=200, help="blocks that are drawn (default: %(default)s)")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    arguments = parser.parse_args()
    generator = np.random.default_rng(1)
    records = [rb.read_record(path) for path in sorted(RECORDS.glob("*.smc"))]
    longest, slenderness = [], []
    for _ in range(arguments.runs):
        alpha, p = generator.uniform(0.1, 0.35), generator.uniform(1, 5)
        eta, xi_v = generator.uniform(20, 100), generator.uniform(0.05, 0.4)
        scale, record = generator.uniform(1, 6), records[generator.integers(len(records))]
        block = rb.Block(alpha=alpha, p=p, eta=eta, xi_v=xi_v)
        run = block.run(record, scale=scale, step=STEP, progress=False)
        if run.counts.liftoffs == 0:
            continue
        demand = run.friction_demand
        # The longest uninterrupted time above each level.
        pieces = []
        for level in LEVELS:
            above = np.concatenate([[0], (demand > level).astype(int), [0]])
            ends = np.flatnonzero(np.diff(above))
            pieces.append(STEP * max(ends[1::2] - ends[::2], default=0))
        longest.append(pieces)
        slenderness.append(alpha)
    longest, slenderness = np.array(longest), np.array(slenderness)
    shares = {f"{level}": float(np.mean(longest[:, i] > 1e-3)) for i, level in enumerate(LEVELS)}
    by_slenderness = {
        f"alpha {low} to {high}": float(np.mean(longest[(slenderness >= low) & (slenderness < high), 1] > 1e-3))
        for low, high in ((0.1, 0.2), (0.2, 0.3), (0.3, 0.35))
    }
    results = {
        "runs that rock": len(longest),
        "share above a friction demand for more than 1 ms": shares,
        "share above 0.5 by slenderness": by_slenderness,
        "median of the longest time above 0.5 where it is above (s)": float(
            np.median(longest[longest[:, 1] > 0, 1]) if (longest[:, 1] > 0).any() else 0.0
        ),
    }
    if arguments.json:
        return print(json.dumps(results))
    for name, value in results.items():
        print(f"{name}: {value}")
    return None


if __name__ == "__main__":
    main()
