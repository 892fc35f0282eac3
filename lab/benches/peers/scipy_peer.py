"""Solves a case with SciPy's solve_ivp, as an engineer would: DOP853 or LSODA, with events that end each regime's run.

    scipy_peer.py CASE METHOD TOLERANCE time SECONDS    repeats the run for so much CPU time
    scipy_peer.py CASE METHOD TOLERANCE trace           the rotation at multiples of the case's dt

METHOD is DOP853 or LSODA; for records followed by -restart (stop and restart at each sample) or -through (step over the
kinks). Prints one line of JSON. State: theta, theta_dot, v, v_dot, and on the rigid base the first two. Forces are per
mass. The arithmetic is Python's own, which is faster than NumPy's for single numbers.
"""

import json
import sys
import time
from math import asin, cos, exp, pi, sin, tan
from pathlib import Path
from types import SimpleNamespace

import cases
import numpy as np
from scipy.integrate import solve_ivp

SIGNS = (1.0, -1.0)  # of L and R


def make_block(values):
    """Returns the parameters in the equations; K and C per mass."""
    block = SimpleNamespace(**values)
    block.r0 = block.gamma / (1.0 + block.gamma) * block.gravity / block.p**2
    block.i0 = block.r0**2 / block.gamma
    block.b, block.h = block.r0 * sin(block.alpha), block.r0 * cos(block.alpha)
    block.restitution = (
        1.0 + block.gamma * block.epsilon + (1.0 - block.epsilon) * block.gamma * cos(2.0 * block.alpha)
    ) / (1.0 + block.gamma)
    if not block.rigid:
        block.omega_v = block.eta * block.p
        block.k, block.c = 0.5 * block.omega_v**2, block.xi_v * block.omega_v
        block.delta_s = block.gravity / block.omega_v**2
    return block


# Equations of motion of a block under a ground acceleration over time.


def full_contact(block, ground):
    """Eqs. (7)-(10)."""
    b, h, i0, k, c, delta_s, gravity = block.b, block.h, block.i0, block.k, block.c, block.delta_s, block.gravity

    def rates(t, y):
        theta, theta_dot, v, v_dot = y.tolist()
        s, co = sin(theta), cos(theta)
        reach_l, reach_r = b * co + h * s, b * co - h * s
        n_l = k * (delta_s - (v + h - (h * co - b * s))) - c * (v_dot + reach_l * theta_dot)
        n_r = k * (delta_s - (v + h - (h * co + b * s))) - c * (v_dot - reach_r * theta_dot)
        arm = h * co
        moment = n_l * reach_l - n_r * reach_r - arm * (ground(t) - h * s * theta_dot * theta_dot)
        return theta_dot, moment / (i0 + arm * arm), v_dot, n_l + n_r - gravity

    return rates


def on_corner(block, ground, sign):
    """Eqs. (11)-(13)."""
    b, h, i0, k, c, delta_s, gravity = block.b, block.h, block.i0, block.k, block.c, block.delta_s, block.gravity

    def rates(t, y):
        theta, theta_dot, v, v_dot = y.tolist()
        s, co = sin(theta), cos(theta)
        reach, height = b * co + sign * h * s, h * co - sign * b * s
        n = k * (delta_s - (v + h - height)) - c * (v_dot + sign * reach * theta_dot)
        moment = sign * n * reach - height * (ground(t) - sign * reach * theta_dot * theta_dot)
        return theta_dot, moment / (i0 + height * height), v_dot, n - gravity

    return rates


def on_rigid_base(block, ground, tilt):
    """Housner's block."""
    alpha, p2, gravity = tilt * block.alpha, block.p**2, block.gravity

    def rates(t, y):
        theta, theta_dot = y.tolist()
        return theta_dot, -p2 * (sin(alpha - theta) + cos(alpha - theta) * ground(t) / gravity)

    return rates


