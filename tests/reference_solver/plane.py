"""The paper's block: on a rigid base, and on supports whose standing corner does not slide.

Equations (7) to (17) of docs/unit/model.md, for any place of the centre of mass over the base (friction.py needs that): with
S = sin θ, c = cos θ, and b_I the horizontal distance from the centre of mass to corner I at θ = 0,
    X_I = h S ± b_I c       how far the centre of mass is to the right of corner I (+ on L); R0 sin(α+θ), -R0 sin(α-θ)
    Q_I = h c ∓ b_I S       and how high above it; R0 cos(α+θ), R0 cos(α-θ)
"""

from math import cos, exp, pi, sin, sqrt, tan

import numpy as np

L, R = "L", "R"
SIGN = {L: 1, R: -1}
REGIMES = {frozenset([L, R]): 0, frozenset([L]): -1, frozenset([R]): 1, frozenset(): 2}


class Body:
    """What all blocks have: M, g, gamma, R0, b, h, I0."""

    def __init__(self, case):
        self.alpha, self.p = case["alpha"], case["p"]
        self.mass, self.g, self.gamma = case.get("M", 1.0), case["g"], case.get("gamma", 3.0)
        self.epsilon = case["epsilon"]
        self.r0 = self.gamma / (1 + self.gamma) * self.g / self.p**2
        self.b, self.h = self.r0 * sin(self.alpha), self.r0 * cos(self.alpha)
        self.inertia = self.mass * self.r0**2 / self.gamma
        self.end, self.log = None, []


class RigidBase(Body):
    """Housner's block; the state is θ, θ̇. `side` is 1 while it tilts to the right, -1 to the left, 0 at rest."""

    def __init__(self, case):
        super().__init__(case)
        gamma, epsilon = self.gamma, self.epsilon
        self.e = (1 + gamma * epsilon + (1 - epsilon) * gamma * cos(2 * self.alpha)) / (1 + gamma)
        initial = case.get("initial", {})
        self.start = [initial.get("theta", 0.0), initial.get("theta_dot", 0.0)]
        self.side = int(np.sign(self.start[0] or self.start[1]))
        self.rounding = 0.0

    def derivative(self, t, y):
        theta, rate = y
        a_gx, a_gz = self.ground(t)
        if self.side == 0:
            return [0.0, 0.0]
        phi = self.side * self.alpha - theta
        return [rate, -self.p**2 * (sin(phi) * (1 + a_gz / self.g) + cos(phi) * a_gx / self.g)]

    def margin(self, t):
        """How far the ground is from making a block at rest rock (m/s2)."""
        a_gx, a_gz = self.ground(t)
        return (self.g + a_gz) * tan(self.alpha) - abs(a_gx)

    def watched(self):
        if self.side == 0:
            return {"rocks": (lambda t, y: self.margin(t), 0.0)}
        return {
            "impact": (lambda t, y: self.side * y[0], self.rounding),
            "overturned": (lambda t, y: pi / 2 - abs(y[0]), 0.0),
        }

    def change(self, name, t, y):
        before = self.side
        if name == "overturned":
            self.end = name
            self.log.append((t, (before, name)))
            return y
        if name == "impact":
            y = [0.0, self.e * y[1]]
            # Impacts follow each other ever faster until the block rests, which it does at last.
            resting = abs(y[1]) < 1e-9 * self.p and self.margin(t) >= 0
            self.side = 0 if resting else -before
            y = [0.0, 0.0] if resting else y
            self.rounding = 0.0
        else:
            # θ begins with the third power of time, next to nothing at first; after an impact with the first power.
            self.side, self.rounding = -int(np.sign(self.ground(t)[0])), 1e-16
        self.log.append((t, (before, self.side)))
        return y

    def settle(self, t, y):
        return self.change("rocks", t, y) if self.side == 0 and self.margin(t) < 0 else y

    def row(self, t, y):
        (theta, rate), (a_gx, a_gz) = y, self.ground(t)
        if self.side == 0:
            weight = self.mass * (self.g + a_gz)
            return dict(theta=0, theta_dot=0, v=0, v_dot=0, N_L=weight / 2, N_R=weight / 2, H=self.mass * a_gx, regime=0, energy=0)
        acceleration = self.derivative(t, y)[1]
        phi, side = self.alpha - abs(theta), self.side
        v, v_dot, u_dot = self.r0 * (cos(phi) - cos(self.alpha)), side * self.r0 * sin(phi) * rate, self.r0 * cos(phi) * rate
        v_ddot = self.r0 * (side * sin(phi) * acceleration - cos(phi) * rate**2)
        u_ddot = self.r0 * (cos(phi) * acceleration + side * sin(phi) * rate**2)
        n = self.mass * (self.g + a_gz + v_ddot)
        energy = self.inertia * rate**2 / 2 + self.mass * ((u_dot**2 + v_dot**2) / 2 + self.g * v)
        return dict(theta=theta, theta_dot=rate, v=v, v_dot=v_dot, N_L=n if side < 0 else 0, N_R=n if side > 0 else 0,
                    H=self.mass * (u_ddot + a_gx), regime=side, energy=energy)


