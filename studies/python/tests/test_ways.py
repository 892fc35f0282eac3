"""Incremental dynamic analysis, clouds and stripes, compared with sweeps, SciPy, statsmodels and planted data."""

import json
import pickle
import subprocess
from concurrent.futures import ThreadPoolExecutor

import matplotlib.pyplot as plt
import numpy as np
import pytest
from scipy import stats
from test_assess import RECORDS
from test_fit import PROGRAM

import rocking_block as rb

HUNT = {
    "study": {"design": "grid", "hunt": {"im": "PGV", "first": 0.1, "runs": 10}},
    "parameters": {"foundation": "rigid", "alpha": 0.15, "p": [1.5, 2.2]},
    "records": [{"horizontal": f"{RECORDS}/*.smc"}],
}


def program(*arguments):
    if not PROGRAM.exists():
        pytest.skip(f"{PROGRAM} is missing; cargo build --release builds it")
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=True).stdout


def test_an_analysis_has_the_runs_of_its_study():
    analysis = rb.ida(HUNT)
    assert (analysis.im, analysis.unit, len(analysis.curves)) == ("PGV", "m/s", 4)
    assert analysis.table == rb.sweep(HUNT)
    for number, (curve, (stands, overturns)) in enumerate(zip(analysis.curves, analysis.capacities, strict=True)):
        rows = analysis.table[10 * number : 10 * number + 10]
        order = np.argsort(rows["PGV"])
        assert np.array_equal(curve.levels, rows["PGV"][order])
        expected = np.where(rows["outcome"] == "overturned", np.inf, rows["peak.theta/alpha"])[order]
        assert np.array_equal(curve.peaks, expected)
        assert overturns == rows["PGV"][rows["outcome"] == "overturned"].min() and 0.85 * overturns < stands < overturns
    assert repr(pickle.loads(pickle.dumps(analysis))) == repr(analysis)
    middle = np.sort(analysis.capacities.mean(axis=1))
    assert [analysis.level(fraction) for fraction in (0.16, 0.5, 0.84)] == [middle[0], middle[1], middle[3]]
    # All curves cross the peak before they overturn.
    assert analysis.level(0.84, peak=0.1) < analysis.level(0.84)
    assert analysis.plot().get_xlabel() == "peak |θ|/α"
    plt.close("all")


@pytest.mark.parametrize("call", [rb.sweep, rb.ida, lambda study: rb.sweep(study, executor=ThreadPoolExecutor(2), parts=3)])
def test_strong_scales_are_doubted_on_the_line_of_the_caller(call):
    """Those of a hunt are known after its runs, those of scales before."""
    for strengths in ({"hunt": {"im": "PGV", "first": 2.0, "runs": 4}}, {"levels": {"im": "PGV", "values": [2.0]}}):
        with pytest.warns(UserWarning, match=r"0111a\.smc is scaled by up to \d+\.\d; expected at most 20") as found:
            call(HUNT | {"study": {"design": "grid"} | strengths})
        assert len(found) == 1 and found[0].filename == __file__


def test_given_levels_are_those_of_all_curves():
    study = HUNT | {"study": {"design": "grid", "levels": {"im": "PGV", "values": [0.2, 0.4, 0.8]}}}
    analysis = rb.ida(study)
    assert analysis.levels.tolist() == [0.2, 0.4, 0.8]
    peaks = np.array([curve.peaks for curve in analysis.curves])
    assert np.array_equal(analysis.fractile(0.5), np.sort(peaks, axis=0)[1])
    assert rb.ida(rb.sweep(study), "PGV").fractile(0.84).tolist() == analysis.fractile(0.84).tolist()
    table = analysis.table.to_frame()
    assert np.array_equal(rb.ida(table, "PGV [m/s]").fractile(0.5), analysis.fractile(0.5))


