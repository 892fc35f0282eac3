#!/usr/bin/env python3
"""Validation against shaking-table tests: does a free-standing rock overturn?

    python lab/validation/shaking_table.py --fit FOLDER --test FOLDER [--json]
    python lab/validation/shaking_table.py --fit FOLDER --cross-validate motions tests

A folder holds `tests.csv`, `motions.npz` and `rocks.json`. Fits use the first folder only and are judged on the second; tests
without a motion are left out. Needs the Python package `rocking_block` and NumPy.

The rule for the geometry was stated before any outcome was examined; the others were stated later:

- Geometry: the rectangular block with the rock's height of the centre of mass, moment of inertia, and lowest energy barrier
  against overturning: alpha = sqrt(2 U/h). The naive rule, the critical tilt in the direction of shaking, is shown for
  comparison.
- Model: Housner's block on a rigid base, with his restitution, in the plane of shaking, without sliding.
- Unit of prediction: an ensemble. The table's motion is scaled by the midpoints of equally likely parts of a lognormal
  distribution of 10 %; the probability of overturning is (overturned + 1/2)/(samples + 1).
- Fit: the maximum-likelihood slenderness on the grid below; for an ensemble over the slenderness, its median and spread.
"""

import argparse
import csv
import json
import math
import sys
from pathlib import Path
from statistics import NormalDist

import numpy as np
import rocking_block as rb

GRAVITY = 9.81
SPREAD = 0.10
ALPHAS = np.geomspace(0.08, 0.26, 12)
# Spread of an ensemble over the slenderness.
SPREADS = (0.05, 0.1, 0.2, 0.3, 0.4)
ROCKS = {"SP1": "sp1", "SP2": "sp2"}


