"""Model Exchange of the block in space: CVode has the events of Co-Simulation, foot by foot."""

import random
import re
import warnings
from collections import defaultdict

import numpy as np
import pytest
from fmpy import simulate_fmu

from test_in_space import in_space, in_space3  # noqa: F401: fixtures

COUNTS = ["events.lift_offs", "events.landings", "events.slides", "events.sticks"]


def random_case(seed):
    """A block under a pulse, and the duration of its run."""
    draw = random.Random(seed)
    alpha, p = draw.uniform(0.1, 0.35), draw.uniform(1, 4)
    period = 2 * np.pi / p * draw.uniform(0.2, 0.8)
    values = {
        "dimensionless.alpha": alpha,
        "dimensionless.p": p,
        "dimensionless.eta": 10 ** draw.uniform(1, 2),
        "dimensionless.xi_v": draw.uniform(0.05, 0.6),
        "dimensionless.depth_ratio": draw.uniform(0.5, 2),
        "friction": draw.choice([10.0, draw.uniform(0.1, 1.0)]),
        "kappa": draw.uniform(0.5, 2),
        "eccentricity_y": draw.uniform(-0.2, 0.2) * alpha * 9.81 * 0.75 / p**2,
        "pulse.shape": draw.choice([2, 3, 4, 5]),
        "pulse.amplitude": 9.81 * np.tan(alpha) * draw.uniform(1.1, 3),
        "pulse.period": period,
        "pulse.azimuth": draw.uniform(0, 2 * np.pi),
        "on_separation": draw.choice([1, 2, 3, 3]),
    }
    return values, 2 / p + period


def events(fmu, interface, values, end, tolerance):
    """The events of each foot, with their times, and the outputs."""
    logged = defaultdict(list)

    def log(*arguments):
        # Versions differ in what precedes the message.
        message = arguments[-1]
        message = message.decode() if isinstance(message, bytes) else message
        found = re.match(r"t = (\S+) s: (.*?)(\d*)$", message)
        if found:
            logged[found[3]].append((found[2], float(found[1])))

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        result = simulate_fmu(
            fmu,
            fmi_type=interface,
            solver="CVode",
            start_values=values,
            stop_time=end,
            output_interval=end / 100,
            relative_tolerance=tolerance,
            output=["tilt"] + COUNTS,
            logger=log,
            debug_logging=True,
            timeout=300,
        )
    return logged, result


def compare(fmu, seed):
    """Returns the largest differences of times (s) and of tilts (alpha), or None if the sequences differ."""
    values, end = random_case(seed)
    inside, ours = events(fmu, "CoSimulation", values, end, 1e-12)
    outside, theirs = events(fmu, "ModelExchange", values, end, 1e-9)
    kinds = lambda feet: {foot: [kind for kind, _ in events] for foot, events in feet.items()}
    if kinds(inside) != kinds(outside):
        return None
    times = [abs(a[1] - b[1]) for foot in inside for a, b in zip(inside[foot], outside[foot], strict=True)]
    # Rows at events stand between those of the steps.
    last = min(ours["time"][-1], theirs["time"][-1])
    grid = ours["time"][ours["time"] <= last]
    tilts = np.abs(np.interp(grid, theirs["time"], theirs["tilt"]) - ours["tilt"][: len(grid)])
    return max(times, default=0), tilts.max() / values["dimensionless.alpha"], len(times)


def follows(fmu, seed):
    found = compare(fmu, seed)
    assert found is not None, "other events"
    print(f"seed {seed}: {found[2]} events, {found[0]:.1e} s, {found[1]:.1e} alpha")
    assert found[0] < 1e-6 and found[1] < 1e-6


@pytest.mark.parametrize("seed", range(2))
def test_cvode_has_the_events_of_co_simulation(in_space, seed):  # noqa: F811
    follows(in_space, seed)


@pytest.mark.check
@pytest.mark.parametrize("seed", range(2, 50))
def test_cvode_has_the_events_of_co_simulation_in_many_cases(in_space3, seed):  # noqa: F811
    follows(in_space3.replace("-fmi3.fmu", ".fmu"), seed)
