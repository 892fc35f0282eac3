"""The reference cases without a record -> commands for host.c; its output -> a check against the trajectories.

cases.py commands MODEL_DESCRIPTION > COMMANDS
cases.py check PRINTED MODEL_DESCRIPTION
cases.py same PRINTED_BY_FMI_2 PRINTED_BY_FMI_3

At a relative tolerance of 1e-10 the rotation is within 1e-7 of the slenderness angle, as in tests/abi/reference.rs.
"""

import csv
import json
import math
import struct
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

REFERENCE = Path(__file__).parent.parent / "reference"
TOLERANCE = 1e-10
BOUND = 1e-7
# Statuses of fmi2DoStep: a run that ends early returns fmi2Discard.
STATUS = {"completed": 0, "separated": 2, "overturned": 2}


def cases():
    cases = json.loads((REFERENCE / "cases.json").read_text())
    return [case for case in cases if all(case.get(axis, {}).get("kind") != "record" for axis in ("a_gx", "a_gz"))]


def rows(case):
    with open(REFERENCE / f"{case['name']}.csv", newline="") as file:
        return list(csv.DictReader(file))


def bits(value):
    return struct.pack(">d", value).hex()


def value(text):
    return struct.unpack(">d", bytes.fromhex(text))[0]


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


# Names of the types in host.c and host3.c.
KINDS = {"Real": "real", "Integer": "integer", "Boolean": "boolean", "String": "string"}
KINDS |= {"Float64": "real", "Int32": "integer", "UInt64": "size", "Enumeration": "choice"}


def commands(path):
    root = ElementTree.parse(path).getroot()
    fmi3 = root.get("fmiVersion") == "3.0"
    print("guid", root.get("instantiationToken" if fmi3 else "guid"))
    variables = {}
    for variable in root.find("ModelVariables"):
        name, reference, causality = (variable.get(key) for key in ("name", "valueReference", "causality"))
        kind = KINDS[variable.tag if fmi3 else variable[0].tag]
        variables[name] = (reference, kind)
        if causality in ("output", "calculatedParameter"):
            print("list", kind, reference)
        if causality in ("output", "input") and kind == "real":
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

    for case in cases():
        run(case["name"], parameters(case), case["dt"], round(case["t_end"] / case["dt"]))

    if fmi3:
        return

    # Ground motions and loads that change in every step, unlike in the cases above. They are compared only with the
    # other targets. FMI 3.0 has no input derivatives.
    def ramps(i):
        for j, name in enumerate(("a_gx", "a_gz", "F_x", "F_z", "M_y")):
            at = [2.0 * math.sin(0.11 * (k + 7 * j)) * math.exp(-0.002 * k) for k in (i, i + 1)]
            print("ramp", variables[name][0], bits(at[0]), bits((at[1] - at[0]) / 0.01))

    run("ramps", {"mass": 10.0, "on_separation": 3, "epsilon": 0.3}, 0.01, 1000, ramps)


def check(path, description):
    root = ElementTree.parse(description).getroot()
    read = [
        variable.get("name")
        for variable in root.find("ModelVariables")
        if variable[0].tag == "Real" and variable.get("causality") in ("output", "calculatedParameter")
    ]
    place = 1 + read.index("theta")
    printed, ended, name = {}, {}, None
    for line in Path(path).read_text(encoding="utf-8").splitlines():
        words = line.split()
        if words[0] == "case":
            name = words[1]
            printed[name] = []
        elif words[0] in ("start", "step"):
            printed[name].append(value(words[place]))
        elif words[0] == "end":
            ended[name] = (int(words[1]), value(words[2]))
    worst = 0.0
    for case in cases():
        name = case["name"]
        if name not in ended:
            sys.exit(f"error: {path}: {name} does not reach its end")
        status, time = ended[name]
        if status != STATUS[case["end"]] or abs(time - min(case["t_final"], case["t_end"])) > 1e-6:
            expected = f"{case['end']} at {case['t_final']} s"
            sys.exit(f"error: {path}: {name} ends with status {status} at {time} s; expected {expected}")
        expected = [float(row["theta"]) for row in rows(case)]
        # The last step of a run that ended is shorter than a row's.
        pairs = list(zip(printed[name][: len(printed[name]) - (status != 0)], expected))
        off = max(abs(a - b) for a, b in pairs) / case["alpha"]
        worst = max(worst, off)
        if not off <= BOUND:
            sys.exit(f"error: {path}: {name}: rotation is {off:.1e} alpha off; expected at most {BOUND:.0e}")
    print(f"{len(cases())} reference cases, rotation at most {worst:.1e} alpha off, and 1 case of inputs that change")


def same(one, other):
    """Compares the outputs of both versions, except for states and logs, which differ in form."""

    def lines(path):
        text = Path(path).read_text(encoding="utf-8").split("case ramps\n")[0]
        return [line for line in text.splitlines() if not line.startswith(("log ", "state "))]

    one, other = lines(one), lines(other)
    ends = sum(line.startswith("end ") for line in one)
    if ends != len(cases()):
        sys.exit(f"error: {ends} cases of FMI 2.0 reach their ends; expected {len(cases())}")
    if one != other:
        place = next((i for i, (a, b) in enumerate(zip(one, other)) if a != b), min(len(one), len(other)))
        sys.exit(f"error: FMI 3.0 gives other bits than FMI 2.0 from line {place + 1} on, of {len(one)} and {len(other)}")
    print(f"the same {len(one)} lines by FMI 2.0 and FMI 3.0")


match sys.argv[1:]:
    case ["commands", description]:
        commands(description)
    case ["check", printed, description]:
        check(printed, description)
    case ["same", one, other]:
        same(one, other)
    case _:
        sys.exit(__doc__)
