#!/usr/bin/env python3
"""Cost of a run under a record: right-hand sides per sample, by tolerance and by the supports' frequency over the samples'.

    python lab/benches/cost.py [RECORD...]

Without records, those of this project. Needs the Python package `rocking_block`. Counts do not depend on the machine; the time
of a right-hand side, all that belongs to a run included, is printed for this one.
"""

import itertools
import sys
import time
from pathlib import Path

import numpy as np
import rocking_block as rb

RECORDS = sorted((Path(__file__).resolve().parents[2] / "examples/records").glob("*.smc"))
ALPHA, G = 0.2, 9.81
TOLERANCES = (1e-4, 1e-6, 1e-8, 1e-10)
# Right-hand sides of a short step, including those at its ends.
LEAST = 7
BOUNDS = (0, 0.2, 0.4, 0.8, 1.6, 3.2, np.inf)


def main():
    records = [rb.read_record(path) for path in sys.argv[1:] or RECORDS]
    rows = {tolerance: [] for tolerance in TOLERANCES}
    spent = evaluations = 0
    for record, p, eta, tolerance in itertools.product(records, (0.75, 1.5, 3.0), (20, 40, 80, 160), TOLERANCES):
        # Twice the strength at which the block begins to rock.
        scale = 2 * G * np.tan(ALPHA) / np.abs(record.acceleration).max()
        begun = time.process_time()
        run = rb.Block(alpha=ALPHA, p=p, eta=eta, xi_v=0.1).run(record, scale=scale, tolerance=tolerance)
        spent += time.process_time() - begun
        evaluations += run.counts.evaluations
        rows[tolerance].append((p * eta * record.dt, run.counts.evaluations * record.dt / run.end_time))
    print("right-hand sides per sample, mean (runs), where the supports' angular frequency eta p times the time step is")
    spans = list(itertools.pairwise(BOUNDS))
    print("tolerance" + "".join(f"{f'{low:g} to {high:g}':>15}" for low, high in spans) + "    rule")
    for tolerance, found in rows.items():
        w, cost = np.array(found).T
        cells = [cost[(w >= low) & (w < high)] for low, high in spans]
        # Above the cost of a short step, a power law.
        steep = cost > LEAST + 1
        power, factor = np.polyfit(np.log(w[steep]), np.log(cost[steep]), 1)
        print(
            f"{tolerance:9g}"
            + "".join(f"{f'{cell.mean():.1f} ({len(cell)})' if len(cell) else '-':>15}" for cell in cells)
            + f"    max({LEAST}, {np.exp(factor):.1f} (eta p dt)^{power:.2f}), within "
            + f"{np.quantile(np.abs(cost / np.maximum(LEAST, np.exp(factor) * w**power) - 1), 0.9):.0%} in 9 of 10"
        )
    print(f"{spent / evaluations * 1e9:.0f} ns of CPU time for each on this machine, histories of all rows included")


if __name__ == "__main__":
    main()