def test_files_have_the_curves_of_the_study(tmp_path):
    """The number of a row names no curve; keys of folders do."""
    study = HUNT | {"study": {"design": "grid", "levels": {"im": "PGV", "values": [0.2, 0.4, 0.8]}}}
    analysis = rb.ida(study)
    frame = analysis.table.to_frame()
    frame.columns = [f"{name} [{analysis.table.units[name]}]" if name in analysis.table.units else name for name in frame.columns]
    for run in (1, 2):
        (tmp_path / "runs" / f"run={run}").mkdir(parents=True)
        frame.to_csv(tmp_path / "runs" / f"run={run}" / "table.csv", index_label=None if "row" in frame else "row", index="row" not in frame)
    one = tmp_path / "runs" / "run=1" / "table.csv"
    for source in (one, rb.read_table(one)):
        found = rb.ida(source, "PGV")
        assert [curve.name for curve in found.curves] == [curve.name for curve in analysis.curves]
        assert found.fractile(0.5).tolist() == analysis.fractile(0.5).tolist()
    assert len(rb.ida(tmp_path / "runs", "PGV").curves) == 2 * len(analysis.curves)


def test_fractiles_need_the_curves_on_which_they_depend():
    """Of three curves two end standing: no half of them is known to overturn."""
    rows = {"record": ["a", "b", "c", "c"], "PGV": [0.5, 0.5, 0.5, 1.0], "outcome": ["completed"] * 3 + ["overturned"],
            "peak.theta/alpha": [0.1, 0.2, 0.3, 9.0]}
    found = rb.ida(rb.Table(rows, {"PGV": "m/s"}), "PGV")
    assert [found.level(fraction) for fraction in (0.16, 0.5, 0.84)] == [None, None, None]
    assert np.isnan(found.fractile(0.5)[-1]) and np.isinf(found.fractile(0.84)[-1]) and "the median at no known level" in repr(found)


@pytest.mark.parametrize(
    "study, options, message",
    [
        (HUNT | {"study": {"design": "grid"}}, {}, "the study has no levels; expected levels or hunt"),
        (rb.Table({"PGV": [0.1], "outcome": ["completed"], "peak.theta/alpha": [0.1]}), {}, "im is missing"),
        (rb.Table({"PGV": [0.1], "outcome": ["completed"], "peak.theta/alpha": [0.1]}), {"im": "PGV"}, "found no column that names the ground motion"),
        (rb.Table({"record": ["a"], "scale": [1.0]}), {"im": "PGV", "threads": 1}, "threads has no effect on a table"),
    ],
)
def test_what_is_no_analysis_is_refused(study, options, message):
    with pytest.raises(ValueError, match=message):
        rb.ida(study, **options)


def planted(rows=400, seed=3):
    """Rotations about a line, with overturning by a logistic curve, records that do not rock, and a magnitude that adds to the measure."""
    random = np.random.default_rng(seed)
    pgv = np.exp(random.normal(-1.0, 0.6, rows))
    magnitude = random.uniform(5.5, 7.5, rows)
    peak = np.exp(0.3 + 1.2 * np.log(pgv) + 0.1 * (magnitude - 6.5) + 0.35 * random.normal(size=rows))
    overturns = random.uniform(size=rows) < 1.0 / (1.0 + np.exp(-(0.5 + 4.0 * np.log(pgv / 0.9))))
    rocks = random.uniform(size=rows) < 1.0 / (1.0 + np.exp(-5.0 * np.log(pgv / 0.15)))
    outcome = np.where(overturns, "overturned", "completed")
    peak = np.where(overturns, 10.0, np.where(rocks, peak, 0.0))
    return rb.Table({"PGV": pgv, "magnitude": magnitude, "outcome": outcome, "peak.theta/alpha": peak}, {"PGV": "m/s"})


