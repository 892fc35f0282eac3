"""The FMU for WebAssembly beside the native FMU of FMI 3.0: the same bits, states and messages. docs/unit/wasm.md."""

import json
import os
import shutil
import struct
import zipfile
from ctypes import c_double
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from fmpy import extract, read_model_description
from fmpy.fmi3 import FMU3Model, FMU3Slave, fmi3IntermediateUpdateCallback
from test_model_exchange import start_values

# scripts/dev/check installs it.
pytest.importorskip("wasmtime")
from wasm import MODEL_EXCHANGE, Instance, Refused  # noqa: E402

pytestmark = pytest.mark.check

ROOT = Path(__file__).resolve().parents[2]
CASES = {case["name"]: case for case in json.loads((ROOT / "tests/reference/cases.json").read_text())}
ROCKING = {"dimensionless.alpha": 0.25, "dimensionless.p": 1.0, "pulse.shape": 2, "pulse.amplitude": 6.2622,
           "pulse.period": 1.2566370614359172, "on_separation": 3, "epsilon": 0.3}
RELEASED = {"foundation": 2, "initial.theta": 0.1}
STATES = 11
INDICATORS = 22


@pytest.fixture(scope="module")
def wasm():
    path = Path(os.environ.get("ROCKING_BLOCK_WASM", ROOT / "target/wasm/RockingBlock-wasm.fmu"))
    if not path.exists():
        pytest.skip("scripts/dev/wasm-unit has not made the FMU for WebAssembly: it needs the target wasm32-wasip2")
    return str(path)


@pytest.fixture(scope="module")
def variables(fmu3):
    return {variable.name: variable for variable in read_model_description(fmu3).modelVariables}


@pytest.fixture
def native(fmu3):
    """Makes instances of the native FMU."""
    folder, description, made = extract(fmu3), read_model_description(fmu3), []

    def make(model_exchange=False, **options):
        of = FMU3Model if model_exchange else FMU3Slave
        identifier = description.modelExchange.modelIdentifier
        block = of(guid=description.guid, unzipDirectory=folder, modelIdentifier=identifier, instanceName="block")
        block.instantiate(**options)
        made.append(block)
        return block

    yield make
    for block in made:
        block.freeInstance()
    shutil.rmtree(folder, ignore_errors=True)


@pytest.fixture
def both(native, wasm, variables):
    """Makes a pair of instances with these values: native, WebAssembly."""

    def make(values, **options):
        exchange = options.pop("model_exchange", False)
        names = ("eventModeUsed", "earlyReturnAllowed")
        chosen = [options.get(name, False) for name in names] + [[]]
        kind = {"kind": MODEL_EXCHANGE} if exchange else {"options": chosen}
        pair = native(exchange, **options), Instance(wasm, **kind)
        for block in pair:
            put(block, variables, values)
        return pair

    return make


def put(block, variables, values):
    for name, value in values.items():
        variable = variables[name]
        kind = {"Enumeration": "Int64"}.get(variable.type, variable.type)
        convert = {"Float64": float, "Boolean": bool, "String": str}.get(kind, int)
        getattr(block, f"set{kind}")([variable.valueReference], [convert(value)])


def bits(values):
    return struct.pack(f"<{len(values)}d", *values)


def output_bits(block, variables):
    """The bytes of all outputs, and the integers."""
    found = []
    for kind, getter in [("Float64", "Float64"), ("Int32", "Int32"), ("Enumeration", "Int64"), ("Boolean", "Boolean")]:
        of = [v.valueReference for v in variables.values() if v.causality == "output" and v.type == kind]
        assert of
        found.append(bits([float(value) for value in getattr(block, f"get{getter}")(of)]))
    return found


def initialize(block, event_mode=False):
    block.enterInitializationMode()
    block.exitInitializationMode()
    if event_mode:
        block.updateDiscreteStates()
        block.enterStepMode()


