"""The FMU in fmpy: checks, simulations, a record, states, derivatives, and the output of its programs."""

import os
import re
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
from rocking import follow, instance

# The block of the paper's figures and of most reference trajectories.
PAPER = {"dimensionless.alpha": 0.25, "dimensionless.p": 1.0}
ONE_SINE = PAPER | {"pulse.shape": 2, "pulse.amplitude": 6.2622, "pulse.period": 2 * np.pi / 5}


def trajectory(reference, name):
    return np.genfromtxt(reference / f"{name}.csv", delimiter=",", names=True)


def test_fmpy_finds_no_problem(fmu):
    assert validate_fmu(fmu) == []
    command = [sys.executable, "-m", "fmpy", "validate", fmu]
    result = subprocess.run(command, capture_output=True, text=True, check=True)
    assert "No problems found" in result.stdout


@pytest.mark.parametrize("version", [2, 3])
def test_the_files_are_valid_by_the_schemas_of_the_standard(version, fmu, fmu3):
    schemas = Path(fmpy.__file__).parent / "schema"
    with zipfile.ZipFile(fmu if version == 2 else fmu3) as files:
        for name, schema in [
            ("modelDescription.xml", f"fmi{version}/fmi{version}ModelDescription.xsd"),
            ("terminalsAndIcons/terminalsAndIcons.xml", "fmi3/fmi3TerminalsAndIcons.xsd"),
        ]:
            document = etree.fromstring(files.read(name))
            etree.XMLSchema(file=schemas / schema).assertValid(document)
        variables = {variable.name for variable in read_model_description(fmu).modelVariables}
        members = [node.get("variableName") for node in document.iter("TerminalMemberVariable")]
        assert variables.issuperset(members) and {"a_gx", "F_x", "u", "H"}.issubset(members)
        assert files.read("terminalsAndIcons/icon.png").startswith(b"\x89PNG")


def test_the_description_is_what_the_interface_promises(fmu):
    description = read_model_description(fmu)
    co_simulation = description.coSimulation
    assert co_simulation.canHandleVariableCommunicationStepSize
    assert co_simulation.canInterpolateInputs
    assert co_simulation.canGetAndSetFMUstate
    assert co_simulation.canSerializeFMUstate
    assert co_simulation.providesDirectionalDerivative
    assert co_simulation.maxOutputDerivativeOrder == 1
    assert description.variableNamingConvention == "structured"
    for variable in description.modelVariables:
        assert variable.description
        if variable.type == "Real":
            assert variable.declaredType.unit or variable.unit
    depends = {unknown.variable.name: {v.name for v in unknown.dependencies} for unknown in description.outputs}
    inputs = {"a_gx", "a_gz", "F_x", "F_z", "M_y"}
    for name in ("theta", "theta_dot", "v", "v_dot", "u", "u_dot"):
        assert depends[name] & inputs == set()
    for name in ("theta_ddot", "v_ddot", "u_ddot", "N_L", "N_R", "H", "M_base"):
        assert depends[name] & inputs == inputs


@pytest.mark.parametrize("tolerance, bound", [(1e-10, 1e-7), (None, 1e-5)])
def test_simulate_fmu_follows_the_reference(fmu, reference, tolerance, bound):
    result = simulate_fmu(
        fmu,
        start_values=ONE_SINE,
        stop_time=10,
        output_interval=0.01,
        relative_tolerance=tolerance,
        output=["theta", "regime", "energy.residual", "energy.total"],
    )
    expected = trajectory(reference, "sine_eta40")
    assert len(result) == len(expected)
    assert np.abs(result["theta"] - expected["theta"]).max() < bound * 0.25
    assert np.abs(result["energy.residual"]).max() < 1e-8 * np.abs(result["energy.total"]).max()
    assert (result["regime"] == expected["regime"]).mean() > 0.999