class Run:
    """One run: touching corners, supports of the other corners, counters."""

    def __init__(self, block, samples, method, tolerance, trace):
        self.block, self.samples, self.trace = block, samples, trace
        self.method, _, at_samples = method.partition("-")
        self.through = at_samples == "through"
        self.tolerance = tolerance
        velocity = block.r0 * block.alpha * block.p
        # A height counts as the velocity that the supports would give it.
        scales = [block.alpha, block.alpha * block.p]
        scales += [] if block.rigid else [velocity / block.omega_v, velocity]
        self.atol = tolerance * np.array(scales)
        self.touching = [True, True]
        self.creep = [(0.0, 0.0), (0.0, 0.0)]
        self.tilt = -1.0
        self.theta = []
        self.rhs = self.steps = self.events = 0

    # The ground.

    def piece(self, t, sample):
        """Returns the ground acceleration from `t` on, and the next kink at which to stop."""
        block, samples = self.block, self.samples
        if block.shape:
            a_p, omega, end = block.a_p, block.omega_p, 2.0 * pi / block.omega_p
            if t >= end:
                return lambda t: 0.0, block.t_end
            wave = sin if block.shape == 1 else cos
            return lambda t: a_p * wave(omega * t), end
        if sample + 1 >= len(samples):
            return lambda t: 0.0, block.t_end
        dt = block.record_dt
        if self.through:
            last = len(samples) - 1

            def record(t):
                x = t / dt
                i = int(x)
                return samples[i] + (x - i) * (samples[i + 1] - samples[i]) if i < last else 0.0

            return record, block.t_end
        t0, a0, slope = sample * dt, samples[sample], (samples[sample + 1] - samples[sample]) / dt
        return lambda t: a0 + slope * (t - t0), min((sample + 1) * dt, block.t_end)

    # Corners and supports.

    def arms(self, i, theta):
        """Returns R0 sin(phi) and R0 cos(phi), phi = alpha + s theta."""
        b, h, s, sine, cosine = self.block.b, self.block.h, SIGNS[i], sin(theta), cos(theta)
        return b * cosine + s * h * sine, h * cosine - s * b * sine

    def corner(self, i, y):
        """Returns height and rate of a corner."""
        reach, height = self.arms(i, y[0])
        return y[2] + self.block.h - height, y[3] + SIGNS[i] * reach * y[1]

    def reaction(self, i, y):
        height, rate = self.corner(i, y)
        return self.block.k * (self.block.delta_s - height) - self.block.c * rate

    def lift(self, i, t, y):
        self.touching[i] = False
        self.creep[i] = self.block.delta_s - self.corner(i, y)[0], t

    def surface(self, i):
        """Returns the function whose fall through zero ends the regime at corner `i`."""
        block, sign = self.block, SIGNS[i]
        b, h, k, c, delta_s = block.b, block.h, block.k, block.c, block.delta_s
        if self.touching[i]:

            def fall(t, y):
                theta, theta_dot, v, v_dot = y.tolist()[:4]
                s, co = sin(theta), cos(theta)
                rate = v_dot + sign * (b * co + sign * h * s) * theta_dot
                return k * (delta_s - (v + h - (h * co - sign * b * s))) - c * rate
        else:
            (depth, since), decay = self.creep[i], k / c

            def fall(t, y):
                theta, _, v = y.tolist()[:3]
                height = v + h - (h * cos(theta) - sign * b * sin(theta))
                return height - delta_s + depth * exp(-(t - since) * decay)

        fall.terminal, fall.direction = True, -1
        return fall

    def surfaces(self):
        """Returns the functions that end the regime."""
        if not self.block.rigid:
            return [self.surface(0), self.surface(1)]
        tilt = self.tilt

        def fall(t, y):
            return tilt * y[0]

        fall.terminal, fall.direction = True, -1
        return [fall]

    def equations(self, ground):
        if self.block.rigid:
            return on_rigid_base(self.block, ground, self.tilt)
        match self.touching:
            case [True, True]:
                return full_contact(self.block, ground)
            case [True, False]:
                return on_corner(self.block, ground, 1.0)
            case [False, True]:
                return on_corner(self.block, ground, -1.0)
        raise RuntimeError("complete separation")

    def settle(self, t, y, ground):
        """Releases corners whose supports would have to pull, now or in the next moment."""
        block, rounding = self.block, 1e-12 * self.block.gravity
        again = True
        while again:
            again = False
            _, theta_ddot, _, v_ddot = self.equations(ground)(t, np.array(y))[:4]
            for i in (0, 1):
                if not self.touching[i]:
                    continue
                reach, height = self.arms(i, y[0])
                acceleration = v_ddot + SIGNS[i] * reach * theta_ddot + height * y[1] ** 2
                n, rate = self.reaction(i, y), self.corner(i, y)[1]
                if n < -rounding or (n <= rounding and -block.k * rate - block.c * acceleration < 0.0):
                    self.lift(i, t, y)
                    again = True
                    break

    def land(self, i, y):
        """Applies a landing, eqs. (14)-(19) and their mirror image."""
        self.touching[i] = True
        if self.corner(i, y)[1] >= 0.0:
            return
        block, s, e = self.block, SIGNS[i], self.block.epsilon
        (reach, height), (_, before) = self.arms(i, y[0]), self.arms(1 - i, y[0])
        a, bb, pp = block.h * cos(y[0]) * height, reach * reach, before * height
        d = block.i0 + a + bb
        _, theta_dot, _, v_dot = y[:4]
        y[3] = (
            (e * (block.i0 + a) + bb) * v_dot + s * ((e - 1.0) * block.i0 + e * a - pp) * reach * theta_dot
        ) / d
        y[1] = (s * (e - 1.0) * reach * v_dot + (block.i0 + e * bb + pp) * theta_dot) / d

    def start(self):
        """Returns time and state of the start; on the rigid base, the start of rocking under a sine."""
        block = self.block
        if block.rigid:
            return asin(block.gravity * tan(block.alpha) / block.a_p) / block.omega_p, [0.0, 0.0]
        middle = max(abs(block.b * sin(block.theta)) - block.delta_s, 0.0)
        v = middle - block.h * (1.0 - cos(block.theta)) if block.settled else 0.0
        y = [block.theta, block.theta_dot, v, 0.0]
        self.touching = [self.corner(i, y)[0] <= block.delta_s for i in (0, 1)]
        return 0.0, y

    def take_rows(self, t, until, solution, at_rest=None):
        """Records the rotation at the rows from `t` to `until`."""
        block = self.block
        while (row := len(self.theta)) <= round(block.t_end / block.dt) and row * block.dt <= until + 1e-12:
            self.theta.append(at_rest if solution is None else float(solution(min(row * block.dt, until))[0]))

    def go(self):
        block = self.block
        t, y = self.start()
        sample, first_step = 0, None
        ground, stop = self.piece(t, sample)
        if not block.rigid:
            self.settle(t, y, ground)
        if self.trace:
            self.take_rows(0.0, t, None, y[0])
        while t < block.t_end:
            if first_step is not None:
                first_step = min(first_step, stop - t)
            solution = solve_ivp(
                self.equations(ground), (t, stop), np.array(y), method=self.method, rtol=self.tolerance,
                atol=self.atol, events=self.surfaces(), dense_output=self.trace, first_step=first_step,
            )
            if solution.status < 0:
                raise RuntimeError(solution.message)
            self.rhs += solution.nfev
            self.steps += len(solution.t) - 1
            if self.trace:
                self.take_rows(t, solution.t[-1], solution.sol)
            if self.method == "DOP853":
                # If one or two steps sufficed, a longer one may too.
                longest = float(np.diff(solution.t).max())
                first_step = (2.0 * longest if len(solution.t) < 4 else longest) or None
            t, y = float(solution.t[-1]), solution.y[:, -1].tolist()
            if solution.status == 1:
                self.events += 1
                if self.method == "DOP853" and not block.rigid:
                    # A gap that opens may close again soon: a short step sees it open.
                    first_step = 0.05 / block.omega_v
                self.apply(solution.t_events, t, y, ground)
            else:
                sample += 1
                ground, stop = self.piece(t, sample)

    def apply(self, found, t, y, ground):
        if self.block.rigid:
            y[0], y[1] = 0.0, self.block.restitution * y[1]
            self.tilt = -self.tilt
            return
        for i in (0, 1):
            if len(found[i]) and self.touching[i]:
                self.lift(i, t, y)
            elif len(found[i]):
                self.land(i, y)
        self.settle(t, y, ground)


def main(kind=Run):
    """Answers the command line with runs of this kind."""
    path, method, tolerance, task, *rest = sys.argv[1:]
    values, samples = cases.read(Path(path))
    block = make_block(values)

    def run(trace):
        run = kind(block, samples, method, float(tolerance), trace)
        run.go()
        return run

    if task == "trace":
        print(json.dumps({"theta": run(True).theta}))
        return
    kind(block, samples, method, float(tolerance), False)
    # The first run also fills SciPy's caches; a long one is its own warm-up.
    before = time.process_time()
    done = run(False)
    used, repeats = time.process_time() - before, 1
    if used < 1.0:
        before, used, repeats = time.process_time(), 0.0, 0
        while used < float(rest[0]) or repeats == 0:
            done = run(False)
            repeats += 1
            used = time.process_time() - before
    print(json.dumps({"cpu": used / repeats, "rhs": done.rhs, "steps": done.steps, "events": done.events}))


if __name__ == "__main__":
    main()