@pytest.mark.parametrize("name", CASES)
def test_reference_cases_have_the_bits_of_the_native_unit(name, native, wasm, variables):
    case = CASES[name]
    values = start_values(case)
    files = {name: Path(values[name]) for name in ("record.horizontal", "record.vertical") if name in values}
    folders = [file.parent for file in files.values()][:1]
    shown = values | {name: f"/records/{file.name}" for name, file in files.items()}
    blocks = native(), Instance(wasm, folder=next(iter(folders), None))
    for block, given in zip(blocks, (values, shown), strict=True):
        put(block, variables, given)
        initialize(block)
    size = case["dt"]
    for i in range(round(case["t_end"] / size)):
        found = []
        for block in blocks:
            stepped = block.doStep(i * size, size)
            found.append((stepped, output_bits(block, variables)))
        assert found[0] == found[1], f"at {i * size} s"
        if stepped[1]:
            break
    assert i > 10


@pytest.mark.parametrize("event_mode", [False, True])
def test_steps_are_left_at_events_as_natively(event_mode, both, variables):
    blocks = both(ROCKING, eventModeUsed=event_mode, earlyReturnAllowed=True)
    for block in blocks:
        initialize(block, event_mode)
    here, events = 0.0, 0
    while here < 8.0:
        size = min(0.1, 8.0 - here)
        found = []
        for block in blocks:
            stepped = block.doStep(here, size)
            found.append((stepped, output_bits(block, variables)))
            if stepped[0]:
                block.enterEventMode()
                block.updateDiscreteStates()
                block.enterStepMode()
                found[-1] += (output_bits(block, variables),)
        assert found[0] == found[1]
        event, _, early, here = found[0][0]
        assert event == (early and event_mode)
        events += early
    assert events >= 2


def test_an_intermediate_update_can_end_the_step(native, wasm, variables):
    """The importer is not asked unless it allows early return and requires variables: here the call would fail."""
    theta = variables["theta"].valueReference

    def leaves(time, get_allowed):
        return get_allowed and time >= 0.42

    @fmi3IntermediateUpdateCallback
    def update(_, time, set_requested, get_allowed, finished, can_return_early, requested, return_time):
        requested[0], return_time[0] = leaves(time, get_allowed), time

    def asked(time, set_requested, get_allowed, finished, can_return_early):
        return leaves(time, get_allowed), time

    expected = native(earlyReturnAllowed=True, intermediateUpdate=update, requiredIntermediateVariables=[theta])
    block = Instance(wasm, options=[False, True, [theta]], on_update=asked)
    steps = []
    for each in (expected, block):
        put(each, variables, RELEASED)
        initialize(each)
        steps.append(each.doStep(0.0, 1.0))
    assert steps[0] == steps[1] and steps[0][2] and 0.42 <= steps[0][3] < 0.5
    assert output_bits(block, variables) == output_bits(expected, variables)
    for options in ([False, False, [theta]], [False, True, []]):
        silent = Instance(wasm, options=options)
        initialize(silent)
        assert silent.doStep(0.0, 1.0)[3] == 1.0


def test_saved_states_go_on_with_the_same_bits_in_either_unit(both, wasm, variables):
    native, block = both(ROCKING)
    for each in (native, block):
        initialize(each)
        each.doStep(0.0, 1.5)
    saved = bytes(block.getFMUState())
    state = native.getFMUState()
    assert native.serializeFMUState(state) == saved
    native.freeFMUState(state)
    block.doStep(1.5, 2.0)
    ahead = output_bits(block, variables)
    block.reset()
    for each in (block, Instance(wasm)):
        each.setFMUState(saved)
        each.doStep(1.5, 2.0)
        assert output_bits(each, variables) == ahead
    native.doStep(1.5, 1.0)
    state = native.deserializeFMUState(saved)
    native.setFMUState(state)
    native.freeFMUState(state)
    native.doStep(1.5, 2.0)
    assert output_bits(native, variables) == ahead


def test_derivatives_have_the_bits_of_the_native_unit(both, variables):
    native, block = both(ROCKING)
    for each in (native, block):
        initialize(each)
        each.doStep(0.0, 1.5)
    unknowns = [variables[name].valueReference for name in ("theta_ddot", "v_ddot", "H")]
    knowns = [variables[name].valueReference for name in ("a_gx", "a_gz")]
    directional = native.getDirectionalDerivative(unknowns, knowns, [1.0, 0.5])
    assert all(directional)
    assert bits(block.getDirectionalDerivative(unknowns, knowns, [1.0, 0.5])) == bits(directional)
    adjoint = native.getAdjointDerivative(unknowns, knowns, [1.0, 2.0, 3.0], len(knowns))
    assert bits(block.getAdjointDerivative(unknowns, knowns, [1.0, 2.0, 3.0])) == bits(adjoint)
    rates = native.getOutputDerivatives(unknowns[:2], [1, 1])
    assert bits(block.getOutputDerivatives([(unknown, 1) for unknown in unknowns[:2]])) == bits(rates)


