"""The reference cases without a record -> commands for host.c; its output -> a check against the trajectories.

cases.py commands MODEL_DESCRIPTION > COMMANDS
cases.py check PRINTED MODEL_DESCRIPTION
cases.py same PRINTED_BY_FMI_2 PRINTED_BY_FMI_3 MODEL_DESCRIPTION

The description says which block it is. At a relative tolerance of 1e-10 the rotation is within 1e-7 of the slenderness angle, as in
tests/abi/reference.rs and tests/python/test_in_space.py.
"""

import csv
import json
import math
import struct
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

TESTS = Path(__file__).parent.parent
TOLERANCE = 1e-10
BOUND = 1e-7
# Statuses of fmi2DoStep: a run that ends early returns fmi2Discard.
STATUS = {"completed": 0, "end": 0, "separated": 2, "overturned": 2}


def bits(value):
    return struct.pack(">d", value).hex()


def value(text):
    return struct.unpack(">d", bytes.fromhex(text))[0]


class Plane:
    """The planar block: its reference cases, and the start values of one."""

    FOLDER = TESTS / "reference"
    ROTATIONS = ["theta"]
    INPUTS = ["a_gx", "a_gz", "F_x", "F_z", "M_y"]
    # Of a block under inputs that change.
    CHANGES = {"mass": 10.0, "on_separation": 3, "epsilon": 0.3}

    @staticmethod
    def has(case):
        return all(case.get(axis, {}).get("kind") != "record" for axis in ("a_gx", "a_gz"))

    @staticmethod
    def alpha(case):
        return case["alpha"]

    @staticmethod
    def parameters(case):
        pulse = case["a_gx"]
        shape = {"sine": 2, "cosine": 3}.get(pulse.get("kind"), 1)
        initial = case.get("initial", {})
        return {
            "dimensionless.alpha": case["alpha"],
            "dimensionless.p": case["p"],
            "dimensionless.eta": case.get("eta", 1.0),
            "dimensionless.xi_v": case["xi_v"],
            "mass": case.get("M", 1.0),
            "gamma": case.get("gamma", 3.0),
            "epsilon": case["epsilon"],
            "g": case["g"],
            "foundation": 2 if case.get("foundation") == "rigid" else 1,
            "pulse.shape": shape,
            "pulse.amplitude": pulse.get("a_p", 0.0),
            "pulse.period": math.tau / pulse["omega_p"] if shape != 1 else 1.0,
            "initial.theta": initial.get("theta", 0.0),
            "initial.theta_dot": initial.get("theta_dot", 0.0),
            "initial.settled": int("theta" in initial),
        }


class Space:
    """The block in space, likewise."""

    FOLDER = TESTS / "reference_space"
    ROTATIONS = ["tilt_x", "tilt_y", "twist"]
    INPUTS = ["a_gx", "a_gy", "a_gz", "F_x", "F_y", "F_z", "M_x", "M_y", "M_z"]
    CHANGES = {"mass": 10.0, "friction": 0.4, "eccentricity_x": 0.02}

    @staticmethod
    def has(case):
        """Whether it is a rectangle or a circle in the middle, under no motion or one sine."""
        x, y, z = (case["excitation"][f"a_g{axis}"] for axis in "xyz")
        one = x is None or (y is not None and x["kind"] == "sine" and (x["omega"], x["start"]) == (y["omega"], y["start"]))
        return case["parameters"]["base"] != "List" and z is None and one

    @staticmethod
    def alpha(case):
        return case["numbers"]["alpha"]

    @staticmethod
    def parameters(case):
        given, initial = case["parameters"], case["initial"]["given"]
        x, y = case["excitation"]["a_gx"], case["excitation"]["a_gy"]
        pulse = {}
        if x:
            pulse = {"pulse.shape": 2, "pulse.amplitude": math.hypot(x["a"], y["a"]), "pulse.azimuth": math.atan2(y["a"], x["a"]),
                     "pulse.period": math.tau / x["omega"]}
        omega = dict(zip(("initial.omega_x", "initial.omega_y", "initial.omega_z"), initial.get("omega", ())))
        return {
            "base": {"Rectangle": 1, "Circle": 2}[given["base"]],
            **({"feet": given["feet"]} if given["base"] == "Circle" else {"dimensionless.depth_ratio": given.get("depth_ratio", 1.0)}),
            "mass": case["numbers"]["M"],
            "friction": given["friction"],
            "kappa": given["kappa"],
            **{f"dimensionless.{name}": given[name] for name in ("alpha", "p", "eta", "xi_v")},
            "initial.tilt_x": initial.get("tilt_x", 0.0),
            "initial.tilt_y": initial.get("tilt_y", 0.0),
            **omega,
            **pulse,
        }


def described(path):
    """The description, and its block."""
    root = ElementTree.parse(path).getroot()
    return root, {"RockingBlock": Plane, "RockingBlockInSpace": Space}[root.get("modelName")]


def cases(block):
    return [case for case in json.loads((block.FOLDER / "cases.json").read_text()) if block.has(case)]


def rows(block, case):
    with open(block.FOLDER / f"{case['name']}.csv", newline="") as file:
        return list(csv.DictReader(file))


def asked(case):
    """The duration of a case (s)."""
    return case["t_end"] if "t_end" in case else case["t_asked"]


