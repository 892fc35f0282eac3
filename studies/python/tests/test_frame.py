"""A rocking frame against columns and a beam as separate bodies, integrated by SciPy with impacts by impulses."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import rocking_block as rb

G = 9.81


class Bodies:
    """Columns and beam, each with its own equations of Newton and Euler; forces and impulses are unknowns of one linear system.

    The columns are equal, so that one of them bears 1/N of the beam. Rotation and x are positive to the right.
    """

    def __init__(self, half_width, half_height, mass, inertia, beam):
        self.b, self.h, self.m, self.inertia, self.beam = half_width, half_height, mass, inertia, beam

    def arms(self, theta, right):
        """From the pivot at a base corner to the centre of a column and to the top corner that carries the beam."""
        to_center = np.array([-self.b if right else self.b, self.h])
        turn = np.array([[np.cos(theta), np.sin(theta)], [-np.sin(theta), np.cos(theta)]])
        return turn @ to_center, 2 * (turn @ to_center)

    def solve(self, theta, right, rate, load):
        """Solves for the acceleration (or rate) and the forces (or impulses) at base and top of a column.

        `rate` is that of the centripetal terms; `load` has the other terms of the three bodies' equations.
        """
        center, top = self.arms(theta, right)
        across = lambda arm: np.array([arm[1], -arm[0]])  # noqa: E731 - the velocity of a point per rate of rotation
        matrix, right_side = np.zeros((5, 5)), np.zeros(5)
        # Unknowns: rotation, force of the base on the column, force of the column on the beam.
        for i in range(2):
            matrix[i, 0] = self.m * across(center)[i]
            matrix[i, 1 + i], matrix[i, 3 + i] = -1, 1
            right_side[i] = load[0][i] + self.m * rate**2 * center[i]
            matrix[2 + i, 0] = self.beam * across(top)[i]
            matrix[2 + i, 3 + i] = -1
            right_side[2 + i] = load[1][i] + self.beam * rate**2 * top[i]
        # Moments about the centre, clockwise: the base acts at −center, the beam pushes back at top − center.
        moment = lambda arm: np.array([arm[1], -arm[0]])  # noqa: E731 - per horizontal and vertical force
        matrix[4, 0] = self.inertia
        matrix[4, 1:3] = -moment(-center)
        matrix[4, 3:5] = moment(top - center)
        right_side[4] = load[2]
        return np.linalg.solve(matrix, right_side)

    def forces(self, t, theta, rate, ground):
        pull = np.array([-ground(t), -G])
        return self.solve(theta, theta > 0, rate, (self.m * pull, self.beam * pull, 0.0))

    def after_impact(self, rate, right):
        """The rate after the pivots have changed to those of the other side, all at θ = 0."""
        before = [np.array([arm[1], -arm[0]]) * rate for arm in self.arms(0.0, right)]
        load = (self.m * before[0], self.beam * before[1], self.inertia * rate)
        return self.solve(0.0, not right, 0.0, load)[0]

    def run(self, theta, ground, until, times):
        """Rotation and forces at `times`, from rest at a rotation."""
        state, t, rows = [theta, 0.0], 0.0, []
        impact = lambda t, y: y[0]  # noqa: E731 - the event
        impact.terminal = True
        while t < until:
            right = state[0] > 0 or (state[0] == 0 and state[1] > 0)
            impact.direction = -1 if right else 1
            tilted = lambda y, right=right: max(y[0], 1e-300) if right else min(y[0], -1e-300)
            f = lambda t, y, tilted=tilted: [y[1], self.forces(t, tilted(y), y[1], ground)[0]]
            ends = [kink for kink in ground.kinks if kink > t + 1e-12] + [until]
            part = solve_ivp(f, (t, ends[0]), state, "DOP853", events=impact, dense_output=True, rtol=2.5e-14, atol=1e-15)
            for row in times[(times >= t) & (times < part.t[-1])]:
                y = part.sol(row)
                rows.append([y[0], *self.forces(row, y[0], y[1], ground)[1:]])
            t, state = part.t[-1], list(part.y[:, -1])
            if part.status == 1:
                state = [0.0, self.after_impact(state[1], right)]
        return np.array(rows).T


class Pulse:
    """One sine."""

    def __init__(self, amplitude, period):
        self.amplitude, self.period, self.kinks = amplitude, period, [period]

    def __call__(self, t):
        return self.amplitude * np.sin(2 * np.pi * t / self.period) if t < self.period else 0.0


@pytest.mark.parametrize(("ratio", "inertia"), [(0.0, None), (1.0, None), (4.0, 3.5e5)])
def test_a_frame_moves_like_its_columns_and_beam(ratio, inertia):
    columns, width, height, mass = 4, 1.6, 9.6, 3e4
    column = rb.Block(width=width, height=height, mass=mass, inertia=inertia, foundation="rigid")
    frame = rb.frame(columns, column, ratio * columns * mass)
    assert frame.mass_ratio == ratio and frame.block.alpha == column.alpha
    pulse = Pulse(2.0, 1.5)
    run = frame.run(theta=0.6 * column.alpha, pulse=rb.Pulse("one-sine", 2.0, 1.5), tolerance=1e-13, duration=12.0, step=0.05)
    bodies = Bodies(width / 2, height / 2, mass, inertia or mass * (width**2 + height**2) / 12, ratio * mass)
    exact = bodies.run(0.6 * column.alpha, pulse, 12.0, run.t[:-1])
    assert run.run.counts.impacts >= 4
    loads = [1.0, *[mass * (1 + ratio) * G] * 4]
    for name, one, other, load in zip(["theta", "base_H", "base_N", "top_H", "top_N"], [run.theta, run.base_H, run.base_N, run.top_H, run.top_N], exact, loads):
        # A row at an impact may be on either side of it.
        assert np.abs(one[:-1] - other).max() < 1e-8 * (column.alpha if name == "theta" else load), name
    assert np.allclose(run.beam_u, np.sign(run.theta) * 2 * column.R0 * (np.sin(column.alpha) - np.sin(column.alpha - np.abs(run.theta))), atol=1e-12)


def test_a_beam_that_leaves_its_columns_is_reported():
    column = rb.Block(width=2.0, height=4.0, mass=1e4, foundation="rigid")
    bridge = rb.frame(2, column, 1e5)
    vertical = rb.Record([0.0, -11.0, -11.0, 0.0], 0.05)
    with pytest.warns(RuntimeWarning, match="the beam leaves the columns at t = "):
        bridge.run(theta=0.2, vertical=vertical, duration=0.2, step=0.01)


def test_frames_without_an_equivalent_block_are_refused():
    column = rb.Block(alpha=0.2, foundation="rigid")
    with pytest.raises(ValueError, match="columns = 1; expected 2"):
        rb.frame(1, column, 0.0)
    with pytest.raises(ValueError, match="friction of the column has no equivalent in a frame: tops and bases"):
        rb.frame(2, column.replace(friction=0.4), 0.0)
    with pytest.raises(ValueError, match="on supports"):
        rb.frame(2, rb.Block(), 10.0)