def test_a_record_in_a_folder_and_in_arrays_has_the_bits_of_the_native_unit(both, wasm, variables, tmp_path):
    samples = [3.0 * np.sin(0.3 * i) for i in range(300)]
    array = variables["record.horizontal_samples"].valueReference
    values = {"epsilon": 0.3, "on_separation": 3, "record.dt": 0.01, "record.scale": 3.0, "record.start": 0.25}
    native, by_arrays = both(values)
    for block in (native, by_arrays):
        block.enterConfigurationMode()
        put(block, variables, {"record.samples": 300})
        block.exitConfigurationMode()
        block.setFloat64([array], samples)
    # An array among scalars: the component knows its size.
    mixed = [variables["mass"].valueReference, array, variables["record.dt"].valueReference]
    assert by_arrays.getFloat64(mixed) == [1000.0, *samples, 0.01]
    (tmp_path / "horizontal.txt").write_text("".join(f"{float(sample)!r}\n" for sample in samples))
    by_file = Instance(wasm, folder=tmp_path)
    put(by_file, variables, values)
    for name, text in {"record.horizontal": "/records/horizontal.txt", "record.horizontal_unit": "m/s2"}.items():
        by_file.setString([variables[name].valueReference], [text])
        assert by_file.getString([variables[name].valueReference]) == [text]
    found = []
    for block in (native, by_arrays, by_file):
        initialize(block)
        for i in range(40):
            block.doStep(i * 0.1, 0.1)
        found.append(output_bits(block, variables))
    assert native.getInt32([variables["events.impacts"].valueReference])[0] > 0
    assert found[0] == found[1] == found[2]


def test_files_outside_the_shown_folder_do_not_exist(wasm, variables, tmp_path):
    (tmp_path / "outside.txt").write_text("0.0\n1.0\n")
    shown = tmp_path / "shown"
    shown.mkdir()
    for folder, path in [
        (None, str(tmp_path / "outside.txt")),
        (shown, str(tmp_path / "outside.txt")),
        (shown, "/records/../outside.txt"),
        (shown, "/records/missing.txt"),
    ]:
        block = Instance(wasm, folder=folder)
        put(block, variables, {"record.dt": 0.01})
        block.setString([variables["record.horizontal"].valueReference], [path])
        block.enterInitializationMode()
        refused(block.exitInitializationMode, words=["fmi3ExitInitializationMode", path])


def test_model_exchange_has_the_bits_of_the_native_unit(both, variables):
    """Heun's steps need not be exact, but come to two impacts."""
    native, block = blocks = both(RELEASED, model_exchange=True)

    def event():
        found = [native.updateDiscreteStates(), tuple(vars(block.updateDiscreteStates()).values())]
        assert found[0] == found[1]
        for each in blocks:
            each.enterContinuousTimeMode()
        return found[0][3]

    def read(name):
        place = (c_double * (INDICATORS if name == "EventIndicators" else STATES))()
        getattr(native, f"get{name}")(place, len(place))
        found = getattr(block, f"get{name}")()
        assert bits(found) == bits(list(place)), name
        return np.array(found)

    def move(time, states):
        for each in blocks:
            each.setTime(float(time))
        native.setContinuousStates((c_double * STATES)(*states), STATES)
        block.setContinuousStates([float(state) for state in states])

    for each in blocks:
        initialize(each)
    assert (block.getNumberOfContinuousStates(), block.getNumberOfEventIndicators()) == (STATES, INDICATORS)
    event()
    read("NominalsOfContinuousStates")
    time, states, size, impacts = 0.0, read("ContinuousStates"), 2e-3, 0
    while impacts < 2 and time < 10.0:
        first = read("ContinuousStateDerivatives")
        move(time + size, states + size * first)
        second = read("ContinuousStateDerivatives")
        time, states = time + size, states + 0.5 * size * (first + second)
        move(time, states)
        completed = block.completedIntegratorStep(True)
        assert tuple(vars(completed).values()) == native.completedIntegratorStep()
        assert output_bits(block, variables) == output_bits(native, variables)
        if read("EventIndicators").min() < 0.0:
            for each in blocks:
                each.enterEventMode()
            assert event(), "an impact changes the states"
            states, impacts = read("ContinuousStates"), impacts + 1
    assert impacts == 2 == native.getInt32([variables["events.impacts"].valueReference])[0]
    # The draft has these functions of Co-Simulation in the resource of Model Exchange.
    refused(block.enterStepMode, words=["fmi3EnterStepMode", "Co-Simulation"])
    refused(block.getOutputDerivatives, [(0, 1)], words=["fmi3GetOutputDerivatives", "Co-Simulation"])
    refused(block.setContinuousStates, [0.0] * 3, words=["fmi3SetContinuousStates", "room for 3 states; expected 11"])
    refused(block.setTime, float("nan"), words=["fmi3SetTime", "NaN"])
    saved, before = block.getFMUState(), output_bits(block, variables)
    block.setContinuousStates([0.01] * STATES)
    assert output_bits(block, variables) != before
    block.setFMUState(saved)
    assert output_bits(block, variables) == before


