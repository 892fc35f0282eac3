"""Fragility curves compared with statsmodels and with known curves."""

import json
import pickle
import subprocess
import warnings

import matplotlib.pyplot as plt
import numpy as np
import pytest
from scipy.stats import chi2, norm
from test_fit import PROGRAM

import rocking_block as rb


def planted(rows=300, median=0.6, beta=0.4, seed=5):
    """Returns a table of runs that overturn with the probability of a lognormal curve; ten runs per record."""
    random = np.random.default_rng(seed)
    pgv = np.exp(random.normal(np.log(median), 0.6, rows))
    overturned = np.log(pgv / median) / beta + random.normal(size=rows) > 0
    words = np.where(overturned, "overturned", "completed")
    rotation = np.where(overturned, 5.0, np.minimum(0.9, pgv))
    separation = np.where(pgv > 1.0, 2.0, np.nan)
    columns = {"record": np.arange(rows) // 10, "PGV": pgv, "outcome": words, "peak.theta/alpha": rotation,
               "first_separation": separation}
    return rb.Table(columns, {"PGV": "m/s"})


@pytest.mark.parametrize("link", ["probit", "logit"])
def test_the_curve_is_that_of_statsmodels(link):
    discrete = pytest.importorskip("statsmodels.discrete.discrete_model")
    table = planted()
    fit = rb.fragility(table, im="PGV", link=link)
    exceeded = (table["outcome"] == "overturned").astype(float)
    design = np.column_stack([np.ones(table.rows), np.log(table["PGV"])])
    model = {"probit": discrete.Probit, "logit": discrete.Logit}[link](exceeded, design)
    peer = model.fit(disp=0, tol=1e-12, maxiter=200)
    assert np.allclose(fit.coefficients, peer.params, rtol=1e-7)
    assert np.isclose(fit.log_likelihood, peer.llf, rtol=1e-12)
    x = np.geomspace(0.1, 3.0, 20)
    assert np.allclose(fit.curve(x), peer.predict(np.column_stack([np.ones(20), np.log(x)])), rtol=1e-6)
    assert np.isclose(fit.median, np.exp(-peer.params[0] / peer.params[1]), rtol=1e-7)


def test_a_second_measure_is_that_of_the_program(tmp_path):
    """The surface and the tests of sufficiency of a table, of its file, of chosen rows and of a copy."""
    if not PROGRAM.exists():
        pytest.skip(f"{PROGRAM} is missing; cargo build --release builds it")
    random = np.random.default_rng(8)
    columns = planted()
    period, magnitude = random.uniform(0.3, 1.2, columns.rows), random.uniform(5.0, 7.0, columns.rows)
    period[7] = np.nan
    base = np.where(np.arange(columns.rows) % 2, "rigid", "soft")
    table = rb.Table({**columns, "T_m": period, "M": magnitude, "base": base}, {"PGV": "m/s", "T_m": "s"})
    table.to_frame().to_csv(tmp_path / "runs.csv", index=False)
    for where in ({}, {"base": "rigid"}):
        conditions = [word for name, value in where.items() for word in ("--where", f"{name}={value}")]
        arguments = ["fragility", "runs.csv", "--im", "PGV", "--surface", "T_m", "--beside", "M", "--beside", "T_m", "--json", *conditions]
        run = subprocess.run([PROGRAM, *arguments], cwd=tmp_path, capture_output=True, text=True, check=True)
        printed = json.loads(run.stdout)
        fits = [rb.fragility(source, "PGV", surface="T_m [s]", beside=["M", "T_m"], where=where) for source in (table, tmp_path / "runs.csv")]
        for fit in [*fits, pickle.loads(pickle.dumps(fits[0]))]:
            surface, expected = fit.surface, printed["surface"]
            assert surface.im == ("PGV", "T_m") and surface.rows == expected["rows"] == fit.rows - 1
            assert list(surface.coefficients) == [expected["intercept"], *expected["slopes"]]
            assert list(surface.standard_errors) == expected["standard_errors"]
            assert (surface.log_likelihood, surface.auc, surface.brier) == (expected["log_likelihood"], expected["AUC"], expected["Brier"])
            assert fit.sufficiency == printed["measures"][0]["sufficiency"]
    a, b, c = fits[0].surface.coefficients
    x, y = np.array([0.3, 0.6]), np.array([[0.4], [0.9]])
    assert np.allclose(fits[0].surface.curve(x, y), norm.cdf(a + b * np.log(x) + c * np.log(y)), rtol=1e-12)
    assert "Surface of 149 rows" in repr(fits[0].surface)
    plain = rb.fragility(table, "PGV")
    assert plain.surface is None and plain.sufficiency == {}
    with pytest.raises(ValueError, match="table: has no column D5-95"):
        rb.fragility(table, "PGV", beside="D5-95")
    with pytest.raises(ValueError, match="found a measure that is not above 0"):
        fits[0].surface.curve(0.0, 1.0)


