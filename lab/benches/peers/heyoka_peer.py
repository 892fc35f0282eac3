"""Solves a case with heyoka, as an engineer would: an adaptive Taylor integrator for each regime, whose terminal events end its run.

    heyoka_peer.py CASE METHOD TOLERANCE time SECONDS | trace      as scipy_peer.py; METHOD is taylor, for records taylor-stop

Each coefficient of a series counts as a call of the equations of motion. LLVM compiles the integrators before the timing starts.
"""

from math import pi

import heyoka as hy
import numpy as np
import scipy_peer
from scipy_peer import SIGNS

# The parameters of an integrator: the ground acceleration a0 + slope (t - t0), or a0 as the amplitude of the pulse, and depth and beginning
# of the creep of both supports.
A0, SLOPE, T0, DEPTH, SINCE = 0, 1, 2, (3, 5), (4, 6)
# Time (s) after an event in which the same surface is not passed again.
NEAR = 1e-7
FULL, LEFT, RIGHT = (True, True), (True, False), (False, True)


def ground(block):
    """Returns the ground acceleration."""
    if not block.shape:
        return hy.par[A0] + hy.par[SLOPE] * (hy.time - hy.par[T0])
    wave = hy.sin if block.shape == 1 else hy.cos
    return hy.par[A0] * wave(block.omega_p * hy.time)


def rigid_integrator(block, tilt, tolerance):
    """Housner's block."""
    theta, theta_dot = hy.make_vars("theta", "theta_dot")
    phi = tilt * block.alpha - theta
    turning = -(block.p**2) * (hy.sin(phi) + hy.cos(phi) * ground(block) / block.gravity)
    equations = [(theta, theta_dot), (theta_dot, turning)]
    event = hy.t_event(tilt * theta, direction=hy.event_direction.negative)
    return hy.taylor_adaptive(equations, [0.0, 0.0], tol=tolerance, t_events=[event])


def integrator(block, touching, tolerance):
    """Eqs. (7)-(13): the block in full contact or on a corner, until a reaction or a gap falls through zero."""
    theta, theta_dot, v, v_dot = hy.make_vars("theta", "theta_dot", "v", "v_dot")
    b, h, k, c, delta_s = block.b, block.h, block.k, block.c, block.delta_s
    sine, cosine = hy.sin(theta), hy.cos(theta)
    reaches = [b * cosine + s * h * sine for s in SIGNS]
    heights = [h * cosine - s * b * sine for s in SIGNS]
    reactions = [
        k * (delta_s - (v + h - height)) - c * (v_dot + s * reach * theta_dot)
        for s, reach, height in zip(SIGNS, reaches, heights, strict=True)
    ]
    if touching == FULL:
        arm, centripetal = h * cosine, h * sine * theta_dot * theta_dot
        moment, upwards = reactions[0] * reaches[0] - reactions[1] * reaches[1], reactions[0] + reactions[1]
    else:
        i = 0 if touching == LEFT else 1
        arm, centripetal = heights[i], SIGNS[i] * reaches[i] * theta_dot * theta_dot
        moment, upwards = SIGNS[i] * reactions[i] * reaches[i], reactions[i]
    turning = (moment - arm * (ground(block) - centripetal)) / (block.i0 + arm * arm)
    events = []
    for i in (0, 1):
        creep = hy.par[DEPTH[i]] * hy.exp((hy.par[SINCE[i]] - hy.time) * (k / c))
        fall = reactions[i] if touching[i] else v + h - heights[i] - delta_s + creep
        events.append(hy.t_event(fall, direction=hy.event_direction.negative, cooldown=NEAR))
    equations = [(theta, theta_dot), (theta_dot, turning), (v, v_dot), (v_dot, upwards - block.gravity)]
    return hy.taylor_adaptive(equations, [0.0] * 4, tol=tolerance, t_events=events)


class Run(scipy_peer.Run):
    """One run; the integrators of all runs are made once."""

    def __init__(self, block, samples, method, tolerance, trace):
        super().__init__(block, samples, method, tolerance, trace)
        if not hasattr(block, "integrators"):
            if block.rigid:
                block.integrators = {tilt: rigid_integrator(block, tilt, tolerance) for tilt in SIGNS}
            else:
                block.integrators = {key: integrator(block, key, tolerance) for key in (FULL, LEFT, RIGHT)}

    def forcing(self, t, sample):
        """Returns a0, slope and t0 of the ground acceleration from `t` on."""
        block = self.block
        if block.shape:
            return (block.a_p if t < 2.0 * pi / block.omega_p else 0.0), 0.0, 0.0
        if sample + 1 >= len(self.samples):
            return 0.0, 0.0, 0.0
        a0, next_one = self.samples[sample : sample + 2]
        return a0, (next_one - a0) / block.record_dt, sample * block.record_dt

    def go(self):
        block = self.block
        t, y = self.start()
        sample = 0
        ground, stop = self.piece(t, sample)
        if not block.rigid:
            self.settle(t, y, ground)
        if self.trace:
            self.take_rows(0.0, t, None, y[0])
        begin, changed, begins, stops = t, set(), True, 0
        while t < block.t_end:
            solver = block.integrators[self.tilt if block.rigid else tuple(self.touching)]
            solver.time, solver.state[:] = t, y
            if begins:
                solver.reset_cooldowns()
            # An integrator has the parameters up to the last that it needs.
            solver.pars[:] = [*self.forcing(t, sample), *self.creep[0], *self.creep[1]][: len(solver.pars)]
            outcome, _, _, steps, output, _ = solver.propagate_until(stop, c_output=self.trace)
            self.rhs += steps * solver.order
            self.steps += steps
            if self.trace and output is not None:
                self.take_rows(t, solver.time, output)
            t, y = solver.time, solver.state.tolist()
            if outcome == hy.taylor_outcome.time_limit:
                sample += 1
                ground, stop = self.piece(t, sample)
                begin, changed, begins = t, set(), True
                continue
            # A terminal event that stops has the number -1 - index.
            index = -1 - int(outcome)
            if not 0 <= index < 2:
                raise RuntimeError(f"heyoka stopped with {outcome}")
            stops += 1
            if stops > 10000:
                raise RuntimeError(f"events without end at {t} s")
            if index in changed and t - begin < NEAR:
                # The gap that has just opened is zero there, and so is its rate: the solver mutes this event for a while.
                begins = False
                continue
            self.events += 1
            before = list(self.touching)
            self.apply([[t] if i == index else [] for i in (0, 1)], t, y, ground)
            begins = True
            begin, changed = t, {i for i in (0, 1) if block.rigid or self.touching[i] != before[i]}


if __name__ == "__main__":
    np.seterr(all="raise")
    scipy_peer.main(Run)
