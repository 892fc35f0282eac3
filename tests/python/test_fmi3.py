"""The FMU of FMI 3.0 in fmpy: checks, Event Mode and early return, arrays, intermediate update, Model Exchange."""

import ctypes
import json
import shutil
import subprocess
import sys
import warnings
import zipfile
from contextlib import contextmanager
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from fmpy import extract, read_model_description, simulate_fmu
from fmpy.fmi2 import FMU2Model
from fmpy.fmi3 import FMU3Slave
from fmpy.validation import validate_fmu

ROOT = Path(__file__).resolve().parents[2]
CASES = {case["name"]: case for case in json.loads((ROOT / "tests/reference/cases.json").read_text())}
ONE_SINE = {"dimensionless.alpha": 0.25, "dimensionless.p": 1.0, "pulse.shape": 2, "pulse.amplitude": 6.2622, "pulse.period": 2 * np.pi / 5}
MOTION = ["theta", "theta_dot", "v", "N_L", "N_R"]


@contextmanager
def instance(fmu3, configure=lambda block, references: None, required=(), intermediate_update=None):
    """An instance, initialized after `configure` has set it up, and its value references by name."""
    description = read_model_description(fmu3)
    references = {variable.name: variable.valueReference for variable in description.modelVariables}
    folder = extract(fmu3)
    block = FMU3Slave(
        guid=description.guid,
        unzipDirectory=folder,
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="block",
    )
    block.instantiate(
        intermediateUpdate=intermediate_update,
        requiredIntermediateVariables=[references[name] for name in required] or None,
    )
    try:
        # The block of the paper's figures.
        block.setFloat64([references["dimensionless.alpha"], references["dimensionless.p"]], [0.25, 1.0])
        configure(block, references)
        block.enterInitializationMode()
        block.exitInitializationMode()
        yield block, references
        block.terminate()
    finally:
        block.freeInstance()
        shutil.rmtree(folder, ignore_errors=True)


def test_fmpy_finds_no_problem(fmu3):
    assert validate_fmu(fmu3) == []
    command = [sys.executable, "-m", "fmpy", "validate", fmu3]
    result = subprocess.run(command, capture_output=True, text=True, check=True)
    assert "No problems found" in result.stdout


def test_the_description_is_that_of_fmi_2(fmu, fmu3):
    two, three = read_model_description(fmu), read_model_description(fmu3)
    variables = {variable.name: variable for variable in three.modelVariables}
    types = {"Real": "Float64", "Integer": "Int32", "Boolean": "Boolean", "String": "String"}
    for variable in two.modelVariables:
        same = variables.pop(variable.name)
        attributes = ("valueReference", "causality", "variability", "start")
        assert [getattr(variable, name) for name in attributes] == [getattr(same, name) for name in attributes]
        # Integers with choices in their descriptions in FMI 2.0 are enumerations here.
        choice = variable.type == "Integer" and same.type == "Enumeration"
        assert choice or types[variable.type] == same.type and variable.description == same.description
    assert {variable.causality for variable in variables.values()} == {
        "independent",
        "structuralParameter",
        "parameter",
        "local",
    }
    names = {unknown.variable.name: {v.name for v in unknown.dependencies} for unknown in two.outputs}
    # FMI 2.0 has no variable for time, and its outputs do not depend on parameters.
    later = {unknown.variable.name: {v.name for v in unknown.dependencies} for unknown in three.outputs}
    only = {"time"} | {variable.name for variable in three.modelVariables if variable.causality == "parameter"}
    assert names == {name: dependencies - only for name, dependencies in later.items()}
    assert {"dimensionless.eta", "pulse.period"}.issubset(later["theta_ddot"]) and "mass" not in later["v_L"]
    assert "time" in later["uplift_L"] and "time" not in later["theta"]