@pytest.mark.parametrize("intervals", ["profile", "bootstrap"])
def test_intervals_and_bands_lie_about_the_curve(intervals):
    fit = rb.fragility(planted(), im="PGV", intervals=intervals, samples=200)
    assert fit.median_ci[0] < fit.median < fit.median_ci[1] and fit.beta_ci[0] < fit.beta < fit.beta_ci[1]
    assert fit.median_ci[0] < 0.6 < fit.median_ci[1] and fit.beta_ci[0] < 0.4 < fit.beta_ci[1]
    x = np.array([[0.3, 0.6], [0.9, 1.2]])
    low, high = fit.band(x)
    assert low.shape == (2, 2) and (low < fit.curve(x)).all() and (fit.curve(x) < high).all()
    wider = rb.fragility(planted(), im="PGV", intervals=intervals, samples=200, ci=0.99).band(x)
    assert (wider[0] < low).all() and (wider[1] > high).all()
    again = pickle.loads(pickle.dumps(fit))
    assert again.median_ci == fit.median_ci and np.array_equal(again.band(x), fit.band(x)) and repr(again) == repr(fit)


@pytest.mark.filterwarnings("ignore:.*of the rate")
def test_a_bootstrap_of_few_records_has_no_intervals():
    table = planted()
    few = rb.Table({**{name: table[name] for name in table}, "record": np.arange(table.rows) % 9}, {"PGV": "m/s"})
    with pytest.warns(UserWarning, match="no intervals: a bootstrap of 9 motions understates the scatter; expected at least 10"):
        fit = rb.fragility(few, "PGV", intervals="bootstrap", samples=20)
    assert fit.median_ci == (0.0, np.inf) and fit.beta_ci == (0.0, np.inf) and fit.band(0.5) == (0.0, 1.0)
    assert fit.coefficients == rb.fragility(few, "PGV").coefficients
    hazard = rb.Hazard([0.01, 10.0], [1.0, 1e-6], im="PGV", unit="m/s")
    assert rb.annual_rate(hazard, fit).rate_ci == (0.0, np.inf)


def test_a_falling_curve_is_warned_of():
    table = planted()
    falling = rb.Table({"1/PGV": 1 / table["PGV"], "outcome": table["outcome"]}, {"1/PGV": "s/m"})
    with pytest.warns(UserWarning, match=r"1/PGV \[s/m\]: the probability of exceeding the limit falls as the measure grows \(beta -0"):
        assert rb.fragility(falling, "1/PGV").beta < 0


def test_a_frame_does_as_well():
    table = planted()
    assert repr(rb.fragility(table.to_frame(), "PGV")) == repr(rb.fragility(table, "PGV"))
    without = rb.fragility(dict(table), "PGV")
    assert without.unit == "" and without.plot(ax=plt.figure().add_subplot()).get_xlabel() == "PGV"


