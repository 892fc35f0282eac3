"""Derives the errors in the printed paper that docs/unit/model.md lists, by computer algebra."""

from math import pi, sqrt

import pytest

sympy = pytest.importorskip("sympy")
from sympy import Rational, cos, diff, simplify, sin, solve, symbols  # noqa: E402

pytestmark = pytest.mark.check
M, I0, R0, g, alpha, gamma, K, p, eta, xi = symbols("M I0 R0 g alpha gamma K p eta xi", positive=True)
theta, epsilon = symbols("theta epsilon", real=True)


def test_the_last_term_of_j12_is_negative():
    """Eqs. (14)–(17), solved for the velocities after a landing on L."""
    before, rotation, after, rotated, horizontal, vertical = symbols("v_b w_b v_a w_a P_H P_N")
    u_before = R0 * cos(alpha - theta) * rotation
    u_after = R0 * cos(alpha) * cos(theta) * rotated
    s, c = sin(alpha + theta), cos(alpha + theta)
    found = solve([
        M * (u_after - u_before) - horizontal,
        M * (after - before) - vertical,
        I0 * (rotated - rotation) + R0 * c * horizontal - R0 * s * vertical,
        after + R0 * s * rotated - epsilon * (before + R0 * s * rotation),
    ], [after, rotated, horizontal, vertical], dict=True)[0]
    j12 = diff(found[after].expand(), rotation)

    def printed(sign):
        a, b = cos(alpha) * cos(theta) * c, s**2
        numerator = (epsilon - 1) * I0 + (epsilon * a + sign * cos(alpha - theta) * c) * M * R0**2
        return numerator * R0 * s / (I0 + (a + b) * M * R0**2)

    values = {M: 2, I0: Rational(3, 2), R0: Rational(7, 5), alpha: Rational(1, 4), theta: Rational(1, 9), epsilon: Rational(2, 5)}
    assert abs((j12 - printed(-1)).subs(values).evalf()) < 1e-12
    assert abs((j12 - printed(1)).subs(values).evalf()) > 1e-2
    elastic = {theta: 0, epsilon: 1}
    assert simplify(j12.subs(elastic)) == 0
    claimed = 2 * R0 * sin(alpha) * cos(alpha) ** 2 * M * R0**2 / (I0 + M * R0**2)
    assert simplify(printed(1).subs(elastic) - claimed) == 0


def test_the_springs_have_the_factor_p4_over_g():
    size = solve(p**2 - gamma / (1 + gamma) * g / R0, R0)[0]
    omega = eta * p
    stiffness, damping, inertia = M * omega**2 / 2, xi * M * omega, M * R0**2 / gamma
    v, v_dot = symbols("v v_dot")
    moment = R0 * (stiffness * v + damping * v_dot) / inertia
    claimed = (1 + gamma) / 2 * eta**2 * p**4 / g * (v + 2 * xi * v_dot / (eta * p))
    assert simplify(moment.subs(R0, size) - claimed) == 0


def test_springs_from_rest_contain_the_weight():
    v, v_dot = symbols("v v_dot")
    deflection = M * g / (2 * K)
    acceleration = 2 * K * (deflection - v) / M - g

    def growth(potential):
        return simplify(diff(potential, v) * v_dot + M * v_dot * acceleration)

    assert growth(K * v**2 + M * g * v) == M * g * v_dot
    assert growth(K * (deflection - v) ** 2 + M * g * v) == 0


def test_the_pads_have_116_rad_per_s():
    stiffness = 6 * pi * 2 * 10**6 * 5**3
    frequency = sqrt(2 * stiffness / 700_000)
    assert round(stiffness / 10**6) == 4712
    assert round(frequency) == 116 and round(frequency / 0.38) == 305
    assert round(sqrt(2 * 158e6 / 700_000), 1) == 21.2


def test_the_left_corner_stands_where_the_block_tilts_left():
    left, right = (R0 * (cos(alpha) - cos(alpha + side * theta)) for side in (1, -1))
    assert simplify(right - left + 2 * R0 * sin(alpha) * sin(theta)) == 0


def test_the_peaks_of_table_1_are_in_g():
    assert round(2 * pi / 0.80 * 1.75 / 2, 2) == 6.87