def test_outputs_change_with_declared_parameters_alone(fmu, fmu3):
    """Compares given states, set as in Model Exchange of FMI 2.0, without the quantities that accumulate from the start."""
    declared = {u.variable.name: {v.name for v in u.dependencies} for u in read_model_description(fmu3).outputs}
    description, folder = read_model_description(fmu), extract(fmu)
    variables = {variable.name: variable for variable in description.modelVariables}
    past = ("peak.", "events.", "energy.impacts", "energy.constraint", "energy.residual")
    outputs = [v for v in variables.values() if v.causality == "output" and v.type == "Real" and not v.name.startswith(past)]

    def outputs_at(values, states=None):
        block = FMU2Model(
            guid=description.guid,
            unzipDirectory=folder,
            modelIdentifier=description.modelExchange.modelIdentifier,
            instanceName="block",
        )
        block.instantiate()
        try:
            for name, value in values.items():
                set_one = block.setReal if variables[name].type == "Real" else block.setInteger
                set_one([variables[name].valueReference], [value])
            block.setupExperiment()
            block.enterInitializationMode()
            block.exitInitializationMode()
            block.newDiscreteStates()
            block.enterContinuousTimeMode()
            block.setTime(0.05)
            array = (ctypes.c_double * 11)()
            if states is None:
                block.getContinuousStates(array, 11)
                array[1], array[3], array[5] = array[1] + 0.1, array[3] + 0.01, array[5] + 0.1
            else:
                array[:] = states
            block.setContinuousStates(array, 11)
            regime = block.getInteger([variables["regime"].valueReference])
            return list(array), regime, block.getReal([v.valueReference for v in outputs])
        finally:
            block.freeInstance()

    pulse = {"pulse.shape": 2, "pulse.amplitude": 2.0, "pulse.period": 0.7}
    sizes = {"physical.width": 2.0, "physical.height": 6.0, "physical.K": 9e5, "physical.C": 5e3}
    tie = {"block_x": 1.0, "block_z": 8.0, "ground_x": 6.0, "ground_z": -0.5, "stiffness": 3e3, "pretension": 400.0, "damping": 50.0}
    ties = {f"tie_{number}.{name}": value for number in (1, 2) for name, value in tie.items()}
    damper = {"block_x": 1.0, "ground_x": 1.2, "ground_z": -2.0, "stiffness": 5e4, "damping": 20.0, "strength": 1e6,
              "yield_force": 100.0, "hardening": 0.1}
    dampers = {f"damper_{number}.{name}": value for number in (1, 2) for name, value in damper.items()}
    seen = set()
    for base in (
        {"initial.theta": 0.1},
        {"initial.theta": 0.002},
        {"initial.theta": -0.1, "foundation": 2},
        {"initial.theta": 0.1, "parameterization": 2} | sizes,
        {"initial.theta": 0.1, "friction": 0.4} | ties,
        {"initial.theta": 0.1} | dampers,
    ):
        base = pulse | base
        states, regime, before = outputs_at(base)
        for name, variable in variables.items():
            if variable.causality != "parameter" or variable.type != "Real" or name.startswith(("record", "initial")):
                continue
            # A tie or a damper needs its ends.
            link = name.partition(".")[0]
            if link.startswith(("tie_", "damper_")) and f"{link}.stiffness" not in base:
                continue
            value = base.get(name, float(variable.start))
            # A strength below the pretension is refused.
            small = 500.0 if name.endswith(".strength") else 0.01
            _, other, after = outputs_at(base | {name: 1.01 * value if value else small}, states)
            assert other == regime
            for output, a, b in zip(outputs, before, after):
                if abs(a - b) > 1e-9 * max(abs(a), 1e-6):
                    assert name in declared[output.name], f"{output.name} changes with {name}"
                    seen.add((output.name, name))
    shutil.rmtree(folder, ignore_errors=True)
    assert len(seen) > 100


def test_what_is_declared(fmu3):
    with zipfile.ZipFile(fmu3) as archive:
        root = ElementTree.fromstring(archive.read("modelDescription.xml"))
    both = {"canGetAndSetFMUState", "canSerializeFMUState", "providesDirectionalDerivatives", "providesAdjointDerivatives"}
    stepping = {
        "canHandleVariableCommunicationStepSize",
        "providesIntermediateUpdate",
        "mightReturnEarlyFromDoStep",
        "canReturnEarlyAfterIntermediateUpdate",
        "hasEventMode",
    }
    for interface, flags in (("CoSimulation", both | stepping), ("ModelExchange", both | {"needsCompletedIntegratorStep"})):
        declared = root.find(interface).attrib
        assert {name for name, value in declared.items() if value == "true"} == flags
    assert root.find("CoSimulation").get("maxOutputDerivativeOrder") == "1"
    # Superfluous for inputs, and refused by CasADi.
    assert {v.get("initial") for v in root.find("ModelVariables") if v.get("causality") == "input"} == {None}