def test_a_table_of_the_program_goes_through_pandas_and_parquet(tmp_path):
    """Tests headings with units, and rows without records, for which pandas has nan."""
    pandas = pytest.importorskip("pandas")
    table = planted()
    fit = rb.fragility(table, "PGV")
    headings = {name: f"{name} [{table.units[name]}]" if name in table.units else name for name in table}
    file = tmp_path / "table.csv"
    file.write_text("# a study\n" + table.to_frame().rename(columns=headings).to_csv(index=False))
    frame = pandas.read_csv(file, comment="#")
    assert "PGV [m/s]" in frame
    for im in ("PGV", "PGV [m/s]"):
        assert repr(rb.fragility(frame, im)) == repr(fit) and rb.fragility(frame, im).unit == "m/s"
    assert repr(rb.fragility(file, "PGV [m/s]")) == repr(fit)
    table.to_parquet(tmp_path / "own.parquet")
    frame.to_parquet(tmp_path / "of_pandas.parquet")
    for name in ("own", "of_pandas"):
        assert repr(rb.fragility(tmp_path / f"{name}.parquet", "PGV")) == repr(fit)
    for missing in (np.nan, None, pandas.NA):
        independent = rb.fragility(frame.assign(record=missing, vertical=missing), "PGV")
        assert independent.independence == rb.fragility({name: table[name] for name in table if name != "record"}, "PGV").independence
    with pytest.raises(ValueError, match=r"found two columns 'PGV', one of them 'PGV \[m/s\]'; expected one"):
        rb.fragility({"PGV": table["PGV"], "PGV [m/s]": table["PGV"], "outcome": table["outcome"]}, "PGV")
    (tmp_path / "image.png").write_bytes(b"\x89PNG\r\n\x1a\n\xff")
    with pytest.raises(ValueError, match="image.png: found no text; expected a table of `rocking sweep`, as CSV or Parquet"):
        rb.fragility(tmp_path / "image.png", "PGV")


def test_a_spectral_measure_is_found_without_its_unit_and_counts_are_whole():
    counts = (1000, 2000, 3000, 4000)
    outcome = np.concatenate([["overturned"] * count + ["completed"] * (5000 - count) for count in counts])
    # Sorted: the round-off of long sums was taken for a missing maximum.
    rows = {"Sa(0.5 s)": np.repeat([1.0, 2.0, 3.0, 4.0], 5000), "outcome": outcome}
    found = [rb.fragility(rb.Table(rows, {"Sa(0.5 s)": "m/s2"}), im) for im in ("Sa(0.5 s)", "sa(0.5)")]
    assert found[1].im == "Sa(0.5 s)" and found[0].median == found[1].median and found[1].unit == "m/s2"
    assert "10000 of 20000 runs" in repr(found[0]) and "10000 of 20000 runs" in found[0]._repr_html_()
    with pytest.raises(ValueError, match="table: has no column Sa\\(0.6\\); expected one of Sa"):
        rb.fragility(rows, "Sa(0.6)")


def test_the_goodness_of_fit_is_the_deviance_of_the_levels():
    levels, counts = np.array([0.2, 0.3, 0.45, 0.6, 0.8]), np.array([2, 9, 11, 25, 28])
    outcome = np.concatenate([["overturned"] * count + ["completed"] * (30 - count) for count in counts])
    fit = rb.fragility({"PGV": np.repeat(levels, 30), "outcome": outcome}, "PGV")
    p = fit.curve(levels)
    deviance = 2 * np.sum(counts * np.log(counts / (30 * p)) + (30 - counts) * np.log((30 - counts) / (30 * (1 - p))))
    found = fit.goodness_of_fit
    assert found.degrees_of_freedom == 3 and found.deviance == pytest.approx(deviance, rel=1e-9)
    assert found.p == pytest.approx(chi2.sf(deviance, 3), rel=1e-9) and f"p = {found.p:.3g}" in fit._repr_html_()
    assert rb.fragility({"PGV": np.repeat([0.2, 0.3], 5), "outcome": ["completed", "overturned"] * 5}, "PGV").goodness_of_fit is None


def test_joined_tables_are_refused_with_that_reason(tmp_path):
    (tmp_path / "t.csv").write_text("# a study\nrow,PGV [m/s],outcome\n0,1,completed\n1,2,overturned\n" * 2)
    with pytest.raises(ValueError, match="t.csv: repeats its headings after 2 rows, as in tables joined by cat; expected one table"):
        rb.fragility(tmp_path / "t.csv", "PGV")


