"""Annual rates compared with closed forms and with scipy's quadrature."""

import copy
import pickle
import warnings
from math import exp

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import expit, ndtr

import rocking_block as rb

LEVELS = np.array([0.05, 0.1, 0.2, 0.5, 1.0, 2.0])
RATES = np.array([3e-2, 8e-3, 2e-3, 1.5e-4, 2e-5, 1e-6])


@pytest.fixture
def hazard():
    return rb.Hazard(LEVELS, RATES, im="PGV", unit="m/s")


def integral(probability):
    """∫ P |dH| of a hazard that is linear in logarithms, by scipy, with both ends continued."""
    x, y = np.log(LEVELS), np.log(RATES)
    ends = np.concatenate([[x[0] - 30], x, [x[-1] + 30]])
    slopes = np.diff(y) / np.diff(x)
    slopes = np.concatenate([slopes[:1], slopes, slopes[-1:]])
    starts = np.concatenate([[0], range(len(x))])
    total = 0.0
    for k, slope in enumerate(slopes):
        i = starts[k]

        def density(t, i=i, slope=slope):
            return probability(exp(t)) * -slope * exp(y[i] + slope * (t - x[i]))

        points = np.linspace(ends[k], ends[k + 1], 40)
        total += sum(quad(density, a, b, epsabs=1e-17, epsrel=1e-12)[0] for a, b in zip(points[:-1], points[1:]))
    return total


@pytest.mark.parametrize(("median", "beta"), [(0.5, 0.4), (0.15, 0.1), (3.0, 0.6)])
def test_the_rate_of_a_lognormal_curve_is_that_of_scipy(hazard, median, beta):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = rb.annual_rate(hazard, (median, beta), "PGV [m/s]")
    exact = integral(lambda m: ndtr(np.log(m / median) / beta))
    assert found.rate == pytest.approx(exact, rel=1e-10)
    table = found.deaggregation
    assert table["rate"].sum() == pytest.approx(found.rate, rel=1e-12) and table.units["from"] == "m/s"
    assert found.between(0.0, found.quantile(0.3)) == pytest.approx(0.3 * found.rate, rel=1e-9)


@pytest.mark.filterwarnings("ignore:.*of the rate")
def test_the_rate_of_a_fitted_curve_has_an_interval_about_it(hazard):
    random = np.random.default_rng(3)
    pgv = np.exp(random.normal(np.log(0.5), 0.7, 80))
    outcome = np.where(np.log(pgv / 0.5) / 0.4 + random.normal(size=80) > 0, "overturned", "completed")
    table = rb.Table({"PGV": pgv, "outcome": outcome}, {"PGV": "m/s"})
    for link, cdf in (("logit", expit), ("probit", ndtr)):
        fit = rb.fragility(table, "PGV", link=link)
        found = rb.annual_rate(hazard, fit)
        assert found.rate == pytest.approx(integral(lambda m: cdf(np.log(m / fit.median) / fit.beta)), rel=1e-9)
        low, high = found.rate_ci
        assert low < found.rate < high
    # The ends are the rates of the ends of the band, here at other points.
    x = np.geomspace(0.01, 10.0, 250)
    ends = [rb.annual_rate(hazard, (x, band), "PGV [m/s]").rate for band in fit.band(x)]
    assert found.rate_ci == pytest.approx(ends, rel=0.01)
    boot = rb.annual_rate(hazard, rb.fragility(table, "PGV", intervals="bootstrap", samples=50))
    assert boot.rate_ci[0] < boot.rate < boot.rate_ci[1]
    again = pickle.loads(pickle.dumps(found))
    assert (again.rate, again.rate_ci, repr(again)) == (found.rate, found.rate_ci, repr(found))
    assert set(found.extrapolated) == {"below_hazard", "above_hazard", "below_rows", "above_rows"}


def test_a_rate_is_that_of_the_program(rocking, hazard, tmp_path):
    lines = [f"{level},{rate}" for level, rate in zip(100 * LEVELS, RATES)]
    (tmp_path / "hazard.csv").write_text("\n".join(["PGV [cm/s],rate [1/year]", *lines]))
    report = rocking.json("rate", tmp_path / "hazard.csv", "--median", "0.5", "--beta", "0.4", "--im", "PGV [m/s]")
    read = rb.read_hazard(tmp_path / "hazard.csv")
    assert (read.im, read.unit) == ("PGV", "m/s") and np.allclose(read.levels, LEVELS, rtol=1e-15)
    found = rb.annual_rate(read, (0.5, 0.4), "PGV [m/s]")
    assert (report["rate"], report["return_period"]) == (found.rate, found.return_period)
    assert [part["rate"] for part in report["deaggregation"]] == found.deaggregation["rate"].tolist()
    assert report["probabilities"][1] == {"years": 50.0, "probability": found.probability(50.0), "interval": [None, None]}