def test_a_cloud_is_that_of_independent_programs():
    models = pytest.importorskip("statsmodels.discrete.discrete_model")
    table = planted()
    found = rb.cloud(table, "PGV", beside="magnitude")
    stands = (table["outcome"] == "completed") & (table["peak.theta/alpha"] > 0.0)
    x, y = np.log(table["PGV"][stands]), np.log(table["peak.theta/alpha"][stands])
    line = stats.linregress(x, y)
    assert np.allclose([found.a, found.b], [line.intercept, line.slope], rtol=1e-12)
    assert np.allclose(found.standard_errors, [line.intercept_stderr, line.stderr], rtol=1e-10)
    assert np.isclose(found.r_squared, line.rvalue**2, rtol=1e-12)
    residuals = y - line.intercept - line.slope * x
    assert np.isclose(found.beta, np.sqrt(np.sum(residuals**2) / (len(x) - 2)), rtol=1e-12) and found.efficiency == found.beta
    assert np.isclose(found.proficiency, found.beta / line.slope, rtol=1e-12)
    beside = stats.linregress(table["magnitude"][stands], residuals)
    assert np.isclose(found.sufficiency["magnitude"].slope, beside.slope, rtol=1e-10)
    assert np.isclose(found.sufficiency["magnitude"].p, beside.pvalue, rtol=1e-6, atol=1e-13)
    at = np.array([[0.1, 0.3], [0.6, 1.5]])

    def logistic(rows, does):
        design = np.column_stack([np.ones(rows.sum()), np.log(table["PGV"][rows])])
        fit = models.Logit(does[rows].astype(float), design).fit(disp=0, tol=1e-12, maxiter=200)
        return fit.predict(np.column_stack([np.ones(at.size), np.log(at.ravel())])).reshape(at.shape)

    overturned = table["outcome"] == "overturned"
    collapse, rocks = logistic(np.ones(table.rows, dtype=bool), overturned), logistic(~overturned, stands)
    assert np.allclose(found.curve(at), collapse, rtol=1e-6)
    exceeds = stats.norm.sf((np.log(0.5) - found.a - found.b * np.log(at)) / found.beta)
    assert np.allclose(found.curve(at, limit=0.5), collapse + (1.0 - collapse) * rocks * exceeds, rtol=1e-6)
    # The share of rows that exceed the limit is that of the curve on average.
    exceeded = overturned | (table["peak.theta/alpha"] > 0.5)
    assert abs(found.curve(table["PGV"], limit=0.5).mean() - exceeded.mean()) < 0.02
    assert found.plot().get_ylabel() == "peak |θ|/α"
    plt.close("all")


def test_rows_of_one_motion_count_once():
    """Errors are those of a jackknife over motions, by statsmodels' lines, and Student's t has one degree less than there are motions."""
    random = np.random.default_rng(7)
    motion = np.repeat(np.arange(12), 10)
    pgv = np.exp(random.normal(-1.0, 0.6, 12))[motion] * np.exp(0.1 * random.normal(size=120))
    magnitude = random.uniform(5.5, 7.5, 12)[motion]
    peak = np.exp(-0.2 + 1.1 * np.log(pgv) + 0.4 * random.normal(size=12)[motion] + 0.1 * random.normal(size=120))
    outcome = np.where(random.uniform(size=120) < pgv / 2.0, "overturned", "completed")
    columns = {"PGV": pgv, "magnitude": magnitude, "outcome": outcome, "peak.theta/alpha": peak}
    named = rb.Table({**columns, "record": [f"r{i}" for i in motion]}, {"PGV": "m/s"})
    found = rb.cloud(named, "PGV", beside="magnitude", ci=0.9)
    stands = outcome == "completed"
    x, y, of = np.log(pgv[stands]), np.log(peak[stands]), motion[stands]

    def jackknife(x, y):
        whole = np.polyfit(x, y, 1)
        shifts = [np.polyfit(x[of != left_out], y[of != left_out], 1) - whole for left_out in range(12)]
        return whole[::-1], np.sqrt(11 / 12 * np.sum(np.square(shifts), axis=0))[::-1]

    line, errors = jackknife(x, y)
    assert np.allclose([found.a, found.b], line, rtol=1e-9) and np.allclose(found.standard_errors, errors, rtol=1e-9)
    reach = stats.t.ppf(0.95, 11) * errors
    assert np.allclose([found.a_ci, found.b_ci], np.column_stack([line - reach, line + reach]), rtol=1e-9)
    (_, slope), (_, error) = jackknife(magnitude[stands], y - line[0] - line[1] * x)
    assert np.isclose(found.sufficiency["magnitude"].p, 2.0 * stats.t.sf(abs(slope / error), 11), rtol=1e-8)
    assert found.independence == found.overturning.fit.independence == "clustered by 12 motions"
    again = rb.cloud(rb.Table({**columns, "event": motion}), "PGV", ci=0.9, cluster="event")
    assert again.b_ci == found.b_ci and again.independence == again.overturning.fit.independence == "clustered by 12 values of event"
    alone = rb.cloud(rb.Table(columns), "PGV")
    assert alone.independence == "rows independent" and alone.standard_errors[1] < 0.7 * found.standard_errors[1]
    with pytest.warns(UserWarning, match="1 rows without PGV are left out"):
        assert rb.cloud(rb.Table({**columns, "PGV": np.where(np.arange(120) == 3, np.nan, pgv)}), "PGV").unknown == 1
    with pytest.raises(ValueError, match="found an ensemble; expected"):
        rb.cloud(rb.Table({**columns, "ensemble.samples": [4] * 120}), "PGV")


