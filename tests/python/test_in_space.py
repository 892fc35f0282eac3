"""The FMUs of the block in space in fmpy: checks, reference trajectories, records, states, events."""

import json
import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy import read_model_description, simulate_fmu
from fmpy.validation import validate_fmu
from lxml import etree

from conftest import ROOT
from rocking import instance
from test_fmi3 import instance as instance3

REFERENCE = ROOT / "tests/reference_space"
CASES = {case["name"]: case for case in json.loads((REFERENCE / "cases.json").read_text())}
# The paper's block on a square base, and a pulse that rocks it.
PAPER = {"dimensionless.alpha": 0.25, "dimensionless.p": 1.0, "dimensionless.depth_ratio": 1.0,
         "pulse.shape": 2, "pulse.amplitude": 6.2622, "pulse.period": 1.2566}
RECTANGLE = ["N_SW", "N_NW", "N_SE", "N_NE"]
PEAKS = [f"peak.{quantity}" for quantity in ("tilt", "twist", "drift", "N", "uplift", "slip")]


@pytest.fixture(params=[2, 3])
def in_space(request):
    name = {2: "RockingBlockInSpace.fmu", 3: "RockingBlockInSpace-fmi3.fmu"}[request.param]
    path = Path(os.environ.get("ROCKING_BLOCK_FMU", ROOT / "target/release/RockingBlock.fmu")).with_name(name)
    assert path.exists(), f"{path} is missing: cargo build --release makes it"
    return str(path)


def trajectory(name):
    return np.genfromtxt(REFERENCE / f"{name}.csv", delimiter=",", names=True)


def by_list(case, folder):
    """The start values of a case with a list of feet, which any base can be, and its beginning."""
    numbers, parameters = case["numbers"], case["parameters"]
    feet = folder / "feet.csv"
    rows = [f"{x!r}, {y!r}, {gap!r}" for (x, y), gap in zip(numbers["feet"], numbers["foot_gap"])]
    feet.write_text("\n".join(["# x, y, gap"] + rows) + "\n")
    start = {"parameterization": 2, "base": 3, "feet_file": str(feet), "mass": numbers["M"],
             "physical.center_height": numbers["center_height"], "physical.K": numbers["K"], "physical.C": numbers["C"],
             "friction": numbers["friction"], "kappa": parameters["kappa"]}
    for i, x in enumerate("xyz"):
        start[f"physical.inertia_{x}"] = numbers["inertia"][i][i]
        start |= {f"physical.inertia_{x}{y}": numbers["inertia"][i][j] for j, y in enumerate("xyz") if j > i}
    return start | beginning(case)


def by_shape(case):
    """The start values of a case with a rectangle or a circle, and its beginning."""
    parameters = case["parameters"]
    start = {"base": {"Rectangle": 1, "Circle": 2}[parameters["base"]], "mass": case["numbers"]["M"],
             "friction": parameters["friction"], "kappa": parameters["kappa"]}
    start |= {f"dimensionless.{name}": parameters[name] for name in ("alpha", "p", "eta", "xi_v")}
    if parameters["base"] == "Rectangle":
        start["dimensionless.depth_ratio"] = parameters.get("depth_ratio", 1.0)
    start |= {"feet": parameters["feet"]} if "feet" in parameters else {}
    return start | beginning(case)


def beginning(case):
    given = dict(case["initial"]["given"])
    omega = given.pop("omega", [0, 0, 0])
    return {f"initial.{name}": value for name, value in given.items()} | dict(
        zip(("initial.omega_x", "initial.omega_y", "initial.omega_z"), map(float, omega)))


def pulse(case):
    """The pulse of a case whose sines along x and y are one."""
    x, y = case["excitation"]["a_gx"], case["excitation"]["a_gy"]
    if not x:
        return {}
    assert (x["omega"], x["start"]) == (y["omega"], y["start"])
    return {"pulse.shape": 2, "pulse.amplitude": float(np.hypot(x["a"], y["a"])),
            "pulse.azimuth": float(np.arctan2(y["a"], x["a"])), "pulse.period": 2 * np.pi / x["omega"]}


def records(case, folder, turned=0.0, step=0.0005):
    """The sines of a case as accelerograms, seen from axes that are turned."""
    time = step * np.arange(round(case["t_final"] / step) + 2)
    sine = lambda wave: np.where((time > wave["start"]) & (time < wave["start"] + 2 * np.pi / wave["omega"]),
                                 wave["a"] * np.sin(wave["omega"] * (time - wave["start"])), 0)
    x, y = sine(case["excitation"]["a_gx"]), sine(case["excitation"]["a_gy"])
    cos, sin = np.cos(turned), np.sin(turned)
    for name, values in {"x": x * cos + y * sin, "y": y * cos - x * sin}.items():
        (folder / f"{name}.txt").write_text("\n".join(map(repr, values.tolist())))
    return {"record.x": str(folder / "x.txt"), "record.y": str(folder / "y.txt"), "record.x_unit": "m/s2",
            "record.dt": step, "record.azimuth": turned}


