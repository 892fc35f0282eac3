"""Recomputes a case and compares it with its stored trajectory."""

import csv
import json
from dataclasses import dataclass
from pathlib import Path

import friction
import excitation
import plane
import space
import stepping

TESTS = Path(__file__).resolve().parents[1]
# Those in space, where they are there.
FOLDERS = [folder for folder in ("reference", "reference_more", "reference_links", "reference_space") if (TESTS / folder).exists()]

# Changes within this time (s) are one instant, in which their order depends on the solver.
INSTANT = 1e-9
# A landing may leave a yielding link with a rate of next to nothing against its flow: it unloads, and yields again within this time (s).
PAUSE = 5e-6


@dataclass
class Result:
    """The number of events, where they differ, and the greatest differences: of θ over α, of event times (s), and of the other columns
    over their greatest value, or 1e-4 (SI)."""

    events: int
    wrong: str
    theta: float
    times: float
    others: float


def cases(folder):
    return json.loads((TESTS / folder / "cases.json").read_text())


def model(case):
    if "numbers" in case:
        return space.BlockInSpace(case)
    if case.get("foundation") == "rigid":
        return plane.RigidBase(case)
    if case.keys() & {"friction", "eccentricity", "ties", "links"}:
        return friction.Block(case)
    return plane.OnSupports(case)


def recompute(case, times):
    """Returns the rows at the times, and the events."""
    block = model(case)
    if "numbers" in case:
        motions, end = [case["excitation"][name] for name in ("a_gx", "a_gy", "a_gz")], case["t_asked"]
    else:
        motions, end = [case.get(name) for name in ("a_gx", "a_gz")], case["t_end"]
    return stepping.run(block, block.start, excitation.pieces(motions, end), times), block.log


def stored(case):
    """The case's events: (time, change), the change (regime before, after) in the plane, (regime, slip) after it or a link's name beyond
    the paper, (kind, foot) in space."""
    if "numbers" in case:
        return [(event["t"], (event["kind"], event["foot"])) for event in case["events"]]
    events = []
    for time, *change in case["events"]:
        if len(change) == 2:
            events.append((time, tuple(change)))
        elif isinstance(change[0], dict):
            events.append((time, (change[0]["regime"], change[0]["slip"])))
        else:
            events.append((time, change[0]))
    return events


def instants(events):
    """Puts together the changes of an instant: the last regime, and the links that change. Leaves out pauses."""
    lasting = []
    for time, change in events:
        if of_link(change, "yield"):
            pause = [e for e in lasting if e[1] == change.replace("yield", "unload") and time - e[0] < PAUSE]
            if pause:
                lasting.remove(pause[-1])
                continue
        lasting.append((time, change))
    found = []
    for time, change in lasting:
        if not found or time - found[-1][1] > INSTANT:
            found.append([time, time, None, set()])
        found[-1][1] = time
        if isinstance(change, str):
            found[-1][3] ^= {change}
        else:
            found[-1][2] = change
    return [(first, regime, links) for first, _, regime, links in found]


def of_link(change, word):
    return isinstance(change, str) and change.startswith(word)


def compare(folder, case):
    """Raises excitation.Missing where the case's record is not at hand."""
    with open(TESTS / folder / f"{case['name']}.csv") as file:
        expected = [{name: float(word) for name, word in row.items()} for row in csv.DictReader(file)]
    rows, found = recompute(case, [row["t"] for row in expected])
    events = stored(case)
    if "numbers" in case:
        # Feet share events without an order: each has its own.
        events, found = (sorted(list_, key=lambda event: event[1][1]) for list_ in (events, found))
    elif folder != "reference":
        # Not all list where the spring of a limp tie goes slack.
        if not any(of_link(change, "slack") for _, change in events):
            found = [event for event in found if not of_link(event[1], "slack")]
        events, found = instants(events), instants(found)
    wrong = "" if len(rows) == len(expected) else f"{len(rows)} rows, expected {len(expected)}"
    if len(found) != len(events):
        wrong = f"{len(found)} events, expected {len(events)}"
    differs = next((pair for pair in zip(found, events) if pair[0][1:] != pair[1][1:]), None)
    if differs:
        wrong = f"event {differs[0]}, expected {differs[1]}"
    angles = {"theta", "tilt_x", "tilt_y", "twist"} & expected[0].keys()
    alpha = case["numbers"]["alpha"] if "numbers" in case else case["alpha"]
    theta = max(abs(new[name] - row[name]) for name in angles for new, row in zip(rows, expected)) / alpha
    times = max((abs(new[0] - known[0]) for new, known in zip(found, events)), default=0.0)
    others = 0.0
    for name in expected[0].keys() - angles - {"t"}:
        scale = max(1e-4, *(abs(row[name]) for row in expected))
        others = max(others, max(abs(new[name] - row[name]) for new, row in zip(rows, expected)) / scale)
    return Result(len(events), wrong, theta, times, others)