def test_a_measure_and_outcomes_are_enough():
    """Tests overturning; the peaks of a table affect only the efficiency."""
    table = planted()
    own = {"PGV": table["PGV"].tolist(), "outcome": [word.capitalize() for word in table["outcome"]]}
    fit, whole = rb.fragility(own, "PGV", "Overturned"), rb.fragility(table, "PGV")
    assert fit.coefficients == whole.coefficients and np.isnan(fit.efficiency)
    assert rb.fragility(rb.Table(own), "PGV").coefficients == fit.coefficients


def test_limits_are_outcomes_and_rotations():
    table = planted()
    counts = [rb.fragility(table, "PGV", limit).fractions.sum() for limit in ("overturned", 0.5)]
    assert counts[0] == np.count_nonzero(table["outcome"] == "overturned")
    assert counts[1] == np.count_nonzero((table["peak.theta/alpha"] > 0.5) | (table["outcome"] == "overturned"))


def test_rows_that_do_not_tell_are_left_out_and_counted():
    table = planted()
    columns = {name: table[name].copy() for name in table}
    columns["outcome"] = columns["outcome"].astype("<U10")
    columns["outcome"][[3, 7]], columns["outcome"][11] = "failed", "separated"
    kept = np.isin(np.arange(table.rows), [3, 7, 11], invert=True)
    fit = rb.fragility(rb.Table(columns), "PGV")
    assert (fit.failed, fit.separated, len(fit.measures)) == (2, 1, table.rows - 3)
    assert fit.coefficients == rb.fragility(rb.Table({name: table[name][kept] for name in table}), "PGV").coefficients


def test_a_missing_response_is_left_out_and_counted():
    """Tables of blocks with and without friction, joined: the curve is that of the rows with a slip."""
    rng = np.random.default_rng(1)
    pgv = np.tile([0.2, 0.4, 0.6, 0.8, 1.0, 1.2], 4)
    rows = {"PGV [m/s]": pgv, "outcome": ["completed"] * 24, "peak.slip [m]": 0.12 * pgv * np.exp(rng.normal(size=24) * 0.4)}
    alone = rb.fragility(rows, "PGV", "slip:0.08")
    joined = {name: np.concatenate([column, column if name != "peak.slip [m]" else np.full(24, np.nan)]) for name, column in rows.items()}
    with pytest.warns(UserWarning, match="24 rows without the response of the limit are left out of the curve"):
        fit = rb.fragility(joined, "PGV", "slip:0.08")
    assert (fit.median, fit.rows, fit.without_response) == (alone.median, 24, 24)
    assert fit.fraction_range[1] - fit.fraction_range[0] == 0.5


def test_records_that_agree_have_intervals_of_some_width():
    """Equal counts of each record at each level: the clustered variance is zero."""
    for records in (2, 5, 12):
        rows = [(f"r{r}", level, "overturned" if i < level - 1 else "completed") for r in range(records) for level in (1, 2, 3, 4) for i in range(3)]
        record, pgv, outcome = zip(*rows)
        with pytest.warns(UserWarning, match="the motions agree too well for intervals clustered by"):
            fit = rb.fragility(rb.Table({"record": record, "PGV": pgv, "outcome": outcome}, {"PGV": "m/s"}), "PGV")
        low, high = fit.median_ci
        assert 1.05 * low < fit.median < high / 1.05