def follows(in_space, name, start, bound):
    """Compares a run with the reference, to the bound over alpha."""
    case, expected = CASES[name], trajectory(name)
    result = simulate_fmu(in_space, start_values=start | {"on_overturning": 2}, stop_time=float(expected["t"][-1]),
                          output_interval=case["dt"], relative_tolerance=1e-10,
                          output=["tilt_x", "tilt_y", "twist", "touching", "tilt", "drift_x", "drift_y", *PEAKS])
    # The last row of a block that overturns is that event.
    count = len(expected) - (case["end"] == "overturned")
    assert len(result) >= count
    for column in ("tilt_x", "tilt_y", "twist"):
        error = np.abs(result[column][:count] - expected[column][:count]).max()
        assert error < bound * case["numbers"]["alpha"], f"{column}: {error}"
    assert (result["touching"][:count] == expected["touching"][:count]).mean() > 0.995
    assert result["peak.tilt"][-1] >= result["tilt"].max() - 1e-15
    assert result["peak.twist"][-1] >= np.abs(result["twist"]).max() - 1e-15
    assert result["peak.drift"][-1] >= np.hypot(result["drift_x"], result["drift_y"]).max() - 1e-15
    weight = case["numbers"]["M"] * case["numbers"]["g"]
    rows = max(expected[name][:count].max() for name in expected.dtype.names if name.startswith("N_"))
    assert result["peak.N"][-1] >= rows - 1e-6 * weight
    for peak in PEAKS:
        assert (np.diff(result[peak]) >= 0).all(), peak


def test_fmpy_finds_no_problem(in_space):
    assert validate_fmu(in_space) == []
    result = subprocess.run([sys.executable, "-m", "fmpy", "validate", in_space], capture_output=True, text=True, check=True)
    assert "No problems found" in result.stdout


def test_the_files_are_valid_by_the_schemas_of_the_standard(in_space):
    version = read_model_description(in_space).fmiVersion[0]
    schemas = Path(fmpy.__file__).parent / "schema"
    with zipfile.ZipFile(in_space) as files:
        for name, schema in [
            ("modelDescription.xml", f"fmi{version}/fmi{version}ModelDescription.xsd"),
            ("terminalsAndIcons/terminalsAndIcons.xml", "fmi3/fmi3TerminalsAndIcons.xsd"),
        ]:
            document = etree.fromstring(files.read(name))
            etree.XMLSchema(file=schemas / schema).assertValid(document)
        page = files.read("documentation/index.html").decode()
        assert "RockingBlockInSpace" in page and "Corners are sharp" in page


@pytest.mark.parametrize("name", ["corner_release", "cylinder_16", "diagonal_overturns"])
def test_references_are_followed(name, in_space, tmp_path):
    case = CASES[name]
    follows(in_space, name, by_shape(case) | pulse(case), 1e-7)
    follows(in_space, name, by_list(case, tmp_path) | pulse(case), 1e-7)


@pytest.mark.parametrize("name, turned", [("two_axis", 0.0), ("friction", 0.7), ("six_feet", -2.0)])
def test_accelerograms_from_any_azimuth_give_the_reference(name, turned, in_space, tmp_path):
    """To what lines between samples cost."""
    case = CASES[name]
    start = by_list(case, tmp_path) | records(case, tmp_path, turned)
    if name == "six_feet":
        # Its xi_h is that of the supports.
        assert "xi_h" not in case["parameters"]
    follows(in_space, name, start, 1e-4)


