"""Exported fragility curves, read by pelicun and by OpenQuake."""

import json
import os
import subprocess

import numpy as np
import pytest
from conftest import ROOT
from scipy.stats import norm

pytestmark = pytest.mark.check

LIMITS = ("theta/alpha>0.5", "overturned")


@pytest.fixture(scope="module")
def table(tmp_path_factory):
    """Returns a table as a sweep writes it: blocks that exceed |θ|/α = 0.5 and overturn with two dispersions."""
    random = np.random.default_rng(11)
    rows = 400
    pgv = 0.6 * np.exp(random.normal(0, 0.7, rows))
    overturned = np.log(pgv / 0.9) > random.normal(0, 0.5, rows)
    rotated = overturned | (np.log(pgv / 0.55) > random.normal(0, 0.25, rows))
    measures = {"PGA [m/s2]": 12 * pgv, "PGV [m/s]": pgv, "PFA [m/s2]": 15 * pgv, "PFV [m/s]": 1.3 * pgv}
    measures |= {"Sa(0.5 s) [m/s2]": 20 * pgv, "Sv(0.5 s) [m/s]": 2 * pgv, "p PGV/(g tan alpha) [1]": 1.7 * pgv}
    path = tmp_path_factory.mktemp("loss") / "t.csv"
    with open(path, "w") as file:
        print("row", "record", *measures, "outcome", "peak.theta/alpha [1]", sep=",", file=file)
        for i in range(rows):
            outcome, peak = ("overturned", 9.0) if overturned[i] else ("completed", 0.7 if rotated[i] else 0.3)
            print(i, i, *(float(column[i]) for column in measures.values()), outcome, peak, sep=",", file=file)
    return path


@pytest.fixture(scope="module")
def export(program, table):
    """Exports both limits of a measure; returns the warnings and each curve's median (SI) and dispersion."""

    def run(im, kind, path, *options):
        reports = []
        for limit, other in (LIMITS, LIMITS[::-1]):
            to = ["--export", kind, "--export-to", path, "--export-limit", other, "--id", "statue.1", *options]
            run = [program, "fragility", table, "--im", im, "--limit", limit, "--json", *to]
            reports.append(json.loads(subprocess.run(run, check=True, capture_output=True, text=True).stdout))
        curves = [(each["measures"][0]["median"], each["measures"][0]["beta"]) for each in reports]
        return reports[-1]["warnings"], curves

    return run


def exceedance(curves, levels):
    """Returns the probabilities of both limits at levels in SI units, shape (2, n)."""
    return np.array([norm.cdf(np.log(np.asarray(levels) / median) / beta) for median, beta in curves])


# Measure, pelicun's word and unit, and that unit in SI units; pelicun's g is 9.80665 m/s², and the library's numbers in g stay as they are.
PELICUN = [
    ("PGA", "PGA", "g", 9.81),
    ("PGV", "PGV", "mps", 1.0),
    ("PFA", "PFA", "g", 9.81),
    ("PFV", "PFV", "mps", 1.0),
    ("Sa(0.5 s)", "SA_0.5", "g", 9.81),
    ("Sv(0.5 s)", "SV_0.5", "mps", 1.0),
]


@pytest.mark.parametrize(("im", "demand", "unit", "factor"), PELICUN)
def test_pelicun_has_our_probabilities(export, tmp_path, im, demand, unit, factor):
    python = ROOT / "target/tools/pelicun/bin/python"
    if not python.exists():
        pytest.skip("pelicun is not installed in target/tools/pelicun")
    warnings, curves = export(im, "pelicun", tmp_path)
    # Of the curves of these data, the wider one of overturning is above that of rotation far below both medians.
    (milder, worse), samples = curves, 1000
    z = np.log(worse[0] / milder[0]) / (milder[1] - worse[1])
    assert worse[1] > milder[1] and f"both are {100 * norm.cdf(z):.2f} %; below it" in warnings[0]
    levels = milder[0] * np.exp(milder[1] * np.array([z - 1.0, -1.0, 0.5, 2.0]))
    run = [python, ROOT / "tests/python/pelicun_damage.py", tmp_path, demand, unit, str(samples), *map(repr, (levels / factor).tolist())]
    found = json.loads(subprocess.run(run, check=True, capture_output=True, text=True).stdout)
    expected = exceedance(curves, levels)
    assert found["described"] == ["statue.1"]
    read = [found["exceedance"]["statue.1"][state] for state in ("1", "2")]
    assert np.abs(np.array(read) - expected).max() < 1e-12
    # Realizations are stratified, so that a fraction is within one of them; the worst exceeded state counts.
    for damage, (milder, worse) in zip(found["damage"], expected.T):
        fractions = [damage["statue.1"].get(str(state), 0.0) for state in range(3)]
        states = [1.0 - max(milder, worse), max(0.0, milder - worse), worse]
        assert np.abs(np.subtract(fractions, states)).max() <= 2.0 / samples


