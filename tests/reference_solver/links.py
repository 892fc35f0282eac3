"""Ties and dampers: spring and dashpot between a point of the block and one of the ground, which may go slack, yield and break.

The spring force is k (s - s_p) with the plastic elongation s_p. A tie pulls with T = max(0, spring force + c ṡ) while its spring is
stretched, a damper with T = spring force + c ṡ either way. In full, docs/unit/model.md, Friction, ties and uneven bodies.
"""

from math import cos, hypot, sin


class Link:
    """`mode` is "elastic", "slack" (the spring of a tie is not stretched), "flows" (it yields, in the direction `sigma`) or "broken".

    A tie whose dashpot takes T to zero while its spring is stretched is `limp`: its spring goes on as if it were taut.
    """

    def __init__(self, given, middle, center):
        """`middle` is the x of the middle of the base from the centre of mass, `center` the centre's height, both at rest."""
        self.tie = given.get("kind", "tie") == "tie"
        self.k, self.c = given["stiffness"], given.get("damping", 0.0)
        self.strength, self.yield_force = given.get("strength"), given.get("yield_force")
        ratio = given.get("hardening", 0.0)
        self.hardening = self.k * ratio / (1 - ratio)
        self.point = (given["block"][0] + middle, given["block"][1] - center)
        self.anchor = (given["ground"][0] + middle, given["ground"][1] - center)
        self.slack, self.pretension = given.get("slack", 0.0), given.get("pretension", 0.0)
        self.rest = hypot(self.point[0] - self.anchor[0], self.point[1] - self.anchor[1])
        self.s_p, self.sigma, self.limp = 0.0, 0, False
        self.mode = "elastic"

    # Where the block is: u, v of the centre of mass, θ, and their rates.
    def line(self, place):
        """The point of the block from the centre of mass, the direction from it to the anchor, and s."""
        u, v, theta = place[:3]
        c, s = cos(theta), sin(theta)
        x, z = self.point[0] * c + self.point[1] * s, self.point[1] * c - self.point[0] * s
        dx, dz = self.anchor[0] - u - x, self.anchor[1] - v - z
        length = hypot(dx, dz)
        return (x, z), (dx / length, dz / length), length - self.rest - self.slack + self.pretension / self.k

    def stretch(self, place):
        return self.line(place)[2]

    def rate(self, place):
        """ṡ: how fast the point of the block moves away from the anchor."""
        (x, z), (ex, ez), _ = self.line(place)
        u_dot, v_dot, omega = place[3:]
        return -(ex * (u_dot + omega * z) + ez * (v_dot - omega * x))

    def plastic(self, s):
        if self.mode == "flows":
            return (self.k * s - self.sigma * self.yield_force) / (self.k + self.hardening)
        return self.s_p

    def spring(self, place):
        s = self.stretch(place)
        return self.k * (s - self.plastic(s))

    def pull(self, place):
        """What spring and dashpot would pull with, were the link taut."""
        return self.spring(place) + self.c * self.rate(place)

    def tension(self, place):
        return 0.0 if self.mode in ("slack", "broken") or self.limp else self.pull(place)

    def load(self, place):
        """Force (x, z) and moment (clockwise) on the block."""
        (x, z), (ex, ez), _ = self.line(place)
        tension = self.tension(place)
        return tension * ex, tension * ez, tension * (z * ex - x * ez)

    def taut(self):
        return self.mode in ("elastic", "flows") and not self.limp

    def reserve(self, place):
        """How much more force the spring bears before it yields."""
        s = self.stretch(place)
        return self.yield_force - abs(self.k * (s - self.s_p) - self.hardening * self.s_p)

    def direction(self, place):
        """The direction in which the spring would yield."""
        return 1 if self.k * (self.stretch(place) - self.s_p) > self.hardening * self.s_p else -1

    def begin(self, place):
        """At the start, nothing has yielded."""
        self.mode = "elastic"
        if self.tie and self.spring(place) <= 0:
            self.mode = "slack"

    # Events. Functions of the place fall through zero, those of forces and those of rates.
    def watched(self):
        if self.mode == "broken":
            return {}, {}
        if self.mode == "slack":
            return {"stretches": lambda place: -self.spring(place)}, {}
        forces, rates = {}, {}
        if self.tie:
            forces["slackens"] = self.spring
        if self.tie and self.c > 0:
            forces["limp or taut"] = lambda place: -self.pull(place) if self.limp else self.pull(place)
        if self.mode == "flows":
            rates["unloads"] = lambda place: self.sigma * self.rate(place)
        elif self.yield_force:
            forces["yields"] = self.reserve
        if self.strength and not self.limp:
            forces["breaks"] = lambda place: self.strength - abs(self.pull(place))
        return forces, rates

    def change(self, name, place):
        if name == "stretches":
            self.mode = "elastic"
        elif name == "yields":
            self.mode, self.sigma = "flows", self.direction(place)
        elif name != "limp or taut":  # settle() has that from the force
            self.s_p = self.plastic(self.stretch(place))
            self.mode = {"slackens": "slack", "unloads": "elastic", "breaks": "broken"}[name]

    def settle(self, now, soon, force):
        """What follows from rates, which a landing changes at once. Of a rate or a force that is zero, the place soon after decides.

        `force` is the block's weight, for comparison.
        """

        def positive(function, zero):
            value = function(now)
            return value > 0 if abs(value) > zero else function(soon) > value

        if self.mode == "flows" and not positive(lambda place: self.sigma * self.rate(place), 1e-10):
            self.change("unloads", now)
        if self.mode == "elastic" and self.yield_force and self.reserve(now) < 1e-11 * force:
            towards = self.direction(now)
            if positive(lambda place: towards * self.rate(place), 1e-10):
                self.change("yields", now)
        self.limp = self.tie and self.c > 0 and self.mode in ("elastic", "flows") and not positive(self.pull, 1e-10 * force)
        if self.strength and self.mode != "broken" and abs(self.tension(now)) > self.strength:
            self.change("breaks", now)


def changes(number, before, after):
    """Names of what has changed, of (mode, taut) before and after."""
    (mode, was_taut), (new, taut) = before, after
    if new == "broken" != mode:
        return [f"break{number}"]
    found = []
    if new == "flows" != mode:
        found.append(f"yield{number}")
    if mode == "flows" and new == "elastic":
        found.append(f"unload{number}")
    if was_taut != taut:
        found.append(f"tie{number}")
    elif new == "slack" != mode:
        found.append(f"slack{number}")
    return found