@pytest.mark.filterwarnings("ignore:.*of the rate")
def test_measures_relative_to_a_block_need_the_block(hazard):
    table = rb.Table({"p PGV/(g tan alpha)": [0.3, 0.5, 0.6, 0.9, 1.0, 1.4], "outcome": ["completed", "overturned"] * 3})
    fit = rb.fragility(table, "p PGV/(g tan alpha)")
    found = rb.annual_rate(hazard, fit, alpha=0.2, p=1.5)
    factor = 1.5 / (9.81 * np.tan(0.2))
    assert found.rate == pytest.approx(rb.annual_rate(hazard, (fit.median / factor, fit.beta), "PGV [m/s]").rate, rel=1e-12)
    with pytest.raises(ValueError, match="alpha is missing; expected that of the block"):
        rb.annual_rate(hazard, fit)


def test_a_pair_has_its_measure_and_unit(hazard):
    """A median relative to a block, in cm/s and in m/s has one rate; without a unit it is refused."""
    factor = 9.81 * np.tan(0.2) / 1.5
    exact = integral(lambda m: ndtr(np.log(m / (1.2 * factor)) / 0.4))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        relative = rb.annual_rate(hazard, (1.2, 0.4), "p PGV/(g tan alpha)", alpha=0.2, p=1.5)
        table = rb.annual_rate(hazard, ([0.5, 1.0, 2.0], [0.0, 0.5, 1.0]), "p PGV/(g tan alpha)", alpha=0.2, p=1.5)
        own = rb.annual_rate(hazard, (np.array([0.5, 1.0, 2.0]) * factor, [0.0, 0.5, 1.0]), "PGV [m/s]")
        in_cm = rb.annual_rate(hazard, (120 * factor, 0.4), "PGV [cm/s]")
    assert relative.rate == pytest.approx(exact, rel=1e-10) and in_cm.rate == pytest.approx(exact, rel=1e-10)
    assert table.rate == pytest.approx(own.rate, rel=1e-12)
    assert (in_cm.hazard.unit, relative.hazard.im, relative.hazard.unit) == ("cm/s", "p PGV/(g tan alpha)", "1")
    for arguments, options, message in [
        ((), {}, "im is missing; expected the measure and the unit of the median"),
        (("PGV",), {}, r"found PGV without a unit; expected its unit with its name, such as PGV \[m/s\]"),
        (("PGV [g]",), {}, "found PGV in g; expected m/s, or a unit of it"),
        (("PGV [m/s]",), {"alpha": 0.2}, "alpha has no effect on PGV"),
        (("PGA [g]",), {}, "found a hazard curve of PGV; expected one of PGA"),
    ]:
        with pytest.raises(ValueError, match=message):
            rb.annual_rate(hazard, (1.2, 0.4), *arguments, **options)
    with pytest.raises(ValueError, match="found levels without a unit; expected m/s, or a unit of it"):
        rb.annual_rate(rb.Hazard(LEVELS, RATES, im="PGV"), (0.5, 0.4), "PGV [m/s]")


@pytest.mark.filterwarnings("ignore:.*of the rate")
def test_a_fitted_curve_keeps_the_unit_of_its_heading(hazard):
    pgv = np.array([0.2, 0.3, 0.4, 0.5, 0.6, 0.8])
    outcome = ["completed", "overturned"] * 3
    rates = [rb.annual_rate(hazard, rb.fragility({heading: x, "outcome": outcome}, "PGV")).rate
             for heading, x in (("PGV [m/s]", pgv), ("PGV [cm/s]", 100 * pgv))]
    assert rates[1] == pytest.approx(rates[0], rel=1e-9)
    with pytest.raises(ValueError, match="found PGV without a unit"):
        rb.annual_rate(hazard, rb.fragility({"PGV": pgv, "outcome": outcome}, "PGV"))


def test_a_step_gives_the_hazard_and_extrapolation_a_warning(hazard):
    assert rb.annual_rate(hazard, (0.5, 0.0), "PGV [m/s]").rate == pytest.approx(1.5e-4, rel=1e-14)
    assert rb.annual_rate(hazard, ([0.1, 0.2], [0.0, 0.0]), "PGV [m/s]").rate == 0.0
    with pytest.warns(UserWarning, match="% of the rate comes from PGV above 2, the greatest level of the hazard curve"):
        rb.annual_rate(hazard, (1.9, 0.3), "PGV [m/s]")


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: rb.Hazard([0.2, 0.1], [0.2, 0.1]), "found 0.1 as level 2; expected levels that increase"),
        (lambda: rb.Hazard([0.1, 0.2], [0.1, 0.2]), "found the rate 0.2 at the level 0.2; expected rates"),
        (lambda: rb.annual_rate(rb.Hazard([0.1, 0.2], [0.2, 0.1], unit="1"), (0.0, 0.4), "x [1]"), "found the median 0; expected"),
        (lambda: rb.annual_rate(rb.Hazard([0.1, 0.2], [0.2, 0.1], unit="1"), (1.0, -0.4), "x [1]"), "found the dispersion -0.4; expected"),
        (lambda: rb.annual_rate(rb.Hazard([0.1, 0.2], [0.2, 0.1], unit="1"), ([1, 2], [0, 2]), "x [1]"), "found the probability 2 at the level 2"),
    ],
)
def test_curves_that_are_none_are_refused(make, message):
    with pytest.raises(ValueError, match=message):
        make()


