"""Fragility curves against the generalized linear models of statsmodels, to 1e-8."""

import csv
import json
import subprocess

import numpy as np
import pytest
import statsmodels.api as sm
from scipy.stats import chi2, rankdata

FAMILIES = {
    "probit": sm.families.Binomial(sm.families.links.Probit()),
    "logit": sm.families.Binomial(sm.families.links.Logit()),
}


@pytest.fixture(scope="module", params=["runs", "ensembles"])
def table(request, tmp_path_factory):
    """Returns a table as a sweep writes it: two measures and the outcomes, and the numbers alone."""
    random = np.random.default_rng(7)
    rows = 300
    pgv, period = random.uniform(0.1, 2, rows), random.uniform(0.3, 1.5, rows)
    chance = 1 / (1 + np.exp(-3 * np.log(pgv / 0.8) - np.log(period)))
    if request.param == "runs":
        fraction = (random.random(rows) < chance).astype(float)
    else:
        fraction = random.binomial(9, chance) / 9
    peak = 0.3 * pgv**1.4 * np.exp(random.normal(0, 0.3, rows))
    path = tmp_path_factory.mktemp(request.param) / "t.csv"
    heading = ["row", "record", "PGV [m/s]", "T_m [s]", "outcome", "peak.theta/alpha [1]"]
    with open(path, "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(heading + (["ensemble.samples [1]", "P(overturned) [1]"] if request.param == "ensembles" else []))
        for i in range(rows):
            # Records of their own: statsmodels takes rows to be independent.
            row = [i, i, pgv[i], period[i], "overturned" if fraction[i] > 0.5 else "completed", peak[i]]
            writer.writerow(row + ([9, fraction[i]] if request.param == "ensembles" else []))
    return path, pgv, period, fraction, peak


@pytest.mark.parametrize("link", FAMILIES)
def test_curves_are_those_of_statsmodels(program, table, link):
    path, pgv, period, fraction, peak = table
    arguments = ["fragility", path, "--im", "PGV", "--beside", "T_m", "--surface", "T_m", "--link", link, "--json"]
    report = json.loads(subprocess.run([program, *arguments], check=True, capture_output=True, text=True).stdout)
    (found,) = report["measures"]

    def fit(*measures):
        design = sm.add_constant(np.log(np.column_stack(measures)))
        return sm.GLM(fraction, design, family=FAMILIES[link]).fit(maxiter=200, tol=1e-14, tol_criterion="params")

    def near(value, expected):
        assert value == pytest.approx(expected, rel=1e-8, abs=0)

    curve = fit(pgv)
    near([found["intercept"], found["slope"]], curve.params)
    near(found["standard_errors"], curve.bse)
    near(found["median"], np.exp(-curve.params[0] / curve.params[1]))
    near(found["beta"], 1 / curve.params[1])
    log_likelihood = np.sum(fraction * np.log(curve.mu) + (1 - fraction) * np.log1p(-curve.mu))
    near(found["log_likelihood"], log_likelihood)
    if set(fraction) == {0, 1}:
        near(found["log_likelihood"], curve.llf)
        near(found["null_log_likelihood"], curve.llnull)
        # The statistic of Mann and Whitney.
        ranks, yes = rankdata(pgv), fraction.sum()
        near(found["AUC"], (ranks[fraction == 1].sum() - yes * (yes + 1) / 2) / (yes * (len(fraction) - yes)))
    near(found["Brier"], np.mean((curve.mu - fraction) ** 2))
    both = fit(pgv, period)
    surface = np.sum(fraction * np.log(both.mu) + (1 - fraction) * np.log1p(-both.mu))
    near([report["surface"]["intercept"], *report["surface"]["slopes"]], both.params)
    near(report["surface"]["standard_errors"], both.bse)
    near(report["surface"]["log_likelihood"], surface)
    near(report["surface"]["Brier"], np.mean((both.mu - fraction) ** 2))
    near(found["sufficiency"]["T_m"], chi2.sf(2 * (surface - log_likelihood), 1))
    stands = fraction <= 0.5
    _, residual, *_ = np.polyfit(np.log(pgv[stands]), np.log(peak[stands]), 1, full=True)
    near(found["efficiency"], np.sqrt(residual[0] / (stands.sum() - 2)))
