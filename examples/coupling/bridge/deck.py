"""A bridge deck on two rocking towers, as an FMU made with pythonfmu.

The deck is rigid and lies on a bearing on each tower: horizontally it moves as one, vertically each end moves with half of the
mass. Springs and dashpots of the bearings act between the deck and the middle of each tower's top. The FMU takes the
towers' motions and gives the forces on their centres of mass. Motions are relative to the ground; SI units.

Within a communication step the towers keep their velocities from its beginning; the deck is integrated by the classic
Runge-Kutta method in steps of at most 0.25 ms.
"""

from math import ceil, cos, sin

from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real

GRAVITY = 9.81  # m/s2
PARAMETERS = {
    "mass": (300e3, "Mass of the deck [kg]"),
    "k_x": (2.6e6, "Horizontal stiffness of a bearing [N/m]"),
    "c_x": (6.3e4, "Horizontal damping of a bearing [N.s/m]"),
    "k_z": (1.35e8, "Vertical stiffness of a bearing [N/m]"),
    "c_z": (4.5e5, "Vertical damping of a bearing [N.s/m]"),
    "h": (6.0, "Height of a tower's top over its centre of mass [m]"),
}
MOTIONS = ("u", "u_dot", "v", "v_dot", "theta", "theta_dot")
FORCES = ("F_x", "F_z", "M_y")


class Deck(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.description = "A bridge deck on bearings on two rocking towers"
        for name, (value, text) in PARAMETERS.items():
            setattr(self, name, value)
            self.register_variable(Real(name, causality=Fmi2Causality.parameter, variability=Fmi2Variability.fixed,
                                        description=text, start=value))
        self.a_gx = 0.0
        self.register_variable(Real("a_gx", causality=Fmi2Causality.input, start=0.0,
                                    description="Horizontal ground acceleration [m/s2]"))
        for tower in (1, 2):
            for name in MOTIONS:
                self.add(f"{name}_{tower}", Fmi2Causality.input, f"{name} of tower {tower}", start=0.0)
            for name in FORCES:
                self.add(f"{name}_{tower}", Fmi2Causality.output, f"{name} on tower {tower}")
        self.add("x", Fmi2Causality.output, "Horizontal displacement of the deck [m]")
        self.add("work", Fmi2Causality.output, "Work of the deck on the towers since the start [J]")
        self.add("energy", Fmi2Causality.output, "Kinetic energy of the deck, and energy of its weight and its bearings [J]")
        self.add("input", Fmi2Causality.output, "Work of the ground motion on the deck [J]")
        self.add("lost", Fmi2Causality.output, "Energy lost in the bearings' dashpots [J]")

    def add(self, name, causality, text, **more):
        setattr(self, name, 0.0)
        self.register_variable(Real(name, causality=causality, description=text, **more))

    def setup_experiment(self, start_time, stop_time, tolerance):
        # x, its rate, both ends' heights and rates; work, input, lost.
        sag = -self.mass / 2 * GRAVITY / self.k_z
        self.state = [0.0, 0.0, sag, 0.0, sag, 0.0, 0.0, 0.0, 0.0]

    def exit_initialization_mode(self):
        towers = self.towers()
        # The bearings carry the deck from the start.
        for tower, end in ((0, 2), (1, 4)):
            self.state[end] += self.top(towers[tower], 0.0)[1]
        self.give(towers)

    def towers(self):
        return [[getattr(self, f"{name}_{tower}") for name in MOTIONS] for tower in (1, 2)]

    def top(self, motion, time):
        """Returns position, velocity and angle of a tower's top, `time` after the start of the step."""
        u, u_dot, v, v_dot, theta, theta_dot = motion
        theta += theta_dot * time
        s, c = sin(theta), cos(theta)
        return (u + u_dot * time + self.h * s, v + v_dot * time + self.h * (c - 1),
                u_dot + self.h * c * theta_dot, v_dot - self.h * s * theta_dot, s, c)

    def bearings(self, state, towers, time):
        """Returns the force on each tower's top, its power there, and the power lost."""
        found = []
        for motion, end in zip(towers, (2, 4)):
            x, z, x_dot, z_dot, s, c = self.top(motion, time)
            rates = state[1] - x_dot, state[end + 1] - z_dot
            f_x = self.k_x * (state[0] - x) + self.c_x * rates[0]
            f_z = self.k_z * (state[end] - z) + self.c_z * rates[1]
            lost = self.c_x * rates[0] ** 2 + self.c_z * rates[1] ** 2
            found.append((f_x, f_z, self.h * (c * f_x - s * f_z), f_x * x_dot + f_z * z_dot, lost))
        return found

    def rate(self, state, towers, time):
        (fx1, fz1, _, power1, lost1), (fx2, fz2, _, power2, lost2) = self.bearings(state, towers, time)
        half = self.mass / 2
        return [state[1], -(fx1 + fx2) / self.mass - self.a_gx, state[3], -fz1 / half - GRAVITY, state[5],
                -fz2 / half - GRAVITY, power1 + power2, -self.mass * self.a_gx * state[1], lost1 + lost2]

    def do_step(self, current_time, step_size):
        towers, parts = self.towers(), ceil(step_size / 0.25e-3 - 1e-6)
        h = step_size / parts
        for k in range(parts):
            t, y = k * h, self.state
            a = self.rate(y, towers, t)
            b = self.rate([p + h / 2 * q for p, q in zip(y, a)], towers, t + h / 2)
            c = self.rate([p + h / 2 * q for p, q in zip(y, b)], towers, t + h / 2)
            d = self.rate([p + h * q for p, q in zip(y, c)], towers, t + h)
            self.state = [p + h / 6 * (i + 2 * j + 2 * m + n) for p, i, j, m, n in zip(y, a, b, c, d)]
        self.give([[u + u_dot * step_size, u_dot, v + v_dot * step_size, v_dot, theta + theta_dot * step_size, theta_dot]
                   for u, u_dot, v, v_dot, theta, theta_dot in towers])
        return True

    def give(self, towers):
        energy = 0.0
        for tower, (f_x, f_z, m_y, _, _) in enumerate(self.bearings(self.state, towers, 0.0), 1):
            for name, value in zip(FORCES, (f_x, f_z, m_y)):
                setattr(self, f"{name}_{tower}", value)
            end = 2 * tower
            x, z, *_ = self.top(towers[tower - 1], 0.0)
            energy += (self.k_x * (self.state[0] - x) ** 2 + self.k_z * (self.state[end] - z) ** 2) / 2
            energy += self.mass / 2 * (self.state[end + 1] ** 2 / 2 + GRAVITY * self.state[end])
        self.energy = energy + self.mass * self.state[1] ** 2 / 2
        self.x = self.state[0]
        self.work, self.input, self.lost = self.state[6:]