@pytest.mark.parametrize("interface", ["cs", "me"])
def test_fmusim_runs_both_interfaces(in_space, interface, tmp_path):
    """A block that leans and twists, in the simulator of the standard's makers: CVode in Model Exchange."""
    if shutil.which("fmusim") is None:
        pytest.skip("fmusim is not installed")
    if interface == "me" and in_space.endswith("fmi3.fmu"):
        pytest.skip("fmusim 0.8.0 refuses every unit in Model Exchange of FMI 3.0: docs/unit/importing.md")
    start = {"initial.tilt_x": 0.06, "initial.tilt_y": 0.04, "initial.omega_z": 0.1}
    values = [word for name, value in start.items() for word in ("--start-value", f"{name}={value}")]
    outputs = ["--output-variable", "tilt", "--output-variable", "twist"]
    subprocess.run(["fmusim", "simulate", "--interface-type", interface, *values, "--stop-time", "2", "--output-interval", "0.01",
                    "--tolerance", "1e-9", "--set-tolerance", *outputs, "--output-file", tmp_path / "out.csv", in_space],
                   check=True, stdout=subprocess.DEVNULL)
    found = np.genfromtxt(tmp_path / "out.csv", delimiter=",", names=True)
    expected = simulate_fmu(in_space, start_values=start, stop_time=2.0, output_interval=0.01, relative_tolerance=1e-9,
                            output=["tilt", "twist"])
    for name in ("tilt", "twist"):
        # At an event, Model Exchange adds a row.
        at = [np.argmin(np.abs(found["time"] - time)) for time in expected["time"]]
        assert np.abs(found[name][at] - expected[name]).max() < (1e-6 if interface == "me" else 1e-12), name
    assert np.abs(expected["twist"]).max() > 0.01


@pytest.fixture
def in_space3():
    path = Path(os.environ.get("ROCKING_BLOCK_FMU", ROOT / "target/release/RockingBlock.fmu"))
    return str(path.with_name("RockingBlockInSpace-fmi3.fmu"))


def test_feet_are_arrays_in_fmi_3(in_space3, tmp_path):
    case, expected = CASES["six_feet"], trajectory("six_feet")
    start = by_list(case, tmp_path) | records(case, tmp_path)
    del start["feet_file"]
    numbers = case["numbers"]
    arrays = {"foot_x": [x for x, _ in numbers["feet"]], "foot_y": [y for _, y in numbers["feet"]], "foot_gap": numbers["foot_gap"]}
    kinds = {v.name: v.type for v in read_model_description(in_space3).modelVariables}

    def configure(block, references):
        block.enterConfigurationMode()
        block.setUInt64([references["foot_count"]], [6])
        block.exitConfigurationMode()
        for name, values in arrays.items():
            block.setFloat64([references[name]], values)
        for name, value in start.items():
            setter = {"Float64": block.setFloat64, "Int32": block.setInt32, "Enumeration": block.setInt64,
                      "String": block.setString}[kinds[name]]
            setter([references[name]], [value])

    with instance3(in_space3, configure) as (block, references):
        block.doStep(0.0, 3.0)
        row = expected[300]
        assert row["t"] == 3
        loads = block.getFloat64([references["N"]], nValues=6)
        weight = numbers["M"] * numbers["g"]
        assert all(abs(found - row[f"N_{i}"]) < 1e-2 * weight for i, found in enumerate(loads))
        assert max(loads) > 0.2 * weight
        assert max(block.getFloat64([references["uplift"]], nValues=6)) > 1e-3
        assert max(block.getFloat64([references["slip"]], nValues=6)) > 0
        assert abs(block.getFloat64([references["tilt_x"]])[0] - row["tilt_x"]) < 1e-4 * numbers["alpha"]


def test_event_mode_and_early_return_change_no_digit(in_space3):
    start = PAPER | {"pulse.azimuth": 0.4}
    names = ["tilt", "twist", "events.landings", "events.lift_offs"]
    run = lambda **more: simulate_fmu(in_space3, start_values=start, stop_time=5, output_interval=0.05,
                                      relative_tolerance=1e-10, output=names, **more)
    plain, left = run(), run(use_event_mode=True, early_return_allowed=True)
    # Rows at events are between those of the steps.
    assert len(left) > len(plain)
    rows = [np.flatnonzero(np.isclose(left["time"], time, rtol=0, atol=1e-9))[0] for time in plain["time"]]
    for name in names[:2]:
        assert np.abs(left[name][rows] - plain[name]).max() < 1e-9
    for name in names[2:]:
        assert left[name][-1] == plain[name][-1] > 4


def test_a_block_shaken_along_x_stays_in_its_plane(in_space):
    start = PAPER
    run = lambda **more: simulate_fmu(in_space, start_values=start | more, stop_time=5, output_interval=0.01,
                                      output=["tilt_x", "tilt_y", "twist", "N_SE", "N_NE", "N_NW"])
    along_x, along_y = run(), run(**{"pulse.azimuth": np.pi / 2})
    assert np.abs(along_x["tilt_x"]).max() > 0.05
    assert np.abs(along_x["tilt_y"]).max() < 1e-12 and np.abs(along_x["twist"]).max() < 1e-12
    assert np.abs(along_x["N_SE"] - along_x["N_NE"]).max() < 1e-6
    # A square base turned by a quarter turn: to the round-off of the direction.
    assert np.abs(along_x["tilt_x"] - along_y["tilt_y"]).max() < 1e-9
    assert np.abs(along_x["N_SE"] - along_y["N_NW"]).max() < 1e-2


