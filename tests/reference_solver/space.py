"""The block in space: a rigid body on feet, each on a vertical and a horizontal spring and dashpot, with Coulomb friction.

The state is X, q, V, ω of the centre of mass and, for each foot, the stretch e of its horizontal spring. No impulse: every force is
a function of the state.
"""

import numpy as np


class BlockInSpace:
    """`touching` and `sliding` are the feet that do."""

    def __init__(self, case):
        numbers, initial = case["numbers"], case["initial"]
        self.mass, self.g, self.inertia = numbers["M"], numbers["g"], np.array(numbers["inertia"])
        self.k, self.c, self.k_h, self.c_h = (numbers[name] for name in ("K", "C", "K_h", "C_h"))
        self.friction, self.free, self.size = numbers["friction"], np.array(numbers["f"]), numbers["R0"]
        gaps = np.array(numbers["foot_gap"])
        self.feet = np.column_stack([numbers["feet"], gaps - numbers["center_height"]])
        self.count = len(gaps)
        self.end, self.log, self.seen = None, [], {}
        self.touching, self.sliding = set(range(self.count)), set()
        self.start = [*initial["X"], *initial["q"], *initial["V"], *initial["omega"], *[0.0] * (2 * self.count)]
        place, speed = self.places(np.array(self.start))
        reaction = self.k * (self.free - place[:, 2]) - self.c * speed[:, 2]
        self.touching = {i for i in range(self.count) if place[i, 2] < self.free[i] and reaction[i] > 0}
        # When and where a lifted support was left.
        self.left = {i: (0.0, min(place[i, 2], self.free[i])) for i in range(self.count)}

    def places(self, y):
        """Displacements and velocities of the feet."""
        turn = rotation(y[3:7])
        arms = self.feet @ turn.T
        # (R - 1) s without cancellation.
        w, axis = y[3], y[4:7]
        cross = np.cross(axis, self.feet)
        moved = y[:3] + 2 * (w * cross + np.cross(axis, cross))
        return moved, y[7:10] + np.cross(y[10:13], arms)

    def feet_forces(self, y):
        """N of each foot, the trial force F of its horizontal spring and dashpot, and their velocities."""
        place, speed = self.places(y)
        stretch = y[13:].reshape(-1, 2)
        n = self.k * (self.free - place[:, 2]) - self.c * speed[:, 2]
        return place, speed, n, self.k_h * stretch + self.c_h * speed[:, :2]

    def derivative(self, t, y):
        y = np.asarray(y)
        turn = rotation(y[3:7])
        arms, (_, speed, n, trial) = self.feet @ turn.T, self.feet_forces(y)
        force, rate = np.zeros((self.count, 3)), np.zeros((self.count, 2))
        for i in self.touching:
            force[i] = -trial[i, 0], -trial[i, 1], n[i]
            rate[i] = speed[i, :2]
            if i in self.sliding:
                size = np.hypot(*trial[i])
                direction = trial[i] / size
                force[i, :2] = -self.friction * n[i] * direction
                rate[i] -= direction * (size - self.friction * n[i]) / self.c_h
        omega, j = y[10:13], turn @ self.inertia @ turn.T
        moment = np.cross(arms, force).sum(axis=0) - np.cross(omega, j @ omega)
        acceleration = force.sum(axis=0) / self.mass - np.array(self.ground(t)) - [0, 0, self.g]
        w, axis = y[3], y[4:7]
        q_dot = [-(omega @ axis) / 2, *((w * omega + np.cross(omega, axis)) / 2)]
        return np.concatenate([y[7:10], q_dot, acceleration, np.linalg.solve(j, moment), rate.ravel()])

    def support(self, i, t):
        since, height = self.left[i]
        return self.free[i] - (self.free[i] - height) * np.exp(-(t - since) * self.k / self.c)

    # Events.
    def at(self, t, y):
        """What the functions below have in common at a time of the present regime."""
        if t not in self.seen:
            self.seen[t] = self.feet_forces(np.asarray(y))
        return self.seen[t]

    def watched(self):
        self.seen.clear()
        weight = self.mass * self.g
        # The vertical part of the body's axis.
        events = {"overturned": (lambda t, y: rotation(y[3:7])[2, 2], 0.0)}

        def excess(i, t, y):
            _, _, n, trial = self.at(t, y)
            return (np.hypot(*trial[i]) - self.friction * n[i]) / weight

        for i in range(self.count):
            if i not in self.touching:
                events["landing", i] = (lambda t, y, i=i: (self.at(t, y)[0][i, 2] - self.support(i, t)) / self.size, 1e-14)
                continue
            events["lift-off", i] = (lambda t, y, i=i: self.at(t, y)[2][i] / weight, 1e-12)
            if i in self.sliding:
                events["sticks", i] = (lambda t, y, i=i: excess(i, t, y), 1e-12)
            else:
                events["slides", i] = (lambda t, y, i=i: -excess(i, t, y), 1e-12)
        return events

    def change(self, name, t, y):
        if name == "overturned":
            self.end = name
            self.log.append((t, ("overturning", -1)))
            return y
        kind, i = name
        self.log.append((t, name))
        place, speed, n, _ = self.feet_forces(np.asarray(y))
        if kind == "lift-off":
            self.touching.remove(i)
            self.left[i] = (t, place[i, 2])
        elif kind == "landing":
            self.touching.add(i)
        if kind in ("lift-off", "landing"):
            self.sliding.discard(i)
            # A horizontal spring begins unstretched.
            y = [*y[: 13 + 2 * i], 0.0, 0.0, *y[15 + 2 * i :]]
        if kind == "landing" and self.c_h * np.hypot(*speed[i, :2]) > self.friction * n[i]:
            self.log.append((t, ("slides", i)))
            self.sliding.add(i)
        if kind == "slides":
            self.sliding.add(i)
        elif kind == "sticks":
            self.sliding.remove(i)
        return y

    def settle(self, t, y):
        """At the start; later only the ground's acceleration has kinks, and no force depends on it."""
        if t == 0.0:
            _, _, n, trial = self.feet_forces(np.asarray(y))
            self.sliding = {i for i in self.touching if np.hypot(*trial[i]) > self.friction * n[i]}
        return y

    def row(self, t, y):
        turn, (_, _, n, _) = rotation(y[3:7]), self.feet_forces(np.asarray(y))
        x, yy, z = turn[:, 2]
        lean = np.hypot(x, yy)
        per = np.arctan2(lean, z) / lean if lean > 0 else 1.0
        row = dict(zip(["u", "w", "v", "omega_x", "omega_y", "omega_z"], [*y[:3], *y[10:13]]))
        row |= {"tilt_x": per * x, "tilt_y": per * yy, "twist": np.arctan2(turn[1, 0] - turn[0, 1], turn[0, 0] + turn[1, 1])}
        row |= {f"N_{i}": n[i] if i in self.touching else 0.0 for i in range(self.count)}
        return row | {"touching": len(self.touching), "sliding": len(self.sliding)}


def rotation(q):
    """The matrix of a quaternion w, x, y, z."""
    w, x, y, z = q
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ])
