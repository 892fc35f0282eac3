"""One elastic storey of a building as an FMU: a mass on a spring and a dashpot, solved exactly for inputs held over each step.

Motions are relative to the ground; SI units.
"""

from math import cos, exp, sin, sqrt

from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real

PARAMETERS = {
    "mass": (1.0, "Mass of the floor, without the block [kg]"),
    "stiffness": (1.0, "Stiffness of the storey [N/m]"),
    "damping": (0.05, "Damping ratio, below 1 [1]"),
}
INPUTS = {"a_ground": "Horizontal ground acceleration [m/s2]", "H": "Horizontal reaction on the block, to the right [N]"}
OUTPUTS = {"a": "Absolute horizontal acceleration of the floor [m/s2]", "u": "Displacement of the floor [m]"}


class Storey(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.description = "An elastic storey of a building"
        for name, (value, text) in PARAMETERS.items():
            setattr(self, name, value)
            self.register_variable(Real(name, causality=Fmi2Causality.parameter, variability=Fmi2Variability.fixed,
                                        description=text, start=value))
        for name, text in INPUTS.items():
            setattr(self, name, 0.0)
            self.register_variable(Real(name, causality=Fmi2Causality.input, description=text, start=0.0))
        for name, text in OUTPUTS.items():
            setattr(self, name, 0.0)
            self.register_variable(Real(name, causality=Fmi2Causality.output, description=text))
        self.u_dot = 0.0

    def do_step(self, current_time, step_size):
        omega = sqrt(self.stiffness / self.mass)
        decay = self.damping * omega
        omega_d = sqrt(omega**2 - decay**2)
        # Free vibration about the displacement at which the spring balances the inputs.
        balance = -(self.mass * self.a_ground + self.H) / self.stiffness
        x, x_dot = self.u - balance, self.u_dot
        c, s = cos(omega_d * step_size), sin(omega_d * step_size) / omega_d
        factor = exp(-decay * step_size)
        self.u = balance + factor * (x * (c + decay * s) + x_dot * s)
        self.u_dot = factor * (x_dot * (c - decay * s) - omega**2 * x * s)
        self.a = -omega**2 * self.u - 2 * decay * self.u_dot - self.H / self.mass
        return True