BAD = {
    "base = List": ({"base": 3}, "Dimensionless; expected Physical"),
    "no feet": ({"base": 3, "parameterization": 2}, "expected feet_file"),
    "foundation": ({"foundation": 2}, "dimensionless.eta of 100 to 300"),
    "C_h = 0": ({"xi_h": 0.0}, "xi_h = 0"),
    "depth 0": ({"parameterization": 2, "physical.depth": 0.0}, "physical.depth = 0; expected a number above 0"),
    "width 0": ({"parameterization": 2, "physical.width": 0.0}, "physical.width = 0; expected a number above 0"),
    "inertia": ({"parameterization": 2, "physical.inertia_x": 1.0, "physical.inertia_y": 1.0, "physical.inertia_z": 3.0},
                "principal moments [1.0, 1.0, 3.0]"),
    "centre of mass outside": ({"eccentricity_x": 5.0}, "expected a centre of mass so far inside"),
    "one component": ({"record.y": "y.txt"}, "record.x is empty and record.y is not"),
    "no file": ({"record.x": "nowhere.txt"}, "record.x: nowhere.txt"),
    "no file of feet": ({"base": 3, "parameterization": 2, "feet_file": "nowhere.csv"}, "feet_file: nowhere.csv"),
}


@pytest.mark.parametrize("name", BAD)
def test_values_that_make_no_block_are_refused_by_name(name, in_space, capfd):
    start, words = BAD[name]
    with pytest.raises(Exception, match="(?i)exitInitializationMode"):
        simulate_fmu(in_space, start_values=start, stop_time=1)
    assert words in capfd.readouterr().out


@pytest.mark.parametrize("rows, words", [
    (["-1 -1", "1 1"], "feet = 2 is not valid; expected 3 to 64"),
    (["-1 -1", "1 1", "0 0"], "stand on a line"),
    (["1 -1", "1 1", "2 0"], "expected a centre of mass so far inside"),
    (["-1 -1", "1 -1", "1 1 0.1", "-1 1 0.1"], "2 feet without a gap; expected at least 3"),
    (["-1 -1", "1 x"], "line 2 is \"1 x\"; expected x, y"),
])
def test_impossible_feet_are_refused(rows, words, in_space, tmp_path, capfd):
    (tmp_path / "feet.csv").write_text("\n".join(rows))
    start = {"base": 3, "parameterization": 2, "feet_file": str(tmp_path / "feet.csv")}
    start |= {f"physical.inertia_{x}": 1000.0 for x in "xyz"}
    with pytest.raises(Exception, match="(?i)exitInitializationMode"):
        simulate_fmu(in_space, start_values=start, stop_time=1)
    assert words in capfd.readouterr().out


def test_components_of_other_steps_or_lengths_are_refused(in_space, tmp_path, capfd):
    for name, count in {"x": 100, "y": 99}.items():
        (tmp_path / f"{name}.txt").write_text("\n".join(["0.1"] * count))
    start = {"record.x": str(tmp_path / "x.txt"), "record.y": str(tmp_path / "y.txt"), "record.x_unit": "m/s2", "record.dt": 0.01}
    with pytest.raises(Exception, match="(?i)exitInitializationMode"):
        simulate_fmu(in_space, start_values=start, stop_time=1)
    assert "record.y has 99 samples; expected the 100 samples of record.x; cut the components to the samples that all have" in capfd.readouterr().out


def test_a_serialized_state_continues_with_the_same_bits(in_space3):
    """The states of FMI 3.0 are those of FMI 2.0."""
    in_space = in_space3.replace("-fmi3.fmu", ".fmu")
    start = PAPER | {"pulse.azimuth": 0.4}
    names = ("tilt", "twist", "u", "w", "v", "N_SW", "energy.residual")
    with instance(in_space, start) as (block, references), instance(in_space) as (other, _):
        wanted = [references[name] for name in names]
        block.setReal([references["F_x"]], [50.0])
        block.doStep(0.0, 1.3)
        state = block.getFMUstate()
        saved = block.serializeFMUstate(state)
        block.freeFMUstate(state)
        copy = other.deSerializeFMUstate(saved)
        other.setFMUstate(copy)
        other.freeFMUstate(copy)
        for i in range(20):
            assert block.getReal(wanted) == other.getReal(wanted)
            for each in (block, other):
                each.doStep(1.3 + 0.1 * i, 0.1)
        assert block.getReal(wanted)[0] > 1e-3