class OnSupports(Body):
    """The block on supports; the state begins with v, θ, v̇, θ̇. `touching` are the corners that touch."""

    def __init__(self, case):
        super().__init__(case)
        omega = case["eta"] * self.p
        self.stiffness, self.damping = self.mass * omega**2 / 2, case["xi_v"] * self.mass * omega
        e_x = case.get("eccentricity", 0.0)
        self.distance = {L: self.b + e_x, R: self.b - e_x}
        weight = self.mass * self.g
        self.free = {i: weight * self.distance[j] / (2 * self.b) / self.stiffness for i, j in [(L, R), (R, L)]}
        # Where and when a lifted support was left: a support that nothing has touched stands at its free height.
        self.left = {i: (0.0, self.free[i]) for i in (L, R)}
        self.start = self.at_start(case.get("initial", {}))

    def at_start(self, initial):
        theta, rate = initial.get("theta", 0.0), initial.get("theta_dot", 0.0)
        v = self.settled(theta) if "theta" in initial else 0.0
        y = [v, theta, 0.0, rate]
        self.touching = {i for i in (L, R) if self.reaction(i, y) > 0}
        return y

    def settled(self, theta):
        """The v of vertical equilibrium: on both corners, or on the one that is pressed down."""
        heights = {i: self.height(i, [0.0, theta]) for i in (L, R)}
        weight = self.mass * self.g
        both = sum(self.free[i] - heights[i] for i in (L, R)) / 2 - weight / (2 * self.stiffness)
        if all(self.free[i] - heights[i] - both >= 0 for i in (L, R)):
            return both
        low = min(L, R, key=lambda i: heights[i])
        return self.free[low] - heights[low] - weight / self.stiffness

    # Corners and their supports.
    def lever(self, i, theta):
        """X_I and Q_I."""
        s, c = sin(theta), cos(theta)
        return self.h * s + SIGN[i] * self.distance[i] * c, self.h * c - SIGN[i] * self.distance[i] * s

    def height(self, i, y):
        return y[0] + self.h * (1 - cos(y[1])) + SIGN[i] * self.distance[i] * sin(y[1])

    def rate(self, i, y):
        return y[2] + self.lever(i, y[1])[0] * y[3]

    def reaction(self, i, y):
        return self.stiffness * (self.free[i] - self.height(i, y)) - self.damping * self.rate(i, y)

    def support(self, i, t):
        """Height of a lifted support, which creeps back to its free height."""
        since, height = self.left[i]
        if self.damping == 0:
            return self.free[i]
        return self.free[i] - (self.free[i] - height) * exp(-(t - since) * self.stiffness / self.damping)

    # Motion.
    def foot(self, theta):
        """Q of the foot, u̇ = Q θ̇, and its derivative with θ: of the middle of the base, or of the corner that stands."""
        if len(self.touching) == 2:
            return self.h * cos(theta), -self.h * sin(theta)
        (i,) = self.touching
        x, q = self.lever(i, theta)
        return q, -x

    def forces(self, t, y):
        """v̈, θ̈ and H."""
        theta, rate = y[1], y[3]
        a_gx, a_gz = self.ground(t)
        n = {i: self.reaction(i, y) for i in self.touching}
        q, dq = self.foot(theta)
        moment = sum(self.lever(i, theta)[0] * n[i] for i in n)
        angular = (moment - self.mass * q * (a_gx + dq * rate**2)) / (self.inertia + self.mass * q**2)
        return sum(n.values()) / self.mass - self.g - a_gz, angular, self.mass * (q * angular + dq * rate**2 + a_gx)

    def derivative(self, t, y):
        vertical, angular, _ = self.forces(t, y)
        return [y[2], y[3], vertical, angular]

    # Events.
    def watched(self):
        weight, events = self.mass * self.g, {"overturned": (lambda t, y: pi / 2 - abs(y[1]), 0.0)}
        for i in (L, R):
            if i in self.touching:
                events["lifts", i] = (lambda t, y, i=i: self.reaction(i, y) / weight, 1e-11)
            else:
                events["lands", i] = (lambda t, y, i=i: (self.height(i, y) - self.support(i, t)) / self.r0, 1e-14)
        return events

    def regime(self):
        return REGIMES[frozenset(self.touching)]

    def change(self, name, t, y):
        before = self.regime()
        if name == "overturned":
            self.end = name
            self.log.append((t, (before, name)))
            return y
        kind, i = name
        if kind == "lands":
            if self.rate(i, y) < 0:
                y = self.impact(i, y)
            self.touching.add(i)
        y = self.decide(t, y)
        self.log.append((t, (before, self.regime())))
        return y

    def settle(self, t, y):
        return y

    def impact(self, i, y):
        """(14) to (17): v̇ and θ̇ after corner i has landed, with the impulses of H and N there."""
        v, theta, v_dot, rate = y
        (x, q), m = self.lever(i, theta), self.mass
        q_before, q_after = self.foot(theta)[0], self.h * cos(theta)
        # Unknown are v̇, θ̇ after it, and both impulses.
        equations = [
            [0, m * q_after, -1, 0],
            [m, 0, 0, -1],
            [0, self.inertia, q, -x],
            [1, x, 0, 0],
        ]
        known = [m * q_before * rate, m * v_dot, self.inertia * rate, self.epsilon * (v_dot + x * rate)]
        after = np.linalg.solve(equations, known).tolist()
        return [v, theta, after[0], after[1]]

    def leaves(self, i, t, y):
        """Whether a touching corner cannot stay: N < 0, or N = 0 and falling."""
        n = self.reaction(i, y)
        if abs(n) > 1e-9 * self.mass * self.g:
            return n < 0
        vertical, angular = self.forces(t, y)[:2]
        x, q = self.lever(i, y[1])
        upward = vertical + x * angular + q * y[3] ** 2
        if self.damping == 0 and abs(self.rate(i, y)) < 1e-12 * self.r0 * self.p:
            return upward > 0
        return self.stiffness * self.rate(i, y) + self.damping * upward > 0

    def decide(self, t, y):
        """Drops corners that cannot stay, one after the other; the run ends when none is left."""
        leaving = [i for i in (L, R) if i in self.touching and self.leaves(i, t, y)]
        while leaving:
            i = min(leaving, key=lambda i: self.reaction(i, y))
            self.touching.remove(i)
            self.left[i] = (t, self.height(i, y))
            if not self.touching:
                self.end = "separated"
                return y
            y = self.stand(i, t, y)
            leaving = [i for i in (L, R) if i in self.touching and self.leaves(i, t, y)]
        return y

    def stand(self, lifted, t, y):
        """The state when the block goes on on the other corner: here v̇ and θ̇ stay."""
        return y

    def row(self, t, y):
        n = {i: self.reaction(i, y) if i in self.touching else 0.0 for i in (L, R)}
        (v, theta, v_dot, rate), (_, _, h) = y[:4], self.forces(t, y)
        u_dot = self.foot(theta)[0] * rate
        springs = sum((self.free[i] - self.height(i, y)) ** 2 for i in self.touching) - 2 * self.free[L] ** 2
        energy = (self.inertia * rate**2 + self.mass * (u_dot**2 + v_dot**2) + self.stiffness * springs) / 2 + self.mass * self.g * v
        return dict(theta=theta, theta_dot=rate, v=v, v_dot=v_dot, N_L=n[L], N_R=n[R], H=h, regime=self.regime(), energy=energy)