def test_a_rate_becomes_a_picture(hazard, tmp_path):
    axes = rb.annual_rate(hazard, (0.5, 0.4), "PGV [m/s]").plot()
    assert axes.get_xlabel() == "PGV [m/s]"
    axes.figure.savefig(tmp_path / "rate.png")
    assert "return period" in rb.annual_rate(hazard, (0.5, 0.4), "PGV [m/s]")._repr_html_()


def test_a_site_is_a_name_or_a_pair_of_coordinates(tmp_path):
    file = tmp_path / "sites.csv"
    file.write_text("name,lon,lat,5,20,80\nRome,12.5,41.9,1e-2,1e-3,1e-4\nMilan,9.2,45,1e-3,1e-4,1e-5\n")
    for sites in (["Rome", "12.5,41.9", (12.5, 41.9), [12.5, 41.9]], ["Milan", np.array([9.2, 45]), (9.2, 45)]):
        curves = [rb.read_hazard(file, im="Sa(0.5)", site=site, investigation_time=50).rates.tolist() for site in sites]
        assert all(curve == curves[0] for curve in curves)
    assert rb.read_hazard(file, im="Sa(0.5)", site=(9.2, 45)).im == rb.Hazard(LEVELS, RATES, im="Sa(0.5)").im == "Sa(0.5 s)"
    with pytest.raises(ValueError, match="found no site 12.5,41.0; expected one such as Rome; Milan"):
        rb.read_hazard(file, im="PGV", site=(12.5, 41))


@pytest.mark.filterwarnings("ignore:.*of the rate", "ignore:.*undecided rows may exceed")
def test_rows_without_an_outcome_give_a_range(hazard):
    """The rates are those of the tables in which no such row exceeds the limit, and in which all do."""
    random = np.random.default_rng(8)
    pgv = np.exp(random.normal(np.log(0.5), 0.7, 60))
    outcome = np.where(np.log(pgv / 0.5) / 0.4 + random.normal(size=60) > 0, "overturned", "completed")
    open_rows = random.uniform(size=60) < 0.2

    def rate(word):
        table = rb.Table({"PGV": pgv, "outcome": np.where(open_rows, word, outcome)}, {"PGV": "m/s"})
        return rb.annual_rate(hazard, rb.fragility(table, im="PGV"))

    found = rate("undecided")
    assert found.rate_of_unknown == (rate("completed").rate, rate("overturned").rate)
    assert "with the rows of unknown outcome)" in repr(found)
    assert pickle.loads(pickle.dumps(found)).rate_of_unknown == found.rate_of_unknown
    known = rate("completed")
    assert known.rate_of_unknown is None


def test_a_copy_of_a_curve_keeps_its_numbers(tmp_path):
    """Copies do not read the files of a curve again, and a pickle refuses files that have changed."""
    random = np.random.default_rng(4)
    pgv = np.exp(random.normal(np.log(0.5), 0.7, 60))
    outcome = np.where(np.log(pgv / 0.5) / 0.4 + random.normal(size=60) > 0, "overturned", "completed")
    file = tmp_path / "t.csv"

    def write(rows):
        lines = [f"{i},{x!r},{word}\n" for i, (x, word) in enumerate(zip(pgv[:rows].tolist(), outcome, strict=False))]
        file.write_text("row,PGV [m/s],outcome\n" + "".join(lines))

    write(60)
    fit = rb.fragility(file, im="PGV")
    stored = pickle.dumps(fit)
    assert pickle.loads(stored).median == fit.median
    write(50)
    assert copy.deepcopy(fit).median == copy.copy(fit).median == fit.median
    with pytest.raises(ValueError, match="t.csv: changed since the curve was fitted; expected 60 rows"):
        pickle.loads(stored)
    with pytest.raises(ValueError, match="found 50 rows in the files of the curve; expected the 60 of its fit"):
        fit.measures


def test_rows_without_the_measure_are_counted(hazard):
    rows = {"PGV": [0.2, 0.5, 0.4, 0.9, np.nan], "outcome": ["completed"] * 2 + ["overturned"] * 3}
    with pytest.warns(UserWarning, match="1 rows without the measure are left out of the curve"):
        assert rb.fragility(rb.Table(rows), im="PGV").rows == 4


def test_a_quantile_of_a_hazard_is_asked_for(tmp_path):
    text = "# kind='quantile-0.84', investigation_time=50.0, imt='PGA'\nlon,lat,depth,poe-0.1,poe-0.2,poe-0.4,poe-0.8\n1,2,0,0.1,0.05,0.01,0.001\n"
    (tmp_path / "h.csv").write_text(text)
    with pytest.raises(ValueError, match="found the curves of the kind quantile-0.84; expected the mean"):
        rb.read_hazard(tmp_path / "h.csv")
    assert rb.read_hazard(tmp_path / "h.csv", kind="quantile-0.84").im == "PGA"
    assert rb.Hazard([0.0, 0.1, 0.2], [1.0, 1e-3, 1e-4]).levels.tolist() == [0.1, 0.2]