def refused(act, *arguments, words):
    """Expects the error status and one message with these words."""
    with pytest.raises(Refused) as failed:
        act(*arguments)
    assert failed.value.status in ("error", None)
    [(name, status, category, text)] = failed.value.messages
    assert (status, category) == ("error", "logStatusError") and name in ("block", " ", "?")
    assert all(word in text for word in words), text


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"name": " "}, ["fmi3InstantiateCoSimulation", "instanceName is missing"]),
        ({"given": ""}, ['instantiationToken = ""', "expected"]),
        ({"name": "a\0b"}, ["instance-name holds a 0 at 1"]),
        ({"given": "\0"}, ["instantiation-token holds a 0 at 0"]),
        ({"options": [False, True, [2**32 - 1]]}, ["requiredIntermediateVariables", "4294967295"]),
    ],
)
def test_an_instance_needs_a_name_the_token_and_variables(wasm, options, words):
    def make():
        instance = Instance(wasm, **options)
        raise AssertionError(instance)

    refused(make, words=words)


def test_misuse_has_a_status_and_a_message_and_changes_nothing(wasm, variables):
    block = Instance(wasm)
    before = block.getFMUState()
    reference = {name: [variables[name].valueReference] for name in ("mass", "theta", "record.horizontal")}
    mass, theta, text = reference.values()
    early = "not allowed in Instantiated"
    clocks, dependencies = "this FMU has no clocks", "providesPerElementDependencies is false"
    for method, arguments, words in [
        (block.setFloat64, (mass, [1.0, 2.0]), ["nValues = 2", "expected 1"]),
        (block.setFloat64, (mass, []), ["nValues = 0", "expected 1"]),
        (block.setFloat64, (mass, [float("nan")]), ["mass = NaN"]),
        (block.setFloat64, ([2**32 - 1], [1.0]), ["4294967295", "does not exist"]),
        (block.getFloat64, ([2**32 - 1],), ["4294967295", "does not exist"]),
        (block.getFloat32, (mass,), ["mass", "Float64; expected Float32"]),
        (block.setUInt16, (mass, [1]), ["mass", "Float64; expected UInt16"]),
        (block.getBinary, (mass,), ["mass", "Float64; expected Binary"]),
        (block.getString, (mass,), ["mass", "Float64; expected String"]),
        (block.setString, (text, []), ["nValues = 0"]),
        (block.setDebugLogging, (True, ["nothing"]), ['"nothing" does not exist']),
        (block.setFMUState, (b"",), ["fmi3SetFMUState", "refused"]),
        (block.setFMUState, (bytes(before)[:-1] + bytes([before[-1] ^ 1]),), ["fmi3SetFMUState", "refused"]),
        (block.exitInitializationMode, (), ["fmi3ExitInitializationMode", early]),
        (block.enterEventMode, (), ["fmi3EnterEventMode", early]),
        (block.updateDiscreteStates, (), ["fmi3UpdateDiscreteStates", early]),
        (block.doStep, (0.0, 1.0), ["fmi3DoStep", early]),
        (block.terminate, (), ["fmi3Terminate", early]),
        (block.getDirectionalDerivative, (theta, theta, [1.0]), ["fmi3GetDirectionalDerivative", early]),
        (block.getAdjointDerivative, (theta, theta, [1.0]), ["fmi3GetAdjointDerivative", early]),
        (block.getOutputDerivatives, ([(theta[0], 1)],), ["fmi3GetOutputDerivatives", early]),
        (block.getClock, (theta,), ["fmi3GetClock", clocks]),
        (block.setClock, (theta, [True]), ["fmi3SetClock", clocks]),
        (block.getIntervalDecimal, (theta,), ["fmi3GetIntervalDecimal", clocks]),
        (block.getIntervalFraction, (theta,), ["fmi3GetIntervalFraction", clocks]),
        (block.getShiftDecimal, (theta,), ["fmi3GetShiftDecimal", clocks]),
        (block.getShiftFraction, (theta,), ["fmi3GetShiftFraction", clocks]),
        (block.setIntervalDecimal, (theta, [1.0]), ["fmi3SetIntervalDecimal", clocks]),
        (block.setIntervalFraction, (theta, []), ["fmi3SetIntervalFraction", clocks]),
        (block.setShiftDecimal, (theta, [1.0]), ["fmi3SetShiftDecimal", clocks]),
        (block.setShiftFraction, (theta, []), ["fmi3SetShiftFraction", clocks]),
        (block.evaluateDiscreteStates, (), ["providesEvaluateDiscreteStates is false"]),
        (block.getNumberOfVariableDependencies, (0,), [dependencies]),
        (block.getVariableDependencies, (0,), [dependencies]),
        (block.setInputDerivatives, ([(theta[0], 1)], [1.0]), ["FMI 3.0 has no derivatives of inputs"]),
    ]:
        refused(method, *arguments, words=words)
    assert block.getFMUState() == before
    initialize(block)
    for time, size in [(0.0, float("nan")), (0.0, -1.0), (0.0, float("inf")), (5.0, 1.0), (float("nan"), 1.0)]:
        refused(block.doStep, time, size, words=["fmi3DoStep", " = "])
    refused(block.getOutputDerivatives, [(theta[0], 2**32 - 1)], words=["fmi3GetOutputDerivatives"])
    assert block.doStep(0.0, 1.0)[3] == 1.0


