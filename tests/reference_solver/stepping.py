"""Integrates a model from event to event: DOP853 with dense output, events by Brent's method.

A model has
    ground                  the ground motion of the present piece: a function of t that gives a_gx and a_gz
    derivative(t, y)        of the state y, in the present regime
    watched()               name -> (function of t and y, rounding): the event occurs where the function falls through zero
    change(name, t, y)      changes the regime at an event and returns the state after it
    settle(t, y)            changes the regime if it cannot last, as where a pulse begins, and returns the state
    row(t, y)               outputs
    end                     None while the run goes on
"""

import numpy as np
from scipy.integrate import DOP853
from scipy.optimize import brentq, minimize_scalar

RELATIVE, ABSOLUTE = 1e-12, 1e-14

# Where each step is searched for events. A function that starts at zero may have fallen again soon after, so the first step after an
# event is searched ever more closely towards its start.
EVENLY = np.linspace(0, 1, 9)
CLOSELY = np.unique(np.concatenate([EVENLY, 0.5 ** np.arange(4, 48)]))


def run(model, y, pieces, times):
    """Runs a model from the state y over pieces (begin, end, ground motion) and returns the rows at the given times."""
    rows, ahead = [], list(times)
    for begin, end, model.ground in pieces:
        t, y, at_once = begin, model.settle(begin, y), 0
        if ahead and ahead[0] == t:
            rows.append(model.row(ahead.pop(0), y))
        while t < end and model.end is None:
            before = t
            t, y, event = stretch(model, t, y, end, ahead, rows)
            at_once = at_once + 1 if t == before else 0
            assert at_once < 20, f"no regime lasts at {t} s: {event} again and again"
            if event:
                y = model.change(event, t, y)
        if model.end is not None:
            break
    return rows


def stretch(model, t, y, end, ahead, rows):
    """Integrates to the first event, or to `end`; appends the rows of the times passed, and returns time, state and the event's name."""
    solver = DOP853(model.derivative, t, y, end, rtol=RELATIVE, atol=ABSOLUTE)
    watched, risen, fractions = model.watched(), set(), CLOSELY
    while solver.status == "running":
        failure = solver.step()
        assert solver.status != "failed", failure
        state = solver.dense_output()
        times = solver.t_old + (solver.t - solver.t_old) * fractions
        times[-1] = solver.t
        states = state(times).T.tolist()
        t, event, fractions = solver.t, None, EVENLY
        for name, (function, rounding) in watched.items():
            root = fall(name, function, rounding, times, states, state, risen)
            if root is not None and (event is None or root < t):
                t, event = root, name
        while ahead and ahead[0] <= t:
            rows.append(model.row(ahead[0], state(ahead.pop(0)).tolist()))
        if event or solver.status == "finished":
            return t, state(t).tolist(), event


def fall(name, function, rounding, times, states, state, risen):
    """Returns where a function falls through zero for the first time, after it has risen above rounding.

    One that begins at zero and falls without having risen does so where it falls below -rounding.
    """
    values = [function(t, y) for t, y in zip(times, states)]
    at = lambda t: function(t, state(t).tolist())
    for a, b, before, after in zip(times, times[1:], values, values[1:]):
        if before > rounding:
            risen.add(name)
        elif before < -rounding:
            return a
        level = 0.0 if name in risen else -rounding
        if before > level and after > level and name in risen and min(before, after) < max(values) - min(values):
            b = dip(at, a, b, before, after)
            after = at(b)
        if before > level >= after:
            return brentq(lambda t: at(t) - level, a, b, xtol=1e-15, rtol=1e-15)
    return None


def dip(function, a, b, before, after):
    """Returns where a function is least between a and b, if it falls at a and rises at b, otherwise b."""
    edge = 1e-5 * (b - a)
    if function(a + edge) < before and function(b - edge) < after:
        return minimize_scalar(function, bounds=(a, b), method="bounded", options={"xatol": 1e-9 * (b - a)}).x
    return b