def test_the_program_and_copies_have_the_same_cloud(tmp_path):
    table = planted()
    table.to_frame().to_csv(tmp_path / "runs.csv", index=False)
    found = rb.cloud(table, "PGV", beside="magnitude", ci=0.9)
    printed = json.loads(program("cloud", tmp_path / "runs.csv", "--im", "PGV", "--beside", "magnitude", "--ci", "0.9", "--json"))
    (of,) = printed["clouds"]
    assert of["coefficients"] == [found.a, found.b] and of["standard_errors"] == list(found.standard_errors)
    assert of["intervals"] == [list(found.a_ci), list(found.b_ci)] and of["beta"] == found.beta
    assert (of["r_squared"], of["proficiency"], of["unknown"]) == (found.r_squared, found.proficiency, found.unknown)
    assert of["sufficiency"]["magnitude"] == found.sufficiency["magnitude"]._asdict()
    for name, share in (("overturning", found.overturning), ("rocking", found.rocking)):
        assert [of[name]["exceeded"], of[name]["rows"]] == [share.exceeded, share.rows]
        assert of[name]["coefficients"] == list(share.fit.coefficients) and share.fit.ci == 0.9
    again = pickle.loads(pickle.dumps(found))
    x = np.array([[0.2, 0.5], [0.9, 1.4]])
    assert (again.curve(x, limit=0.5) == found.curve(x, limit=0.5)).all() and (again.median(x) == found.median(x)).all()
    assert again.overturning.fit.coefficients == found.overturning.fit.coefficients


def test_the_program_has_the_same_stripes(tmp_path):
    rb.Table({"PGV": [0.2, 0.4, 0.8], "exceeded": [1, 4, 7], "runs": [10, 10, 9]}, {"PGV": "m/s"}).to_frame().to_csv(tmp_path / "counts.csv", index=False)
    found = rb.stripes(tmp_path / "counts.csv", "PGV")
    printed = json.loads(program("stripes", tmp_path / "counts.csv", "--im", "PGV", "--json"))
    assert [level["level"] for level in printed["levels"]] == found.levels.tolist()
    assert [level["fraction"] for level in printed["levels"]] == found.fractions.tolist()
    assert printed["measures"][0]["median"] == found.fit.median and printed["measures"][0]["beta"] == found.fit.beta


def test_curves_have_the_level_at_which_ties_break_first():
    rows = {"record": ["a"] * 3 + ["b"] * 3, "PGV": [0.6, 0.2, 0.4] + [0.2, 0.4, 0.6], "outcome": ["completed"] * 6,
            "peak.theta/alpha": [0.3, 0.1, 0.2] * 2, "ties.broken": [2, 0, 1, 0, 0, 0]}
    found = rb.ida(rb.Table(rows, {"PGV": "m/s"}), "PGV")
    assert found.breaks[0] == 0.4 and np.isnan(found.breaks[1])
    assert rb.ida(rb.Table({name: rows[name] for name in rows if name != "ties.broken"}), "PGV").breaks is None


def test_a_cloud_without_overturning_or_with_a_clear_threshold():
    rows = {"PGV": [0.1, 0.2, 0.3, 0.5, 0.8], "peak.theta/alpha": [0.0, 0.1, 0.2, 0.3, 0.6], "outcome": ["completed"] * 5}
    found = rb.cloud(rb.Table(rows), "PGV")
    assert found.curve([0.5, 5.0]).tolist() == [0.0, 0.0] and found.overturning.fit is None
    # Between 0.1 and 0.2 blocks begin to rock.
    threshold = np.sqrt(0.02)
    assert found.rocking.curve([0.99 * threshold, 1.01 * threshold]).tolist() == [0.0, 1.0]
    with pytest.raises(ValueError, match="found 2 rows that rock and stand; expected three or more"):
        rb.cloud(rb.Table(rows)[:3], "PGV")
    with pytest.raises(ValueError, match='limit = 0.0; expected "overturned" or a rotation'):
        found.curve(0.5, limit=0.0)
    with pytest.raises(ValueError, match="T_m does not vary"):
        rb.cloud(rb.Table({**rows, "T_m": [1.0] * 5}), "PGV", beside="T_m")