def test_rows_are_clustered_by_motion_or_by_a_column():
    """The same record with and without its vertical component, floors and components are no motions of their own."""
    rng = np.random.default_rng(3)
    quake = np.arange(240) % 12
    pgv = np.exp(rng.normal(size=240))
    rows = {
        "PGV [m/s]": pgv,
        "outcome": np.where(np.log(pgv) + 0.5 * rng.normal(size=12)[quake] > 0.3 * rng.normal(size=240), "overturned", "completed"),
        "record": np.array([f"quake {number}" for number in quake]),
        "place": np.arange(240) % 5,
    }
    fit = rb.fragility(rows, "PGV")
    assert fit.independence == "clustered by 12 motions"
    vertical = np.where(np.arange(240) % 24 < 12, "", [f"vertical {number}" for number in quake])
    made = np.array(["", ", floor 2", " rotated by 30 degrees towards other", "; baseline removed"])[np.arange(240) // 60]
    for more in ({"vertical": vertical}, {"record": np.char.add(rows["record"], made)}, {"record": np.arange(240), "motion": quake}):
        again = rb.fragility(rows | more, "PGV")
        assert (again.independence, again.median_ci) == (fit.independence, fit.median_ci)
    by_place = rb.fragility(rows, "PGV", cluster="place")
    assert by_place.independence == "clustered by 5 values of place" and by_place.median_ci != fit.median_ci
    again = pickle.loads(pickle.dumps(by_place))
    assert (again.independence, again.median_ci) == (by_place.independence, by_place.median_ci)
    with pytest.raises(ValueError, match="table: has no column other; expected one of PGV"):
        rb.fragility(rows, "PGV", cluster="other")


def test_a_curve_is_that_of_the_program(rocking, path, tmp_path):
    """Tests single runs and ensembles, with both kinds of intervals."""
    study = {
        "study": {"design": "grid", "scales": [0.5, 1.0, 2.0, 4.0], "ensemble": {"scale": 0.2, "samples": 8, "limits": [0.5]}},
        "parameters": {"dimensionless": {"alpha": [0.12, 0.2], "p": {"from": 1.5, "to": 4.0, "count": 4}}},
        "records": [path, path.with_name("0111a.smc")],
    }
    from rocking_block import _toml

    (tmp_path / "study.toml").write_text(_toml.text(study))
    rocking("sweep", tmp_path / "study.toml", csv=tmp_path / "table.csv")
    table = rb.sweep(study)
    for limit, said in (("overturned", "overturned"), (0.5, "theta/alpha>0.5")):
        for intervals, more in (("profile", []), ("bootstrap", ["--bootstrap", "50"])):
            with warnings.catch_warnings():
                warnings.filterwarnings("ignore", "no intervals: a bootstrap of 2 records")
                fit = rb.fragility(table, "PGV", limit, intervals=intervals, samples=50)
                assert repr(rb.fragility(tmp_path / "table.csv", "PGV", limit, intervals=intervals, samples=50)) == repr(fit)
            found = rocking.json("fragility", tmp_path / "table.csv", "--im", "PGV", "--limit", said, *more)
            (curve,) = found["measures"]
            found = [curve[name] for name in ("median", "beta", "intercept", "slope", "AUC", "Brier", "efficiency")]
            assert [fit.median, fit.beta, *fit.coefficients, fit.auc, fit.brier, fit.efficiency] == found
            assert list(fit.standard_errors) == curve["standard_errors"]
            # Two records may leave an interval unbounded, which is null in the program's JSON.
            found = [[0.0 if low is None else low, np.inf if high is None else high]
                     for low, high in (curve["median_interval"], curve["beta_interval"])]
            assert [list(fit.median_ci), list(fit.beta_ci)] == found


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"im": "PGA"}, "table: has no column PGA; expected one of record, PGV"),
        ({"im": "outcome"}, "table: row 0 has outcome = .*; expected a number"),
        ({"limit": -1}, "found limit `-1`; expected overturned, balance, breaks .* a number > 0 for .theta./alpha"),
        ({"limit": float("nan")}, "found limit `nan`; expected overturned"),
        ({"limit": 0.5, "table": {"PGV": [1.0], "outcome": ["completed"]}}, "table: has no column peak.theta/alpha"),
        ({"table": {"PGV": [1.0, 2.0], "outcome": ["overturned", "fell"]}}, "table: row 1 has outcome = fell; expected one of completed, overturned"),
        ({"limit": "fallen"}, "found limit `fallen`; expected overturned"),
        ({"table": {"PGV": [], "outcome": []}}, "found no rows; expected rows that exceed the limit and rows that do not"),
        ({"intervals": "bootstrap", "samples": 1}, "samples = 1; expected a whole number from 2 to 1000000"),
        ({"ci": 95}, "ci = 95; expected a number above 0 and below 1"),
        ({"link": "cauchit"}, 'link = "cauchit"; expected one of "probit", "logit"'),
        ({"intervals": "wald"}, 'intervals = "wald"; expected one of "profile", "bootstrap"'),
        ({"limit": 100.0, "table": rb.Table({"PGV": [1.0], "outcome": ["completed"], "peak.theta/alpha": [1.0]})},
         "found one class: the limit is not exceeded in all 1 rows"),
        ({"table": rb.Table({"PGV": [1.0, 0.0], "outcome": ["completed", "overturned"], "peak.theta/alpha": [0.1, 9.0]})},
         "found the measure 0 in row 1; expected a number above 0"),
    ],
)
def test_what_has_no_curve_is_refused(options, message):
    options = {"table": planted(), "im": "PGV"} | options
    with pytest.raises(ValueError, match=message):
        rb.fragility(**options)


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"table": None}, TypeError, "table = None; expected a Table, a DataFrame, a mapping of columns, or the path of a file"),
        ({"im": ["PGV", "PGA"]}, TypeError, "im = \\['PGV', 'PGA'\\]; expected the name of one column, such as 'PGV'"),
        ({"table": "missing.csv"}, FileNotFoundError, "missing.csv"),
        ({"table": "short.csv"}, ValueError, "short.csv: row 1 has 1 fields; expected 2, as in the heading"),
        ({"table": "empty.csv"}, ValueError, "empty.csv: found no lines; expected a table of"),
    ],
)
def test_arguments_of_another_kind_are_named(options, error, message, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "short.csv").write_text("# a study\nPGV [m/s],outcome\n1,completed\n2\n")
    (tmp_path / "empty.csv").write_text("# a study\n")
    with pytest.raises(error, match=message):
        rb.fragility(**{"table": planted(), "im": "PGV"} | options)