def test_event_mode_early_return_and_fmi_2_give_the_same_bits(fmu, fmu3):
    def end(fmu, **how):
        result = simulate_fmu(
            fmu,
            start_values=ONE_SINE | {"on_separation": 3, "epsilon": 0.3},
            stop_time=10,
            output_interval=0.01,
            output=MOTION,
            **how,
        )
        return len(result), result[-1].tobytes()

    two, whole = end(fmu), end(fmu3)
    early = end(fmu3, early_return_allowed=True)
    events = end(fmu3, early_return_allowed=True, use_event_mode=True)
    assert two == whole
    assert early[0] > whole[0] and events[0] > early[0]
    assert {two[1], whole[1], early[1], events[1]} == {whole[1]}


# Under a record, FMI 2.0 covers the same solver (test_model_exchange.py).
LONG = [pytest.param("ModelExchange", name, marks=pytest.mark.check) for name, case in CASES.items() if "record" in case["a_gx"]]
SHORT = [("ModelExchange", name) for name, case in CASES.items() if "record" not in case["a_gx"]]


@pytest.mark.parametrize("interface, name", [("CoSimulation", name) for name in CASES] + SHORT + LONG)
def test_references_are_met(fmu3, reference, name, interface):
    from test_model_exchange import start_values

    case = CASES[name]
    expected = np.genfromtxt(reference / f"{name}.csv", delimiter=",", names=True)
    how = {"use_event_mode": True, "early_return_allowed": True} if interface == "CoSimulation" else {"solver": "CVode"}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        result = simulate_fmu(
            fmu3,
            fmi_type=interface,
            start_values=start_values(case),
            stop_time=case["t_end"],
            output_interval=case["dt"],
            relative_tolerance=1e-10,
            output=["theta"],
            **how,
        )
    # Rows of events lie between those of the communication points.
    times = expected["t"][expected["t"] <= result["time"][-1] + 1e-9]
    rows = np.searchsorted(result["time"], times - 1e-9)
    error = np.abs(result["theta"][rows] - expected["theta"][: len(times)]).max() / case["alpha"]
    # The same as for FMI 2.0 in tests/python/test_fmu.py and test_model_exchange.py.
    assert error < (1e-7 if interface == "CoSimulation" else 1e-6), error


def test_a_record_in_arrays(fmu3):
    samples = 3.0 * np.sin(0.3 * np.arange(300))

    def configure(block, references):
        block.enterConfigurationMode()
        block.setUInt64([references["record.samples"]], [len(samples)])
        block.exitConfigurationMode()
        block.setFloat64([references["record.horizontal_samples"]], samples)
        block.setFloat64([references["record.dt"]], [0.01])

    with instance(fmu3, configure) as (block, references):
        assert block.getFloat64([references["record.PGA"]])[0] == np.abs(samples).max()
        read = block.getFloat64([references["record.horizontal_samples"]], nValues=len(samples))
        assert np.array_equal(read, samples)
        block.doStep(0.0, 3.0)
        assert block.getFloat64([references["peak.theta"]])[0] > 1e-3


def test_inputs_inside_a_step(fmu3):
    """One step of a second under a sine, given inside the step, against steps of 5 ms."""

    def ground(time):
        return 3.0 * np.sin(6.0 * time)

    asked = []

    def update(environment, time, set_requested, get_allowed, finished, can_return_early, requested, return_time):
        if set_requested:
            asked.append(time)
            block.setFloat64([references["a_gx"]], [ground(time)])

    with instance(fmu3, required=["a_gx"], intermediate_update=update) as (block, references):
        block.doStep(0.0, 1.0)
        theta = block.getFloat64([references["theta"]])[0]
    assert len(asked) == 200 and np.allclose(np.diff(asked), 0.005)
    with instance(fmu3) as (block, references):
        for i in range(2000):
            # Held at its value in the middle of half a millisecond: of second order, like linear interpolation.
            block.setFloat64([references["a_gx"]], [ground((i + 0.5) / 2000)])
            block.doStep(i / 2000, (i + 1) / 2000 - i / 2000)
        expected = block.getFloat64([references["theta"]])[0]
    assert abs(expected) > 1e-3
    # Linear in between, the input is off by at most 3·36·(5 ms)²/8 = 3e-4 m/s², a ten-thousandth of its 3 m/s².
    assert abs(theta - expected) < 1e-3 * abs(expected)