class Folder:
    """Tests with their motions, and the rocks."""

    def __init__(self, path):
        path = Path(path)
        self.rocks = json.loads((path / "rocks.json").read_text())
        motions = np.load(path / "motions.npz")
        with open(path / "tests.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        self.rows = [row for row in rows if f"f_{int(row['test']):03d}" in motions]
        if not self.rows:
            sys.exit(f"{path}: no test of tests.csv has a motion in motions.npz")
        self.left_out = len(rows) - len(self.rows)
        self.records = [rb.Record(motions[f"f_{int(row['test']):03d}"].astype(float), 0.005) for row in self.rows]

    def column(self, name):
        return np.array([float(row[name]) for row in self.rows])

    def overturned(self, rock):
        return self.column(ROCKS[rock]) == 1.0

    def motions(self):
        return np.array([row["motion"] for row in self.rows])


def probabilities(folder, rock, alpha, samples, **options):
    """Returns the probability of overturning for each test, from an ensemble over the scale of the motion."""
    height, inertia = folder.rocks[rock]["h"], folder.rocks[rock]["i_y"]
    radius = height / math.cos(alpha)
    scales = [math.exp(SPREAD * NormalDist().inv_cdf((i + 0.5) / samples)) for i in range(samples)]
    table = rb.spectrum(
        p=math.sqrt(GRAVITY * radius / (inertia + radius**2)),
        alpha=alpha,
        gamma=radius**2 / inertia,
        g=GRAVITY,
        records=folder.records,
        scale=scales,
        tolerance=1e-6,
        progress=False,
        **({"foundation": "rigid"} | options),
    )
    overturned = (table["outcome"] == "overturned").reshape(len(folder.records), samples)
    return (overturned.sum(axis=1) + 0.5) / (samples + 1)


def rule(folder, rock):
    """Returns the slenderness of the block with the same energy barrier."""
    return math.sqrt(2 * folder.rocks[rock]["weakest_way"]["rise"] / folder.rocks[rock]["h"])


def naive(folder, rock):
    """Returns the critical tilt in the direction of shaking."""
    return folder.rocks[rock]["arm +x"]["theta_c"]


def weighted(grid, alpha, spread):
    """Returns the probabilities of an ensemble over the slenderness, by lognormal weights on its grid."""
    weights = np.exp(-0.5 * (np.log(ALPHAS / alpha) / spread) ** 2)
    return weights @ grid / weights.sum()


def over_slenderness(grid):
    """Yields median, spread and probabilities of ensembles over the slenderness, on a grid of both."""
    for spread in SPREADS:
        for alpha in ALPHAS:
            yield float(alpha), spread, weighted(grid, alpha, spread)


def most_likely(grid, happened):
    """Returns the maximum-likelihood median and spread of an ensemble over the slenderness, beginning at the best of the grid.

    The likelihood is smooth in both, and needs no further runs. It is maximized along each in turn, by golden sections between
    the neighbours on the grid of the slenderness and between half and twice the spread.
    """
    best = max(over_slenderness(grid), key=lambda found: log_likelihood(happened, found[2]))[:2]
    step, least, greatest = ALPHAS[1] / ALPHAS[0], SPREADS[0], SPREADS[-1]
    golden = 0.5 * (math.sqrt(5) - 1)
    value = lambda point: log_likelihood(happened, weighted(grid, *point))
    for _ in range(4):
        for which, factor in ((0, step), (1, 2.0)):
            ends = [best[which] / factor, best[which] * factor]
            if which:
                ends = [max(ends[0], least), min(ends[1], greatest)]
            at = lambda x: (x, best[1]) if which == 0 else (best[0], x)
            low, high = ends
            for _ in range(25):
                inner = high - golden * (high - low), low + golden * (high - low)
                if value(at(inner[0])) > value(at(inner[1])):
                    high = inner[1]
                else:
                    low = inner[0]
            best = max(best, at(0.5 * (low + high)), key=value)
    return best


def log_likelihood(happened, probability):
    return float(np.log(np.where(happened, probability, 1 - probability)).sum())


def logistic(predictors, happened):
    """Returns maximum-likelihood coefficients, the constant first. A weak ridge keeps separable data finite."""
    x = np.column_stack([np.ones(len(happened)), *predictors])
    beta = np.zeros(x.shape[1])
    for _ in range(100):
        mean = 1 / (1 + np.exp(-x @ beta))
        hessian = (x * (mean * (1 - mean))[:, None]).T @ x + 1e-6 * np.eye(len(beta))
        step = np.linalg.solve(hessian, x.T @ (happened - mean) - 1e-6 * beta)
        beta += step
        if np.abs(step).max() < 1e-10:
            break
    return beta


def applied(beta, predictors):
    return 1 / (1 + np.exp(-(beta[0] + sum(b * x for b, x in zip(beta[1:], predictors)))))


def threshold(values, happened):
    """Returns the value that divides best: at or above it, the prediction is overturned."""
    candidates = np.unique(values)
    right = [np.mean((values >= candidate) == happened) for candidate in candidates]
    return float(candidates[int(np.argmax(right))])


def auc(happened, score):
    """Returns the probability that an overturned test has the higher score; ties count half."""
    high, low = score[happened][:, None], score[~happened][None, :]
    return float(np.mean((high > low) + 0.5 * (high == low))) if high.size and low.size else math.nan


def reliability(happened, probability):
    """Returns mean prediction, frequency and number of tests in five bins."""
    bins = np.minimum((probability * 5).astype(int), 4)
    rows = [(probability[bins == i], happened[bins == i]) for i in range(5)]
    return [(float(p.mean()), float(h.mean()), len(p)) for p, h in rows if len(p)]


def judged(happened, probability, rank=None):
    """Judges predictions. A prediction of yes or no has no Brier score, and an AUC only by the measure `rank` behind it."""
    said = probability > 0.5
    both = np.sum(said & happened)
    is_graded = bool(np.any((probability > 0) & (probability < 1)))
    score = probability if is_graded else rank
    return {
        "accuracy": float(np.mean(said == happened)),
        "precision": float(both / said.sum()) if said.any() else math.nan,
        "recall": float(both / happened.sum()) if happened.any() else math.nan,
        "AUC": math.nan if score is None else auc(happened, score),
        "Brier": float(np.mean((probability - happened) ** 2)) if is_graded else math.nan,
    }


def mcnemar(happened, first, second):
    """Returns the counts of tests that only the first or only the second predicts, and the exact two-sided p-value."""
    a, b = (first > 0.5) == happened, (second > 0.5) == happened
    only_a, only_b = int(np.sum(a & ~b)), int(np.sum(b & ~a))
    n, k = only_a + only_b, min(only_a, only_b)
    tail = sum(math.comb(n, i) for i in range(k + 1)) / 2**n if n else 1.0
    return only_a, only_b, min(1.0, 2 * tail)


def gain(happened, first, second, motions, samples=4000, seed=1):
    """Returns the accuracy of the first prediction less that of the second, with its 95 % interval over samples of the motions.

    Tests under the same motion at other scales are not independent.
    """
    right = ((first > 0.5) == happened).astype(float) - ((second > 0.5) == happened)
    names, codes = np.unique(motions, return_inverse=True)
    sums, counts = np.bincount(codes, right), np.bincount(codes)
    drawn = np.random.default_rng(seed).integers(len(names), size=(samples, len(names)))
    gains = sums[drawn].sum(axis=1) / counts[drawn].sum(axis=1)
    return float(right.mean()), *(float(end) for end in np.quantile(gains, [0.025, 0.975]))


def logit(probability):
    return np.log(probability / (1 - probability))


def assess(rock, fit, test, made):
    """Returns all predictions for one rock. `made` gives probabilities by folder and slenderness."""
    happened = test.overturned(rock)
    fitted_to = fit.overturned(rock)
    grid = np.array([made(fit, alpha) for alpha in ALPHAS])
    best = float(ALPHAS[int(np.argmax([log_likelihood(fitted_to, row) for row in grid]))])
    ensembles = [log_likelihood(fitted_to, row) for _, _, row in over_slenderness(grid)]
    judged_on = np.array([made(test, alpha) for alpha in ALPHAS])
    median, spread, wide = list(over_slenderness(judged_on))[int(np.argmax(ensembles))]
    intensity = lambda folder: [np.log(folder.column("pga")), np.log(folder.column("pgv"))]
    predictions = {
        f"this model, alpha = {rule(test, rock):.3f} (equal barrier)": made(test, rule(test, rock)),
        f"this model, alpha = {best:.3f} (fitted)": made(test, best),
        f"this model, alpha = {median:.3f} ± {spread:.0%} (fitted)": wide,
        f"this model, alpha = {naive(test, rock):.3f} (naive)": made(test, naive(test, rock)),
        "always stays": np.zeros(len(happened)),
    }
    ranks = {}
    for name in ("pga", "pgv"):
        limit = threshold(fit.column(name), fitted_to)
        predictions[f"{name.upper()} threshold"] = np.where(test.column(name) >= limit, 1.0, 0.0)
        ranks[f"{name.upper()} threshold"] = test.column(name)
    beta = logistic(intensity(fit)[1:], fitted_to)
    predictions["logistic, ln PGV"] = applied(beta, intensity(test)[1:])
    beta = logistic(intensity(fit), fitted_to)
    predictions["logistic, ln PGA, ln PGV"] = applied(beta, intensity(test))
    beta = logistic([*intensity(fit), logit(made(fit, best))], fitted_to)
    with_ours = [*intensity(test), logit(made(test, best))]
    predictions["logistic with this model"] = applied(beta, with_ours)
    for name in test.rows[0]:
        if name.startswith(f"dem_{ROCKS[rock]}_"):
            predictions[f"discrete elements {name.split('_', 2)[2]}"] = test.column(name)
    ours = list(predictions)[1]
    others = [name for name in predictions if "this model" not in name]
    best_other = max(others, key=lambda name: judged(happened, predictions[name])["accuracy"])
    only_ours, only_other, chance = mcnemar(happened, predictions[ours], predictions[best_other])
    return {
        "tests": len(happened),
        "overturned": int(happened.sum()),
        "alpha": {"rule": rule(test, rock), "fitted": best, "naive": naive(test, rock)},
        "predictions": {name: judged(happened, p, ranks.get(name)) for name, p in predictions.items()},
        "reliability": reliability(happened, predictions[ours]),
        "McNemar": {"against": best_other, "only ours right": only_ours, "only other right": only_other, "p": chance},
        "gains": {
            f"{one} over {other}": gain(happened, predictions[one], predictions[other], test.motions())
            for one, other in ((list(predictions)[0], "PGV threshold"), (ours, "PGV threshold"), (ours, best_other))
        },
        "scores": {name: [happened.tolist(), p.tolist()] for name, p in list(predictions.items())[:2]},
    }


def kept(samples):
    """Returns cached probabilities by rock, folder and slenderness."""
    memory = {}

    def make(rock):
        def of(folder, alpha):
            key = (rock, id(folder), round(alpha, 9))
            if key not in memory:
                memory[key] = probabilities(folder, rock, alpha, samples)
            return memory[key]

        return of

    return make


def cross_validated(folder, make, by, seed=1):
    """Returns accuracy, AUC and Brier score of the model with fitted slenderness on unfitted halves.

    The halves are of tests, or of motions with all their scales. `make` gives probabilities as in `assess`, for each rock.
    """
    generator, results = np.random.default_rng(seed), {}
    groups = folder.motions() if by == "motions" else np.arange(len(folder.rows)).astype(str)
    names = np.unique(groups)
    for rock in ROCKS:
        happened, of = folder.overturned(rock), make(rock)
        grid = np.array([of(folder, alpha) for alpha in ALPHAS])
        x = [np.log(folder.column("pga")), np.log(folder.column("pgv"))]
        ensembles = list(over_slenderness(grid))
        found = {
            name: []
            for name in ("this model", "over slenderness too", "the same, fitted between the grid", "logistic", "logistic with this model")
        }
        slenderness, gains = [], []
        for _ in range(50):
            half = np.isin(groups, generator.permutation(names)[: len(names) // 2])
            for fit in (half, ~half):
                likelihoods = [log_likelihood(happened[fit], row[fit]) for row in grid]
                ours = grid[int(np.argmax(likelihoods))]
                slenderness.append(float(ALPHAS[int(np.argmax(likelihoods))]))
                both = [*x, logit(ours)]
                wide = max((row for _, _, row in ensembles), key=lambda row: log_likelihood(happened[fit], row[fit]))
                between = weighted(grid, *most_likely(grid[:, fit], happened[fit]))
                gains.append(log_likelihood(happened[fit], between[fit]) - log_likelihood(happened[fit], wide[fit]))
                for name, probability in (
                    ("this model", ours),
                    ("over slenderness too", wide),
                    ("the same, fitted between the grid", between),
                    ("logistic", applied(logistic([p[fit] for p in x], happened[fit]), x)),
                    ("logistic with this model", applied(logistic([p[fit] for p in both], happened[fit]), both)),
                ):
                    judge = judged(happened[~fit], probability[~fit])
                    score = log_likelihood(happened[~fit], np.clip(probability[~fit], 1e-9, 1 - 1e-9)) / (~fit).sum()
                    found[name].append((judge["accuracy"], judge["AUC"], judge["Brier"], score))
        results[rock] = {
            name: dict(zip(("accuracy", "AUC", "Brier", "log score"), np.mean(rows, axis=0).tolist())) for name, rows in found.items()
        } | {"alpha": [float(np.quantile(slenderness, q)) for q in (0.05, 0.5, 0.95)], "gain": [min(gains), max(gains)]}
    return results


def show(results):
    for rock, found in results.items():
        print(f"\n{rock}: {found['tests']} tests, {found['overturned']} overturned")
        print(f"  {'':44}accuracy  precision  recall    AUC  Brier")
        for name, judge in found["predictions"].items():
            numbers = (judge["accuracy"], judge["precision"], judge["recall"], judge["AUC"], judge["Brier"])
            print(f"  {name:44}" + "{:8.3f}{:11.3f}{:8.3f}{:7.3f}{:7.3f}".format(*numbers))
        print("  reliability of the fitted model: predicted, happened, tests")
        for predicted, frequency, count in found["reliability"]:
            print(f"    {predicted:6.2f} {frequency:6.2f} {count:6d}")
        test = found["McNemar"]
        print(
            f"  McNemar against {test['against']}: {test['only ours right']} tests only the model predicts, "
            f"{test['only other right']} only the other (p = {test['p']:.2f}, if tests of one motion were independent)"
        )
        for name, (mean, low, high) in found["gains"].items():
            print(f"  accuracy of {name}: {mean:+.3f} ({low:+.3f} to {high:+.3f}, 95 % by motions)")


def show_cross_validated(results):
    for rock, found in results.items():
        low, middle, high = found.pop("alpha")
        print(f"\n{rock}: fitted alpha {middle:.3f} ({low:.3f} to {high:.3f})")
        least, greatest = found.pop("gain")
        print(f"  log-likelihood of the fitted halves between the grid less that on it: {least:.3f} to {greatest:.3f}")
        print(f"  {'':36}accuracy    AUC  Brier  log score")
        for name, judge in found.items():
            print(f"  {name:36}{judge['accuracy']:8.3f}{judge['AUC']:7.3f}{judge['Brier']:7.3f}{judge['log score']:11.3f}")
    print()


def wilson(frequency, count, z=1.96):
    """Returns the lower and upper limits of Wilson's 95 % interval of a probability, within 0 and 1."""
    middle = (frequency + z**2 / (2 * count)) / (1 + z**2 / count)
    half = z / (1 + z**2 / count) * np.sqrt(frequency * (1 - frequency) / count + z**2 / (4 * count**2))
    return np.clip([middle - half, middle + half], 0, 1)


def draw(results, path):
    """Draws ROC curves and reliability of the model without and with a fit, for both rocks."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, 2, figsize=(8.4, 4.0), layout="constrained")
    styles = {"SP1": ("#0072b2", "o"), "SP2": ("#d55e00", "s")}
    for rock, found in results.items():
        colour, marker = styles[rock]
        for (name, (happened, score)), line in zip(found["scores"].items(), ("--", "-")):
            happened, score = np.array(happened), np.array(score)
            levels = np.concatenate([[np.inf], np.unique(score)[::-1]])
            hits = [np.mean(score[happened] >= level) for level in levels]
            alarms = [np.mean(score[~happened] >= level) for level in levels]
            kind = "nothing fitted" if line == "--" else "slenderness fitted"
            axes[0].plot(alarms, hits, line, color=colour, label=f"{rock}, {kind}: AUC {auc(happened, score):.2f}")
        predicted, frequency, count = map(np.array, zip(*found["reliability"]))
        bars = np.abs(wilson(frequency, count) - frequency)
        axes[1].errorbar(predicted, frequency, bars, fmt=marker + "-", color=colour, capsize=3, label=f"{rock}, slenderness fitted")
    axes[0].set(xlabel="false positive rate", ylabel="true positive rate", title="ROC of overturning", xlim=(0, 1), ylim=(0, 1.02))
    axes[1].plot([0, 1], [0, 1], color="0.6", linewidth=1)
    axes[1].set(xlabel="predicted probability of overturning", ylabel="observed frequency", title="Reliability, with 95 % intervals")
    axes[1].set(xlim=(0, 1), ylim=(-0.02, 1.02))
    for axis in axes:
        axis.legend(frameon=False, loc="lower right")
    figure.savefig(path, dpi=200)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fit", required=True, metavar="FOLDER", help="tests for the fits")
    parser.add_argument("--test", metavar="FOLDER", help="tests for the judgement")
    parser.add_argument("--cross-validate", choices=["motions", "tests"], nargs="+", help="halves of --fit instead of --test")
    parser.add_argument("--samples", type=int, default=9, help="runs of an ensemble (default: %(default)s)")
    parser.add_argument("--plot", metavar="FILE", help="ROC and reliability as a picture (needs matplotlib)")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    arguments = parser.parse_args()
    if (arguments.test is None) == (arguments.cross_validate is None):
        parser.error("expected either --test or --cross-validate")
    fit = Folder(arguments.fit)
    if arguments.cross_validate:
        make = kept(arguments.samples)
        divided = {by: cross_validated(fit, make, by) for by in arguments.cross_validate}
        if arguments.json:
            return print(json.dumps(divided))
        for by, results in divided.items():
            print(f"means of 50 random divisions of the {by}, each half fitted and judged on the other")
            show_cross_validated(results)
        return None
    same = Path(arguments.fit).resolve() == Path(arguments.test).resolve()
    test = fit if same else Folder(arguments.test)
    make = kept(arguments.samples)
    results = {rock: assess(rock, fit, test, make(rock)) for rock in ROCKS}
    if arguments.plot:
        draw(results, arguments.plot)
    if arguments.json:
        for found in results.values():
            found.pop("scores")
        return print(json.dumps(results | {"fitted and judged on the same tests": same}))
    print(f"fitted to {len(fit.rows)} tests, judged on {len(test.rows)} ({test.left_out} without a motion left out)")
    if same:
        print("fitted and judged on the same tests")
    show(results)
    return None


if __name__ == "__main__":
    main()