def test_exports_are_those_of_the_program(rocking, tmp_path):
    """Tests both programs with two damage states; the descriptions differ in the name of the table."""
    table = planted()
    heading = [f"{name} [{table.units[name]}]" if name in table.units else name for name in table]
    rows = zip(*(table[name] for name in table))
    text = [",".join(heading), *(",".join("" if word == "nan" else word for word in map(str, row)) for row in rows)]
    (tmp_path / "table.csv").write_text("\n".join(text) + "\n")
    fits = [rb.fragility(table, "PGV", limit) for limit in ("overturned", 0.5)]
    for program, name in (("pelicun", "library"), ("openquake", "model.xml")):
        own, others = tmp_path / name, tmp_path / f"other {name}"
        with pytest.warns(UserWarning, match=r"statue: the curves of theta/alpha>0.5 and overturned cross at PGV"):
            rb.export_fragility({"statue": fits}, program, own)
        rocking.json("fragility", tmp_path / "table.csv", "--im", "PGV", "--export-limit", "0.5", "--export", program,
                     "--export-to", others, "--id", "statue")
        for file in (own / "fragility.csv", own / "fragility.json") if program == "pelicun" else (own,):
            other = others / file.name if program == "pelicun" else others
            assert other.read_text().replace("PGV [m/s] in 300 rows of table.csv", "PGV in 300 rows") == file.read_text()


def test_an_export_keeps_the_unit_of_the_heading(tmp_path):
    """A median in g and the same one in m/s² reach pelicun as one; without a unit it is refused."""
    pga, outcome, medians = np.array([0.2, 0.3, 0.4, 0.5, 0.6, 0.8]), ["completed", "overturned"] * 3, []
    for heading, x in (("PGA [g]", pga), ("PGA [m/s2]", 9.81 * pga)):
        fit = rb.fragility({heading: x, "outcome": outcome}, "PGA")
        fit.export("pelicun", tmp_path)
        medians.append(float((tmp_path / "fragility.csv").read_text().splitlines()[1].split(",")[7]))
        assert medians[-1] == pytest.approx(fit.median if heading == "PGA [g]" else fit.median / 9.81, rel=1e-12)
    assert medians[1] == pytest.approx(medians[0], rel=1e-9)
    with pytest.raises(ValueError, match="found PGA without a unit; expected its unit with its name"):
        rb.fragility({"PGA": pga, "outcome": outcome}, "PGA").export("pelicun", tmp_path)