# Names of the types in host.c and host3.c.
KINDS = {"Real": "real", "Integer": "integer", "Boolean": "boolean", "String": "string"}
KINDS |= {"Float64": "real", "Int32": "integer", "UInt64": "size", "Enumeration": "choice"}


def commands(path):
    root, block = described(path)
    fmi3 = root.get("fmiVersion") == "3.0"
    directional = root.find("CoSimulation").get("providesDirectionalDerivatives" if fmi3 else "providesDirectionalDerivative")
    print("guid", root.get("instantiationToken" if fmi3 else "guid"))
    variables = {}
    for variable in root.find("ModelVariables"):
        name, reference, causality = (variable.get(key) for key in ("name", "valueReference", "causality"))
        kind = KINDS[variable.tag if fmi3 else variable[0].tag]
        variables[name] = (reference, kind)
        # The arrays of results.
        if fmi3 and variable.find("Dimension") is not None:
            continue
        if causality in ("output", "calculatedParameter"):
            print("list", kind, reference)
        if kind == "real" and (causality == "output" or causality == "input" and directional == "true"):
            print("list", causality, reference)

    def put(name, given):
        reference, kind = variables[name]
        print(kind, reference, bits(given) if kind == "real" else given)

    def run(name, given, step, steps, before=lambda i: None):
        print("case", name)
        for parameter, given in given.items():
            put(parameter, given)
        before(0)
        print("start", bits(TOLERANCE))
        for i in range(steps):
            before(i)
            print("step", bits(i * step), bits((i + 1) * step - i * step))
            if i % 50 == 0:
                print("derivatives")
            if i % 100 == 50:
                print("state")
        print("end")

    for case in cases(block):
        run(case["name"], block.parameters(case), case["dt"], round(asked(case) / case["dt"]))

    if fmi3:
        return

    # Ground motions and loads that change in every step, unlike in the cases above. They are compared only with the
    # other targets. FMI 3.0 has no input derivatives.
    def ramps(i):
        for j, name in enumerate(block.INPUTS):
            at = [2.0 * math.sin(0.11 * (k + 7 * j)) * math.exp(-0.002 * k) for k in (i, i + 1)]
            print("ramp", variables[name][0], bits(at[0]), bits((at[1] - at[0]) / 0.01))

    run("ramps", block.CHANGES, 0.01, 1000, ramps)


def check(path, description):
    root, block = described(description)
    read = [
        variable.get("name")
        for variable in root.find("ModelVariables")
        if variable[0].tag == "Real" and variable.get("causality") in ("output", "calculatedParameter")
    ]
    places = [1 + read.index(rotation) for rotation in block.ROTATIONS]
    printed, ended, name = {}, {}, None
    for line in Path(path).read_text(encoding="utf-8").splitlines():
        words = line.split()
        if words[0] == "case":
            name = words[1]
            printed[name] = []
        elif words[0] in ("start", "step"):
            printed[name].append([value(words[place]) for place in places])
        elif words[0] == "end":
            ended[name] = (int(words[1]), value(words[2]))
    worst = 0.0
    for case in cases(block):
        name = case["name"]
        if name not in ended:
            sys.exit(f"error: {path}: {name} does not reach its end")
        status, time = ended[name]
        if status != STATUS[case["end"]] or abs(time - min(case["t_final"], asked(case))) > 1e-6:
            expected = f"{case['end']} at {case['t_final']} s"
            sys.exit(f"error: {path}: {name} ends with status {status} at {time} s; expected {expected}")
        expected = [[float(row[rotation]) for rotation in block.ROTATIONS] for row in rows(block, case)]
        # The last step of a run that ended is shorter than a row's.
        pairs = zip(printed[name][: len(printed[name]) - (status != 0)], expected)
        off = max(abs(a - b) for found, row in pairs for a, b in zip(found, row)) / block.alpha(case)
        worst = max(worst, off)
        if not off <= BOUND:
            sys.exit(f"error: {path}: {name}: rotation is {off:.1e} alpha off; expected at most {BOUND:.0e}")
    print(f"{len(cases(block))} reference cases, rotation at most {worst:.1e} alpha off, and 1 case of inputs that change")


def same(one, other, description):
    """Compares the outputs of both versions, except for states and logs, which differ in form."""

    def lines(path):
        text = Path(path).read_text(encoding="utf-8").split("case ramps\n")[0]
        return [line for line in text.splitlines() if not line.startswith(("log ", "state "))]

    one, other = lines(one), lines(other)
    ends, expected = sum(line.startswith("end ") for line in one), len(cases(described(description)[1]))
    if ends != expected:
        sys.exit(f"error: {ends} cases of FMI 2.0 reach their ends; expected {expected}")
    if one != other:
        place = next((i for i, (a, b) in enumerate(zip(one, other)) if a != b), min(len(one), len(other)))
        sys.exit(f"error: FMI 3.0 gives other bits than FMI 2.0 from line {place + 1} on, of {len(one)} and {len(other)}")
    print(f"the same {len(one)} lines by FMI 2.0 and FMI 3.0")


match sys.argv[1:]:
    case ["commands", description]:
        commands(description)
    case ["check", printed, description]:
        check(printed, description)
    case ["same", one, other, description]:
        same(one, other, description)
    case _:
        sys.exit(__doc__)
