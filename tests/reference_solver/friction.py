"""The block on supports with an eccentric centre of mass, Coulomb friction and links: docs/unit/model.md, Friction, ties and uneven bodies.

The state is v, θ, v̇, θ̇, u, u̇, of the centre of mass relative to the ground.
"""

from math import copysign, cos, inf, sin

from scipy.optimize import brentq

from links import Link, changes
from plane import L, OnSupports, R


def place(y):
    """What links need of a state: u, v, θ and their rates."""
    return y[4], y[0], y[1], y[5], y[2], y[3]


class Block(OnSupports):
    """`slip` is the direction in which the foot slides, 0 while it grips."""

    def __init__(self, case):
        self.friction = case.get("friction", inf)
        self.eccentricity = case.get("eccentricity", 0.0)
        self.given, self.slip = case.get("ties", []) + case.get("links", []), 0
        super().__init__(case)

    def at_start(self, initial):
        """Upright and at rest, in vertical equilibrium with its links; no case starts otherwise."""
        assert not initial
        self.links = [Link(given, -self.eccentricity, self.h) for given in self.given]

        def unbalanced(v):
            y = [v, 0.0, 0.0, 0.0, 0.0, 0.0]
            for link in self.links:
                link.begin(place(y))
            return sum(max(0.0, self.reaction(i, y)) for i in (L, R)) + self.load(y)[1] - self.mass * self.g

        v = brentq(unbalanced, -self.r0 / 2, self.r0 / 2, xtol=1e-16, rtol=1e-15)
        self.touching = {L, R}
        y = [v, 0.0, 0.0, 0.0, 0.0, 0.0]
        for link in self.links:
            link.begin(place(y))
        return y

    def foot(self, theta):
        """Q of the foot, and its derivative -X; the foot in full contact is the middle of the base."""
        if len(self.touching) == 2:
            s, c = sin(theta), cos(theta)
            return self.h * c - self.eccentricity * s, -self.h * s - self.eccentricity * c
        return super().foot(theta)

    def slides(self, y):
        """The velocity of the foot."""
        return y[5] - self.foot(y[1])[0] * y[3]

    def load(self, y):
        loads = [link.load(place(y)) for link in self.links]
        return tuple(sum(load[i] for load in loads) for i in range(3))

    def all_forces(self, t, y):
        """v̈, θ̈, ü, H and N."""
        theta, rate = y[1], y[3]
        a_gx, a_gz = self.ground(t)
        n = {i: self.reaction(i, y) for i in self.touching}
        f_x, f_z, m_y = self.load(y)
        total = sum(n.values())
        moment = sum(self.lever(i, theta)[0] * n[i] for i in n) + m_y
        q, dq = self.foot(theta)
        if self.slip == 0:
            pushed = self.mass * (a_gx + dq * rate**2) - f_x
            angular = (moment - q * pushed) / (self.inertia + self.mass * q**2)
            h = self.mass * q * angular + pushed
        else:
            h = -self.slip * self.friction * total
            angular = (moment - q * h) / self.inertia
        return (total + f_z) / self.mass - self.g - a_gz, angular, (h + f_x) / self.mass - a_gx, h, total

    def forces(self, t, y):
        vertical, angular, _, h, _ = self.all_forces(t, y)
        return vertical, angular, h

    def derivative(self, t, y):
        vertical, angular, horizontal = self.all_forces(t, y)[:3]
        return [y[2], y[3], vertical, angular, y[5], horizontal]

    def watched(self):
        events, weight = super().watched(), self.mass * self.g
        if self.slip:
            events["grips"] = (lambda t, y: self.slip * self.slides(y) / (self.r0 * self.p), 1e-13)
        elif self.friction < inf:
            events["slides"] = (lambda t, y: self.grip(t, y) / weight, 1e-11)
        for link in self.links:
            forces, rates = link.watched()
            for name, f in forces.items():
                events["link", link, name] = (lambda t, y, f=f: f(place(y)) / weight, 1e-12)
            for name, f in rates.items():
                events["link", link, name] = (lambda t, y, f=f: f(place(y)) / (self.r0 * self.p), 1e-13)
        return events

    def grip(self, t, y):
        """How much more H the foot could bear."""
        _, _, _, h, n = self.all_forces(t, y)
        return self.friction * n - abs(h)

    def break_away(self, t, y):
        self.slip = -int(copysign(1, self.all_forces(t, y)[3]))

    def hold(self, t, y):
        """Lets a foot that grips slide where it would need more than friction."""
        if self.slip == 0 and self.friction < inf and self.grip(t, y) < -1e-11 * self.mass * self.g:
            self.break_away(t, y)

    def status(self):
        return (self.regime(), self.slip), [(link.mode, link.taut()) for link in self.links]

    def change(self, name, t, y):
        before = self.status()
        self.landing = name[0] == "lands"
        if name == "overturned":
            self.end = name
        elif name == "grips":
            self.slip = 0
        elif name == "slides":
            self.break_away(t, y)
        elif name[0] == "link":
            name[1].change(name[2], place(y))
        elif self.landing:
            if self.rate(name[1], y) < 0:
                y = self.impact(name[1], y)
            self.touching.add(name[1])
        return self.settled_anew(t, y, before)

    def settle(self, t, y):
        self.landing = False
        return self.settled_anew(t, y, self.status())

    def settled_anew(self, t, y, before):
        """Decides the regime anew: the corners, the foot, the links; and the foot once more, since links bear on it."""
        self.hold(t, y)
        y = self.decide(t, y)
        if self.end is None:
            moment = 1e-7
            soon = [value + moment * rate for value, rate in zip(y, self.derivative(t, y))]
            for link in self.links:
                link.settle(place(y), place(soon), self.mass * self.g)
            self.hold(t, y)
        (regime, links), (new_regime, new_links) = before, self.status()
        if new_regime != regime or self.landing:
            self.log.append((t, new_regime))
        for number, (old, new) in enumerate(zip(links, new_links)):
            self.log.extend((t, name) for name in changes(number, old, new))
        return y

    def stand(self, lifted, t, y):
        """The other corner becomes the foot. If the foot gripped, so does the corner (the paper's rule), otherwise its own velocity decides.

        After a landing in the same instant the velocity decides, too: the corner slides, or without a limit of friction a horizontal
        impulse stops it. Where the lifted corner would land at once by this, no regime lasts, and the paper's rule holds.
        """
        gripping = [*y[:5], self.foot(y[1])[0] * y[3]]
        if self.slip == 0 and not self.landing:
            y = gripping
        else:
            gripped = self.slip == 0
            if self.friction < inf:
                self.slip = int(copysign(1, self.slides(y)))
            else:
                q = self.foot(y[1])[0]
                impulse = -self.slides(y) / (1 / self.mass + q**2 / self.inertia)
                y = [*y[:3], y[3] - q * impulse / self.inertia, y[4], y[5] + impulse / self.mass]
            if gripped and not self.leaves(lifted, t, y):
                y, self.slip = gripping, 0
        self.hold(t, y)
        return y

    def impact(self, i, y):
        """Corner i lands: of all impulses that friction admits, the one that leaves u̇ of the middle of the base nearest to zero."""
        v, theta, v_dot, rate, u, u_dot = y
        (x, q), m = self.lever(i, theta), self.mass
        middle = self.h * cos(theta) - self.eccentricity * sin(theta)

        def after(p_h):
            """P_N from restitution, ż_I after = ε ż_I before, and the rates after both impulses."""
            p_n = ((self.epsilon - 1) * (v_dot + x * rate) + x * q * p_h / self.inertia) / (1 / m + x**2 / self.inertia)
            return p_n, v_dot + p_n / m, rate + (x * p_n - q * p_h) / self.inertia, u_dot + p_h / m

        def linear(f):
            return f(0.0), f(1.0) - f(0.0)

        # The velocity of the middle of the base is linear in P_H, and so are the bounds P_N μ ± P_H >= 0.
        at_rest, slope = linear(lambda p_h: after(p_h)[3] - middle * after(p_h)[2])
        p_h, self.slip = -at_rest / slope, 0
        if abs(p_h) > self.friction * after(p_h)[0]:
            p_n, more = linear(lambda p_h: after(p_h)[0])
            side = copysign(1, p_h)
            p_h = self.friction * p_n / (side - self.friction * more)
            self.slip = int(copysign(1, at_rest + slope * p_h))
        _, v_after, rate_after, u_after = after(p_h)
        energy = lambda v_dot, rate, u_dot: m * (u_dot**2 + v_dot**2) + self.inertia * rate**2
        gain = energy(v_after, rate_after, u_after) - energy(v_dot, rate, u_dot)
        assert gain <= 0, "a landing that makes energy needs a lower ε, which no stored case does"
        return [v, theta, v_after, rate_after, u, u_after]

    def row(self, t, y):
        n = {i: self.reaction(i, y) if i in self.touching else 0.0 for i in (L, R)}
        v, theta, v_dot, rate, u, u_dot = y
        row = dict(theta=theta, theta_dot=rate, v=v, v_dot=v_dot, u=u, u_dot=u_dot, N_L=n[L], N_R=n[R],
                   H=self.forces(t, y)[2], regime=self.regime(), slip=self.slip)
        for number, link in enumerate(self.links, 1):
            row[f"tension_{number}"] = link.tension(place(y))
            row[f"plastic_{number}"] = link.plastic(link.stretch(place(y)))
        return row