def test_an_export_has_the_curve_of_the_block(tmp_path):
    relative = planted()
    columns = {**{name: relative[name] for name in relative}, "p PGV/(g tan alpha)": relative["PGV"] * 1.5 / (9.81 * np.tan(0.2))}
    fit = rb.fragility(rb.Table(columns), "p PGV/(g tan alpha)")
    fit.export("pelicun", tmp_path / "a" / "b", id="block.1", alpha=0.2, p=1.5)
    row = (tmp_path / "a" / "b" / "fragility.csv").read_text().splitlines()[1].split(",")
    assert row[:4] == ["block.1", "0", "Peak Ground Velocity", "mps"]
    assert np.isclose(float(row[7]), rb.fragility(relative, "PGV").median, rtol=1e-9)
    for error, message, call in (
        (ValueError, "found the identifier `a-b`; expected letters", lambda: fit.export("pelicun", tmp_path, id="a-b", alpha=0.2, p=1.5)),
        (ValueError, "alpha is missing; expected that of the block", lambda: fit.export("pelicun", tmp_path)),
        (ValueError, 'program = "hazus"; expected one of "pelicun", "openquake"', lambda: fit.export("hazus", tmp_path, alpha=1, p=1)),
        (ValueError, r"found curves over PGV \[m/s\] and p PGV.* for a; expected one measure in one unit",
         lambda: rb.export_fragility({"a": [fit, rb.fragility(relative, "PGV")]}, "pelicun", tmp_path)),
        (TypeError, "curves\\['a'\\] = 0.5; expected a Fragility or several", lambda: rb.export_fragility({"a": 0.5}, "pelicun", tmp_path)),
    ):
        with pytest.raises(error, match=message):
            call()
    assert not (tmp_path / "fragility.csv").exists()


def test_a_curve_of_runs_becomes_a_picture(record, tmp_path):
    blocks = rb.blocks(alpha=0.12, p=np.linspace(1.5, 4.0, 12), eta=50)
    table = rb.outcomes(blocks, [record], scale=np.geomspace(0.5, 4.0, 8), periods=[1.0])
    fit = rb.fragility(table, im="p PGV/(g tan alpha)")
    assert fit.auc > 0.7 and 0 < fit.brier < 0.25
    axes = fit.plot()
    assert axes.get_xlabel() == "p PGV/(g tan alpha) [1]"
    rb.fragility(table, im="p PGV/(g tan alpha)", limit=0.5).plot(label="half", runs=False, lw=3)
    assert plt.gcf() is axes.figure and [line.get_label() for line in axes.lines][-1] == "half"
    assert axes.lines[0].get_color() != axes.lines[-1].get_color() and axes.get_ylabel() == "probability"
    plt.savefig(tmp_path / "curve.png")
    assert "median" in fit._repr_html_()


def test_measures_in_tables_are_those_of_the_records(record):
    table = rb.outcomes(rb.Block(alpha=0.15, p=2.0), [record], scale=[1.0, -2.0], periods=[0.5])
    measures = rb.intensity(record, 0.5)
    assert set(measures) < set(table)
    power = {"PGV/PGA": 0, "D5-95": 0, "T_m": 0, "Arias": 2}
    for name, value in measures.items():
        assert np.allclose(table[name], value * np.array([1.0, 2.0]) ** power.get(name, 1), rtol=1e-14), name
    assert np.isclose(table["PGA/(g tan alpha)"][0], record.pga / (9.81 * np.tan(0.15)), rtol=1e-14)
    assert table.units["Arias"] == "m/s" and table.units["p T_m"] == "1"
