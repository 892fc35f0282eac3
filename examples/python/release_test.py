#!/usr/bin/env python3
"""A block fitted to two releases: python examples/python/release_test.py [FOLDER]

The tests are synthetic. A marble pedestal, 0.30 m wide and 0.90 m high, was "let go" twice at a tilt; a camera with 50 pictures a second
measured the rotation in degrees, with errors of 0.05 degrees, a zero that was off and a clock that had been started earlier. The script
writes both tables (those of examples/fit), fits the block, and draws the fit.
"""

import csv
import sys
from pathlib import Path

import numpy as np
import rocking_block as rb

# The block behind the tests: on the rigid base, with 0.97 of Housner's restitution, and a base whose edges are slightly worn.
TRUTH = rb.Block(width=0.288, height=0.90, foundation="rigid", restitution_factor=0.97)
# Tilt [rad], zero [deg] and delay [s] of each release.
RELEASES = ((0.24, 0.12, 0.36), (0.15, -0.08, 0.52))
ERROR = 0.05  # [deg]


def measured(tilt, zero, delay, random):
    """Returns times [s] and rotations [deg] of a release as the camera sees them."""
    run = TRUTH.run(theta=tilt, duration=4.0, step=0.001)
    t = np.arange(0.0, 4.0, 0.02)
    rotation = np.interp(t - delay, run.t, run.theta, left=tilt)
    return t, np.degrees(rotation) + zero + ERROR * random.standard_normal(len(t))


def write(path, t, degrees):
    with open(path, "w", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["t [s]", "rotation [deg]"])
        table.writerows((f"{time:.2f}", f"{value:.3f}") for time, value in zip(t, degrees))


def main(folder):
    random = np.random.default_rng(7)
    tests = []
    for number, (tilt, zero, delay) in enumerate(RELEASES, 1):
        t, degrees = measured(tilt, zero, delay, random)
        write(folder / f"release_{number}.csv", t, degrees)
        tests.append(rb.Test(
            np.round(t, 2), np.radians(np.round(degrees, 3)), theta=tilt, delay=0.4, noise=np.radians(ERROR),
            free=["initial.theta", "zero", "delay"],
        ))
    # The drawings show the full width and Housner's restitution.
    drawn = rb.Block(width=0.30, height=0.90, foundation="rigid")
    fit = rb.fit(drawn, tests, free=["width", "height", "restitution_factor"])
    for estimate in fit.estimates:
        print(f"{estimate.name:22} {estimate.value:.5g} ± {estimate.standard_error:.2g} {estimate.unit}")
    print(f"chi-squared {fit.reduced_chi_squared:.2f} per degree of freedom; e = {fit.block.e:.4f}")
    for note in fit.notes:
        print(note)
    return fit


if __name__ == "__main__":
    place = Path(sys.argv[1] if len(sys.argv) > 1 else ".")
    main(place).plot()[0].figure.savefig(place / "release_test.png", dpi=100)