def test_the_package_has_components_manifests_and_licences(wasm, fmu3):
    with zipfile.ZipFile(wasm) as archive, zipfile.ZipFile(fmu3) as other:
        files = {name: archive.read(name) for name in archive.namelist()}
        native = other.read("modelDescription.xml")
        assert not any("wasi" in name for name in other.namelist())
    description = files["modelDescription.xml"]
    root = ElementTree.fromstring(description)
    identifiers = [root.find(kind).get("modelIdentifier") for kind in ("CoSimulation", "ModelExchange")]
    binaries = {f"binaries/wasm32-wasip2/{identifier}.wasm" for identifier in identifiers}
    assert len(binaries) == 2 and binaries == {name for name in files if name.startswith("binaries/")}
    # The preamble of a component, which is not that of a core module.
    assert {files[name][:8] for name in binaries} == {b"\0asm\x0d\0\x01\0"}

    def undated(text):
        before, after = text.split(b'generationDateAndTime="')
        return before + after.split(b'"', 1)[1]

    assert undated(description.replace(*[identifier.encode() for identifier in reversed(identifiers)])) == undated(native)
    namespace = "{http://fmi-standard.org/fmi-ls-manifest}"
    for name in ("manifest.xml", "fmi-ls-manifest.xml"):
        manifest = ElementTree.fromstring(files[f"extra/org.modelica.fmi-ls-wasm/{name}"])
        assert manifest.tag == f"{namespace}fmiLayeredStandardManifest"
        assert manifest.get(f"{namespace}fmi-ls-name") == "org.modelica.fmi-ls-wasm"
        assert manifest.get(f"{namespace}fmi-ls-description") and manifest.get(f"{namespace}fmi-ls-version")
    for linked in ("wit-bindgen", "wasi-libc", "libm"):
        assert linked in files["documentation/licenses/license.txt"].decode()
        assert linked in files["documentation/sbom.cdx.json"].decode()
    assert "documentation/licenses/wasi-libc/COPYING.txt" in files