def test_variable_steps_end_at_the_same_motion(fmu):
    run = lambda interval: simulate_fmu(fmu, start_values=ONE_SINE, stop_time=6, output_interval=interval,
                                        relative_tolerance=1e-10, output=["theta"])["theta"][-1]
    assert abs(run(0.5) - run(0.0078125)) < 1e-8


def test_a_record_with_held_inputs(fmu, rinaldi):
    """`simulate_fmu` holds the record over each step; its command line does the same."""
    time = 0.01 * np.arange(300)
    signal = np.array(list(zip(time, rinaldi)), dtype=[("time", float), ("a_gx", float)])
    result = simulate_fmu(fmu, start_values=PAPER, input=signal, stop_time=2.99, output_interval=0.01, output=["theta"])
    with instance(fmu, PAPER) as (slave, references):
        for i, acceleration in enumerate(rinaldi[:299]):
            # fmpy interpolates between samples by itself, to rounding.
            slave.setReal([references["a_gx"]], [acceleration])
            slave.doStep(0.01 * i, 0.01)
        theta = slave.getReal([references["theta"]])[0]
    assert abs(theta) > 1e-4
    assert abs(result["theta"][-1] - theta) < 1e-9


def test_the_command_line_simulates_with_a_record(fmu, rinaldi, reference, tmp_path):
    """Held over each step, the record is half a step late."""
    table, out = tmp_path / "record.csv", tmp_path / "out.csv"
    rows = "\n".join(f"{0.01 * i!r},{a!r}" for i, a in enumerate(rinaldi))
    table.write_text(f"time,a_gx\n{rows}\n")
    command = [sys.executable, "-m", "fmpy", "simulate", fmu, "--input-file", str(table), "--output-file", str(out),
               "--stop-time", "19.9", "--output-interval", "0.01", "--output-variables", "theta", "N_L", "regime",
               "--start-values", *(word for name, value in PAPER.items() for word in (name, str(value)))]
    subprocess.run(command, capture_output=True, text=True, check=True)
    result = np.genfromtxt(out, delimiter=",", names=True)
    assert len(result) == 1991
    expected = trajectory(reference, "rinaldi")
    late = np.interp(expected["t"] - 0.005, expected["t"], expected["theta"])
    assert np.abs(result["theta"] - late).max() < 1e-3 * 0.25
    assert np.abs(result["theta"] - expected["theta"]).max() > 2e-3 * 0.25


def test_a_record_is_followed_exactly_at_any_step(fmu, rinaldi, reference):
    expected = trajectory(reference, "rinaldi")["theta"]
    thetas = []
    for parts in (1, 10):
        _, rows = follow(fmu, 0.01, rinaldi, parts, tolerance=1e-10, start_values=PAPER)
        theta = rows[:, 0]
        assert np.abs(theta - expected).max() < 1e-7 * 0.25
        thetas.append(theta)
    assert np.abs(thetas[0] - thetas[1]).max() < 1e-7


def test_states_are_saved_restored_and_moved(fmu):
    names = ["theta", "theta_dot", "N_L", "N_R", "uplift_L", "energy.dashpots", "peak.theta"]
    with instance(fmu, ONE_SINE) as (slave, references), instance(fmu, ONE_SINE) as (other, _):
        wanted = [references[name] for name in names]
        slave.doStep(0.0, 1.0)
        state = slave.getFMUstate()
        data = slave.serializeFMUstate(state)
        slave.doStep(1.0, 2.0)
        first = slave.getReal(wanted)
        slave.setFMUstate(state)
        slave.doStep(1.0, 2.0)
        assert slave.getReal(wanted) == first
        moved = other.deSerializeFMUstate(data)
        other.setFMUstate(moved)
        other.doStep(1.0, 2.0)
        assert other.getReal(wanted) == first
        slave.freeFMUstate(state)
        other.freeFMUstate(moved)