def test_stripes_are_the_binomial_fit_of_their_counts():
    counts = {0.2: (1, 20), 0.4: (5, 20), 0.6: (11, 20), 0.9: (16, 25)}
    rows = [(level * (1.0 + 1e-15 * i), i < exceeded) for level, (exceeded, runs) in counts.items() for i in range(runs)]
    levels, words = zip(*((level, "overturned" if does else "completed") for level, does in rows), strict=True)
    found = rb.stripes(rb.Table({"PGV": levels, "outcome": words}, {"PGV": "m/s"}), "PGV")
    assert found.runs.tolist() == [20, 20, 20, 25] and found.exceeded.tolist() == [1, 5, 11, 16]
    regression = pytest.importorskip("statsmodels.genmod.generalized_linear_model")
    families = pytest.importorskip("statsmodels.genmod.families")
    stands = found.runs - found.exceeded
    family = families.Binomial(link=families.links.Probit())
    design = np.column_stack([np.ones(4), np.log(found.levels)])
    peer = regression.GLM(np.column_stack([found.exceeded, stands]), design, family=family).fit(tol=1e-14, maxiter=200)
    assert np.allclose(found.fit.coefficients, peer.params, rtol=1e-7)
    assert len(found.plot().lines) > 1
    plt.close("all")
    with pytest.raises(ValueError, match="expected stripes of several runs"):
        rb.stripes(planted(), "PGV")


def test_stripes_of_a_published_example():
    """The example that J. W. Baker published beside Earthquake Spectra 31 (2015) 579-599, 40 motions at each of eight levels."""
    optimize = pytest.importorskip("scipy.optimize")
    stats = pytest.importorskip("scipy.stats")
    levels, collapses = np.array([0.2, 0.3, 0.4, 0.6, 0.7, 0.8, 0.9, 1.0]), np.array([0, 0, 0, 4, 6, 13, 12, 16])
    words = [["overturned"] * n + ["completed"] * (40 - n) for n in collapses]
    found = rb.stripes({"IM": np.repeat(levels, 40), "outcome": sum(words, [])}, "IM")

    def cost(x):
        return -stats.binom.logpmf(collapses, 40, stats.norm.cdf((np.log(levels) - x[0]) / np.exp(x[1]))).sum()

    peer = np.exp(optimize.minimize(cost, [0.0, -1.0], method="Nelder-Mead", options={"xatol": 1e-12, "fatol": 1e-14}).x)
    assert np.allclose([found.fit.median, found.fit.beta], peer, rtol=1e-6)
    assert found.fractions.tolist() == (collapses / 40).tolist()


def test_counts_of_stripes_are_their_rows():
    """A row for each level has the fit of a row for each run; outcomes may be 0 and 1."""
    levels, exceeded, runs = [0.2, 0.4, 0.8], [1, 4, 7], [10, 10, 9]
    counts = rb.Table({"PGV": levels, "exceeded": exceeded, "runs": runs}, {"PGV": "m/s"})
    rows = {"PGV": np.repeat(levels, runs), "outcome": np.concatenate([np.arange(n) < k for k, n in zip(exceeded, runs, strict=True)])}
    found, single = rb.stripes(counts, "PGV"), rb.stripes(rb.Table(rows, {"PGV": "m/s"}), "PGV")
    assert repr(found) == repr(single) and found.exceeded.tolist() == exceeded and found.fit.unit == "m/s"
    with pytest.raises(ValueError, match="11 of 10 runs are exceeded in row 0; expected whole numbers, 0 to all"):
        rb.stripes({"PGV": levels, "exceeded": [11, 4, 7], "runs": runs}, "PGV")
