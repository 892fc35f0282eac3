#!/usr/bin/env python3
"""Effect of friction: the runs of a typical sweep without a limit, and with friction of 0.3, 0.5 and 0.7.

    python lab/validation/friction.py [--runs 200] [--json]

Blocks of alpha 0.1 to 0.35 rad and p 1 to 5 rad/s on supports of eta 20 to 100 and xi_v 0.05 to 0.4, drawn with a fixed seed,
under the two records of the project at 1 to 6 times their strength; only blocks that leave full contact count. Needs the
Python package `rocking_block` and NumPy.
"""

import argparse
import json
from pathlib import Path

import numpy as np
import rocking_block as rb

RECORDS = Path(__file__).resolve().parents[2] / "examples/records"
LEVELS = (0.3, 0.5, 0.7)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=200, help="number of blocks drawn (default: %(default)s)")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    arguments = parser.parse_args()
    generator = np.random.default_rng(1)
    records = [rb.read_record(path) for path in sorted(RECORDS.glob("*.smc"))]
    rows = []
    for _ in range(arguments.runs):
        alpha, p = generator.uniform(0.1, 0.35), generator.uniform(1, 5)
        eta, xi_v = generator.uniform(20, 100), generator.uniform(0.05, 0.4)
        scale, record = generator.uniform(1, 6), records[generator.integers(len(records))]

        def run(friction):
            block = rb.Block(alpha=alpha, p=p, eta=eta, xi_v=xi_v, friction=friction)
            run = block.run(record, scale=scale, progress=False)
            return run.outcome == "overturned", run.peak.theta / alpha, run

        fell, peak, plain = run(None)
        if plain.counts.liftoffs == 0:
            continue
        row = {"alpha": alpha, "fell": fell}
        for level in LEVELS:
            falls, with_friction, limited = run(level)
            change = 0.0 if fell or falls else abs(with_friction / peak - 1)
            row[level] = (falls != fell, change, limited.peak.slip)
        rows.append(row)
    results = {"runs that rock": len(rows), "overturned without a limit": sum(row["fell"] for row in rows)}
    for level in LEVELS:
        flips, changes, slips = (np.array([row[level][i] for row in rows]) for i in range(3))
        results[f"friction {level}"] = {
            "outcomes that change": int(flips.sum()),
            "peaks of rotation that change by more than 10 %": int((changes > 0.1).sum()),
            "blocks that slide by more than 1 mm": int((slips > 1e-3).sum()),
            "greatest slip (m)": round(float(slips.max()), 3),
            "smallest alpha (rad) with such a change of outcome or peak": round(
                min((row["alpha"] for row in rows if row[level][0] or row[level][1] > 0.1), default=float("nan")), 2
            ),
        }
    if arguments.json:
        return print(json.dumps(results))
    for name, value in results.items():
        print(f"{name}: {value}")
    return None


if __name__ == "__main__":
    main()
