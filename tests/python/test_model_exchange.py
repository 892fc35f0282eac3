"""Model Exchange: reference trajectories and random pulses, integrated by CVode."""

import json
import random
import re
import warnings
from pathlib import Path

import numpy as np
import pytest
from fmpy import simulate_fmu

ROOT = Path(__file__).resolve().parents[2]
CASES = {case["name"]: case for case in json.loads((ROOT / "tests/reference/cases.json").read_text())}
LINKS = {case["name"]: case for case in json.loads((ROOT / "tests/reference_links/cases.json").read_text())}
# Paths below the folder of records, and the time step where the header gives none.
RECORDS = {
    "rinaldi": ("paper/NGA_no_1063_RRS228.AT2", None),
    "erzincan": ("paper_derived/ERZ-NS_unrotated.AT2", None),
    "sylmar052": ("paper/SCS052.AT2", 0.005),
    "sylmar_up": ("paper/SCSUP.AT2", 0.005),
}
SHAPES = {"sine": 2, "cosine": 3}


def record(name):
    path, dt = RECORDS[name]
    path = ROOT.parent / "shared/records" / path
    if not path.exists():
        pytest.skip(f"the record {path.name} may not be redistributed and is not at hand")
    return str(path), {"record.dt": dt, "record.horizontal_unit": "g"} if dt else {}


def start_values(case):
    values = {f"dimensionless.{name}": case[name] for name in ("alpha", "p", "eta", "xi_v") if name in case}
    values |= {name: case[name] for name in ("gamma", "epsilon", "g") if name in case}
    values |= {f"initial.{name}": value for name, value in case.get("initial", {}).items()}
    if "M" in case:
        values["mass"] = case["M"]
    if case.get("foundation") == "rigid":
        values["foundation"] = 2
    for direction, path in (("a_gx", "horizontal"), ("a_gz", "vertical")):
        ground = case.get(direction, {})
        if ground.get("kind") in SHAPES:
            period = 2 * np.pi / ground["omega_p"]
            values |= {"pulse.shape": SHAPES[ground["kind"]], "pulse.amplitude": ground["a_p"], "pulse.period": period}
        elif ground.get("kind") == "record":
            file, settings = record(ground["record"])
            values |= {f"record.{path}": file, "record.scale": ground["scale"]} | settings
    return values


def solved(fmu, case, outputs, tolerance=1e-10):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return simulate_fmu(
            fmu,
            fmi_type="ModelExchange",
            solver="CVode",
            start_values=start_values(case),
            stop_time=case["t_end"],
            output_interval=case["dt"],
            relative_tolerance=tolerance,
            output=outputs,
        )


def lasting(times, regimes, end):
    """Returns the regimes that last longer than 1e-4 s. Rocking on the rigid base dies out in ever shorter ones, and the solver
    decides how many of those are separated."""
    durations = np.diff([*times, end])
    sequence = [int(regime) for regime, duration in zip(regimes, durations) if duration > 1e-4]
    return [regime for i, regime in enumerate(sequence) if i == 0 or regime != sequence[i - 1]]


@pytest.mark.parametrize("name", CASES)
def test_cvode_follows_the_reference(fmu, name):
    case = CASES[name]
    result = solved(fmu, case, ["theta", "regime", "events.impacts", "separated", "overturned"])
    expected = np.genfromtxt(ROOT / f"tests/reference/{name}.csv", delimiter=",", names=True)
    ended = case["end"] != "completed"
    last = case["t_final"] if ended else np.inf
    both = expected["t"][expected["t"] <= last]
    # fmpy outputs rows at events too; the last of several at one time is the one after the event.
    at = np.searchsorted(result["time"], both + 1e-9, side="right") - 1
    assert np.abs(result["time"][at] - both).max() < 1e-9
    error = np.abs(result["theta"][at] - expected["theta"][: len(both)]).max() / case["alpha"]
    print(f"{name}: {error:.1e} alpha")
    assert error < 1e-6
    end = case["t_final"]
    changes = [i for i in range(len(result)) if i == 0 or result["regime"][i] != result["regime"][i - 1]]
    seen = lasting(result["time"][changes], result["regime"][changes], end)
    events = [(0.0, expected["regime"][0]), *((time, after) for time, _, after in case["events"])]
    assert seen == lasting(*zip(*events), end)


LINK_KEYS = {"block": ("block_x", "block_z"), "ground": ("ground_x", "ground_z")}


def link_values(case):
    """Parameters of a case of tests/reference_links, and the names of its links in the order of the trajectory."""
    counts, names = {"tie": 0, "damper": 0}, []
    values = start_values(case) | {"friction": case.get("friction", 0.0), "eccentricity": case.get("eccentricity", 0.0)}
    for link in case["links"]:
        counts[link["kind"]] += 1
        name = f"{link['kind']}_{counts[link['kind']]}"
        names.append(name)
        for key, value in link.items():
            if key in LINK_KEYS:
                values |= {f"{name}.{part}": coordinate for part, coordinate in zip(LINK_KEYS[key], value, strict=True)}
            elif key != "kind":
                values[f"{name}.{key}"] = value
    return values, names