def test_directional_and_output_derivatives(fmu):
    with instance(fmu, ONE_SINE) as (slave, references):
        slave.doStep(0.0, 1.0)
        outputs = [references[name] for name in ("theta_ddot", "H", "N_L", "theta")]
        ground = [references["a_gx"]]
        exact = slave.getDirectionalDerivative(outputs, ground, [1.0])
        before = slave.getReal(outputs)
        slave.setReal(ground, [1.0])
        differences = np.subtract(slave.getReal(outputs), before)
        slave.setReal(ground, [0.0])
        assert np.allclose(exact, differences, rtol=1e-9, atol=1e-9)
        assert exact[0] < 0 and exact[1] > 0 and exact[2:] == [0.0, 0.0]
        theta_dot, = slave.getReal([references["theta_dot"]])
        assert slave.getRealOutputDerivatives([references["theta"]], [1]) == [theta_dot]


def test_the_example_of_the_page(fmu, capsys):
    """Runs the Python of docs/unit/importing.md unchanged, on the FMU under test."""
    text = (ROOT / "docs/unit/importing.md").read_text()
    (code,) = [code for code in re.findall(r"```python\n(.*?)```", text, re.DOTALL) if "fmpy" in code]
    code = code.replace("target/release/RockingBlock.fmu", fmu)
    exec(compile(code, "importing.md", "exec"), {})
    peak = float(re.search(r"peak rotation ([\d.]+) rad", capsys.readouterr().out)[1])
    # The reference case sine_eta40.
    assert abs(peak - 0.14495) < 1e-4
    for command in re.findall(r"^    (scripts/\S+)$", (ROOT / "README.md").read_text(), re.MULTILINE):
        assert os.access(ROOT / command, os.X_OK)


def test_a_record_inside_is_one_option_of_the_command_line(fmu, tmp_path):
    """The start values rock under the project's record, in a folder with a blank and a sign in its name."""
    folder = tmp_path / "strong motion 100 %"
    folder.mkdir()
    record = folder / "größer.smc"
    record.write_bytes((ROOT / "examples/records/np01002p_4225a_a.smc").read_bytes())
    out = tmp_path / "out.csv"
    command = [sys.executable, "-m", "fmpy", "simulate", fmu, "--stop-time", "20", "--output-interval", "0.5",
               "--output-file", str(out), "--output-variables", "theta", "record.PGA", "peak.theta",
               "--start-values", "record.horizontal", record.name, "record.scale", "0.9"]
    subprocess.run(command, capture_output=True, text=True, check=True, cwd=folder)
    coarse = np.genfromtxt(out, delimiter=",", names=True)
    assert 0.3 < coarse["peaktheta"][-1] / 0.18 < 0.8
    values = {"record.horizontal": str(record), "record.scale": 0.9}
    fine = simulate_fmu(fmu, start_values=values, stop_time=20, output_interval=0.005, output=["theta"])
    assert np.abs(fine["theta"][::100] - coarse["theta"]).max() < 1e-7


RESUME = """
import sys
from rocking import instance
with instance(sys.argv[1]) as (slave, references):
    slave.setFMUstate(slave.deSerializeFMUstate(open(sys.argv[2], "rb").read()))
    slave.doStep(4.0, 6.0)
    print(slave.getReal([references["theta"], references["energy.total"]]))
"""


def test_another_process_resumes_without_the_file(fmu, tmp_path):
    record = tmp_path / "record.smc"
    record.write_bytes((ROOT / "examples/records/np01002p_4225a_a.smc").read_bytes())
    values = PAPER | {"record.horizontal": str(record), "record.scale": 3}
    with instance(fmu, values) as (slave, references):
        slave.doStep(0.0, 4.0)
        state = slave.getFMUstate()
        (tmp_path / "state").write_bytes(bytes(slave.serializeFMUstate(state)))
        slave.freeFMUstate(state)
        slave.doStep(4.0, 6.0)
        expected = slave.getReal([references["theta"], references["energy.total"]])
    record.unlink()
    command = [sys.executable, "-c", RESUME, fmu, str(tmp_path / "state")]
    printed = subprocess.run(command, capture_output=True, text=True, check=True, cwd=Path(__file__).parent)
    assert printed.stdout.strip() == str(expected)
