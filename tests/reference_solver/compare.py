"""Recomputes a case and compares it with its stored trajectory."""

import csv
import json
from dataclasses import dataclass
from pathlib import Path

import friction
import ground
import plane
import stepping

TESTS = Path(__file__).resolve().parents[1]
FOLDERS = ["reference", "reference_more", "reference_links"]

# Changes within this time (s) are one instant, in which their order depends on the solver.
INSTANT = 1e-9
# A landing may leave a yielding link with a rate of next to nothing against its flow: it unloads, and yields again within this time (s).
PAUSE = 5e-6


@dataclass
class Result:
    """`theta` is the greatest difference of θ over α, `event` that of event times (s), `others` those of the other columns over their
    greatest value; `wrong` says where the events differ."""

    events: int
    wrong: str
    theta: float
    event: float
    others: dict


def cases(folder):
    return json.loads((TESTS / folder / "cases.json").read_text())


def model(case):
    if case.get("foundation") == "rigid":
        return plane.RigidBase(case)
    if case.keys() & {"friction", "eccentricity", "ties", "links"}:
        return friction.Block(case)
    return plane.OnSupports(case)


def recompute(case, times):
    """Returns the rows at the times, and the events."""
    block = model(case)
    rows = stepping.run(block, block.start, ground.pieces(case), times)
    return rows, block.log


def stored(case):
    """The case's events as (time, change), a change being a name, (regime before, regime after) or (regime, slip)."""
    return [
        (event[0], event[1] if isinstance(event[1], str) else (event[1]["regime"], event[1]["slip"]) if len(event) == 2 else (event[1], event[2]))
        for event in case["events"]
    ]


def instants(events):
    """Puts together the changes of an instant: the last regime, and the links that change. Leaves out pauses."""
    lasting = []
    for time, change in events:
        if isinstance(change, str) and change.startswith("yield"):
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


def compare(folder, case):
    with open(TESTS / folder / f"{case['name']}.csv") as file:
        expected = [{name: float(word) for name, word in row.items()} for row in csv.DictReader(file)]
    rows, log = recompute(case, [row["t"] for row in expected])
    event, wrong = 0.0, ""
    events, found = stored(case), log
    if folder != "reference":
        events, found = instants(events), instants(found)
    for known, new in zip(events, found):
        if known[1:] != new[1:]:
            wrong = f"{known} is {new}"
            break
        event = max(event, abs(known[0] - new[0]))
    if not wrong and len(events) != len(found):
        wrong = f"{len(events)} events are {len(found)}"
    if not wrong and len(rows) != len(expected):
        wrong = f"{len(expected)} rows are {len(rows)}"
    others = {}
    for name in expected[0].keys() - {"t", "theta"}:
        scale = max(abs(row[name]) for row in expected) or 1.0
        others[name] = max(abs(new[name] - row[name]) for new, row in zip(rows, expected)) / scale
    theta = max(abs(new["theta"] - row["theta"]) for new, row in zip(rows, expected)) / case["alpha"]
    return Result(len(events), wrong, theta, event, others)