@pytest.fixture(scope="module")
def openquake():
    """Returns the modules of OpenQuake that read and evaluate fragility models; compiling it for speed would take a minute."""
    os.environ.setdefault("NUMBA_DISABLE_JIT", "1")
    read_nrml = pytest.importorskip("openquake.risklib.read_nrml", exc_type=ImportError)
    from openquake.risklib import riskmodels, scientific

    read_nrml.update_validators()

    def functions(path):
        class Job:
            inputs = {"job_ini": "job.ini", "contents_fragility": str(path)}
            calculation_mode = "scenario_damage"

        found = riskmodels.get_risk_functions(Job)
        (taxonomy,) = found
        return taxonomy, found.limit_states, taxonomy.build(found.limit_states)

    return functions, scientific


# Measure, its options, OpenQuake's name, and its unit in that of the measure.
OPENQUAKE = [
    ("PGA", (), "PGA", 9.81),
    ("PGV", (), "PGV", 0.01),
    ("Sa(0.5 s)", (), "SA(0.5)", 9.81),
    ("p PGV/(g tan alpha)", ("--alpha", "0.2", "--p", "1.5"), "PGV", 0.01 * 1.5 / (9.81 * np.tan(0.2))),
]


@pytest.mark.parametrize(("im", "options", "imt", "factor"), OPENQUAKE)
def test_openquake_has_our_probabilities(export, openquake, tmp_path, im, options, imt, factor):
    functions, scientific = openquake
    warnings, curves = export(im, "openquake", tmp_path / "fragility.xml", *options)
    taxonomy, states, built = functions(tmp_path / "fragility.xml")
    assert (taxonomy.imt, taxonomy.id, states) == (imt, "statue.1", ["rotation_0_5", "overturned"])
    levels = np.geomspace(0.12, 8.0, 60) * curves[0][0]
    expected = exceedance(curves, levels)
    read = np.array([function(levels / factor) for function in built])
    assert np.abs(read - expected).max() < 1e-12
    # Beyond the crossing that the export warns of, the fractions of the damage states add up to more than one.
    sums = scientific.scenario_damage(built, levels / factor).sum(axis=0)
    beyond = expected[1] > expected[0] + 1e-7
    assert len(warnings) == 1 and beyond.any()
    assert (sums[beyond] > 1.0 + 1e-8).all() and np.abs(sums[~beyond] - 1.0).max() < 3e-7


def test_openquake_finds_our_annual_rate(program, export, openquake, tmp_path):
    functions, scientific = openquake
    _, curves = export("PGV", "openquake", tmp_path / "fragility.xml")
    _, _, built = functions(tmp_path / "fragility.xml")
    slope, levels = 2.2, np.geomspace(0.02, 5000.0, 3000)
    rates = 2e-4 * levels**-slope
    np.savetxt(tmp_path / "hazard.csv", np.column_stack([levels, rates]), delimiter=",", header="PGV [m/s],rate", comments="")
    # OpenQuake gives each level half the difference of the rates on both sides, which is too much by this factor.
    step = slope * np.log(levels[1] / levels[0])
    factor = np.sinh(step) / step
    fractions = scientific.classical_damage(built, 100 * levels, -np.expm1(-rates), 1.0, 1.0)
    for (median, beta), probability in zip(curves, (fractions[1:].sum(), fractions[2])):
        run = [program, "rate", tmp_path / "hazard.csv", "--median", repr(median), "--beta", repr(beta), "--im", "PGV [m/s]", "--json"]
        report = json.loads(subprocess.run(run, check=True, capture_output=True, text=True).stdout)
        assert -np.log1p(-probability) == pytest.approx(factor * report["rate"], rel=1e-6)


# Run by pelicun's Python: our curves before those of FEMA P-58, in SI units, and the library's rows of the same components.
LOAD = """
import json, sys
from dlml import api
from pelicun.assessment import Assessment
from pelicun.file_io import load_data
fema = api.get_fragility(next(name for name in api.list_datasets() if "FEMA P-58 2nd Edition" in name))
assessment = Assessment({"PrintLog": False})
ours = load_data(sys.argv[1], reindex=False, unit_conversion_factors=assessment.unit_conversion_factors)
assessment.damage.load_model_parameters([ours, fema], set(ours.index))
used = assessment.damage.ds_model.damage_params
rows = {
    name: {
        "loaded": used.loc[name, ("LS1", ["Theta_0", "Theta_1"])].astype(float).tolist(),
        "written": ours.loc[name, ("LS1", ["Theta_0", "Theta_1"])].astype(float).tolist(),
        "unit": ours.loc[name, ("Demand", "Unit")],
        "demand": [library.loc[name, ("Demand", "Type")] for library in (ours, fema)],
        "incomplete": int(fema.loc[name, ("Incomplete", "")]),
    }
    for name in ours.index
}
print(json.dumps(rows))
"""


def test_pelicun_completes_its_library_with_the_anchored_contents():
    python = ROOT / "target/tools/pelicun/bin/python"
    if not python.exists():
        pytest.skip("pelicun is not installed in target/tools/pelicun")
    library = ROOT / "examples/python/anchored_contents/fragility.csv"
    run = subprocess.run([python, "-c", LOAD, library], check=True, capture_output=True, text=True)
    rows = json.loads(run.stdout)
    assert len(rows) == 9
    for name, row in rows.items():
        assert row["incomplete"] == 1 and row["demand"][0] == row["demand"][1], name
        factor = {"g": 9.80665, "mps": 1.0}[row["unit"]]
        assert row["loaded"] == pytest.approx([row["written"][0] * factor, row["written"][1]], rel=1e-12), name
