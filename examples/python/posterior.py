#!/usr/bin/env python3
"""The posterior of a fit, by emcee: python examples/python/posterior.py [STEPS]

A release of the pedestal of examples/fit is fitted by `rb.fit`; emcee (D. Foreman-Mackey and others, 2013) then samples the posterior
of the same parameters with flat priors within the bounds, and both are compared. Sampling takes thousands of runs, the fit a few tens. It
is worth its time where intervals are wide or bent, and for what follows from the parameters.
"""

import sys
from pathlib import Path

import emcee
import numpy as np
import rocking_block as rb

DATA = Path(__file__).resolve().parents[1] / "fit/release_1.csv"
NOISE = np.radians(0.05)
TILT, DELAY = 0.24, 0.4


def main(steps):
    t, degrees = np.loadtxt(DATA, delimiter=",", skiprows=1, unpack=True)
    measured = np.radians(degrees)
    block = rb.Block(width=0.30, height=0.90, foundation="rigid")
    of_test = ["initial.theta", "zero", "delay"]
    test = rb.Test(t, measured, theta=TILT, delay=DELAY, noise=NOISE, free=of_test)
    fit = rb.fit(block, test, free=["width", "restitution_factor"])
    best = np.array([estimate.value for estimate in fit.estimates])
    bounds = np.array([estimate.bounds for estimate in fit.estimates])

    def log_probability(values):
        if np.any(values < bounds[:, 0]) or np.any(values > bounds[:, 1]):
            return -np.inf
        width, factor, tilt, zero, delay = values
        try:
            run = block.replace(width=width, restitution_factor=factor).run(theta=tilt, duration=t[-1], step=0.005)
        except ValueError:  # a restitution above 1
            return -np.inf
        # Cubic between rows, by θ and its rate; before the release the block is held.
        at = np.clip(t - delay, 0.0, run.t[-1])
        i = np.minimum(np.searchsorted(run.t, at, side="right") - 1, len(run.t) - 2)
        h = run.t[i + 1] - run.t[i]
        s = (at - run.t[i]) / h
        theta = ((1 + 2 * s) * (1 - s) ** 2 * run.theta[i] + s * (1 - s) ** 2 * h * run.theta_dot[i]
                 + s**2 * (3 - 2 * s) * run.theta[i + 1] - s**2 * (1 - s) * h * run.theta_dot[i + 1])
        return -0.5 * np.sum(((measured - zero - theta) / NOISE) ** 2)

    random = np.random.default_rng(1)
    walkers = 4 * len(best)
    start = random.multivariate_normal(best, fit.covariance, walkers)
    sampler = emcee.EnsembleSampler(walkers, len(best), log_probability)
    sampler.run_mcmc(emcee.State(start, random_state=np.random.RandomState(1).get_state()), steps)
    samples = sampler.get_chain(discard=steps // 4, flat=True)
    print(f"{'parameter':22} {'fit':>22} {'posterior':>22}")
    for estimate, column in zip(fit.estimates, samples.T):
        print(f"{estimate.name:22} {estimate.value:11.6f} ± {estimate.standard_error:.6f} {column.mean():11.6f} ± {column.std():.6f}")
    print(f"runs: {sum(fit.runs)} of the fit, {walkers * (steps + 1)} of the sampler")
    return fit, samples


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 1000)