@pytest.mark.parametrize("name", LINKS)
def test_ties_and_dampers_that_yield(fmu, fmu3, name):
    """Both versions follow the reference in Co-Simulation, and CVode has the same events and plastic elongations."""
    case = LINKS[name]
    values, links = link_values(case)
    outputs = ["theta", *(f"{link}.plastic" for link in links)]
    expected = np.genfromtxt(ROOT / f"tests/reference_links/{name}.csv", delimiter=",", names=True)
    logged = {}
    for file, interface, tolerance, close in (
        (fmu, "CoSimulation", 1e-10, 1e-7),
        (fmu3, "CoSimulation", 1e-10, 1e-7),
        (fmu, "ModelExchange", 1e-9, 1e-5),
    ):
        found, result = events(file, interface, values, case["t_end"], tolerance, outputs, case["dt"])
        at = np.searchsorted(result["time"], expected["t"] + 1e-9, side="right") - 1
        error = np.abs(result["theta"][at] - expected["theta"]).max() / case["alpha"]
        size = 0.75 * case["g"] / case["p"] ** 2
        plastic = [np.abs(result[f"{link}.plastic"][at] - expected[f"plastic_{i}"]).max() for i, link in enumerate(links, 1)]
        print(f"{name} {interface}: {error:.1e} alpha, plastic elongations {max(plastic) / size:.1e} R0")
        assert error < close and max(plastic) < close * size
        logged[interface, file] = [event.split(",")[0] for event in found]
    inside = logged["CoSimulation", fmu]
    assert logged["CoSimulation", fmu3] == inside
    assert len(inside) > 8 and any("yields" in event for event in inside)
    assert logged["ModelExchange", fmu] == inside


def random_case(seed, mode):
    """A block under a pulse, and the duration of its run."""
    draw = random.Random(seed)
    alpha, p = draw.uniform(0.1, 0.35), draw.uniform(1, 4)
    period = 2 * np.pi / p * draw.uniform(0.1, 0.8)
    values = {
        "dimensionless.alpha": alpha,
        "dimensionless.p": p,
        "dimensionless.eta": 10 ** draw.uniform(1, 2),
        "dimensionless.xi_v": draw.uniform(0.02, 0.6),
        "pulse.shape": draw.choice([2, 3, 4, 5]),
        "pulse.amplitude": 9.81 * np.tan(alpha) * draw.uniform(1.05, 4),
        "pulse.period": period,
        "on_separation": {"Terminate": 1, "Hold": 2, "Fly": 3, "rigid": 3}[mode],
        "foundation": 2 if mode == "rigid" else 1,
    }
    return values, 3 / p + period


def events(fmu, interface, values, end, tolerance, outputs=("theta",), interval=None):
    """The events that the FMU logs, to the last impact of rocking that dies out, and its outputs."""
    logged = []

    def log(*arguments):
        # Versions differ in what precedes the message.
        message = arguments[-1]
        found = re.match(rb"t = (\S+) s: (.*)", message if isinstance(message, bytes) else message.encode())
        if found:
            logged.append(found[2].decode())

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        result = simulate_fmu(
            fmu,
            fmi_type=interface,
            solver="CVode",
            start_values=values,
            stop_time=end,
            output_interval=interval or end / 200,
            relative_tolerance=tolerance,
            output=list(outputs),
            logger=log,
            debug_logging=True,
            timeout=60,
        )
    return logged, result


@pytest.mark.parametrize("tolerance", [1e-9, 1e-6])
@pytest.mark.parametrize("mode", ["Terminate", "Hold", "Fly", "rigid"])
def test_cvode_has_the_events_of_co_simulation(fmu, mode, tolerance):
    for seed in range(6):
        values, end = random_case(seed, mode)
        inside, _ = events(fmu, "CoSimulation", values, end, 1e-12)
        outside, result = events(fmu, "ModelExchange", values, end, tolerance)
        assert outside == inside, seed


@pytest.mark.parametrize(
    "values",
    [
        dict(alpha=0.2747, p=2.2445, eta=9.5447, xi_v=1.0602, friction=0.3626, amplitude=5.583, period=0.3852),
        dict(alpha=0.346, p=0.886, eta=10.77, xi_v=0.423, friction=0.38, amplitude=6.5, period=1.14),
    ],
)
@pytest.mark.parametrize("version", [2, 3])
def test_few_events_where_both_feet_slide_to_opposite_sides(fmu, fmu3, version, values):
    """A held corner does not lift and land again and again, which would take an event each, in Model Exchange and in Event Mode."""
    dimensionless = {f"dimensionless.{name}": values[name] for name in ("alpha", "p", "eta", "xi_v")}
    pulse = {"pulse.shape": 2, "pulse.amplitude": values["amplitude"], "pulse.period": values["period"]}
    start = dimensionless | pulse | {"friction": values["friction"], "epsilon": 0.3, "on_separation": 3}
    event_mode = {"early_return_allowed": True, "use_event_mode": True} if version == 3 else {}
    ends = []
    for interface, options in [("ModelExchange", {"solver": "CVode", "relative_tolerance": 1e-10}), ("CoSimulation", event_mode)]:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            result = simulate_fmu(
                fmu3 if version == 3 else fmu,
                fmi_type=interface,
                start_values=start,
                stop_time=2.0,
                output_interval=0.01,
                output=["theta", "slip", "events.impacts", "events.liftoffs"],
                timeout=60,
                **options,
            )
        assert len(result) < 260, f"{interface}: {len(result)} rows instead of 201 and two for each event"
        ends.append(result[-1])
    solved, ours = ends
    assert list(solved)[3:] == list(ours)[3:]
    assert abs(solved["theta"] - ours["theta"]) < 1e-7 * values["alpha"]
    assert abs(solved["slip"] - ours["slip"]) < 1e-8
