"""An earthquake as an FMU: samples at equal intervals, linear in between, from `record.csv` in its resources."""

from pathlib import Path

from pythonfmu import Fmi2Causality, Fmi2Slave, Real


class Ground(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.description = "A recorded ground acceleration"
        self.a = 0.0
        self.register_variable(Real("a", causality=Fmi2Causality.output, description="Ground acceleration [m/s2]"))

    def exit_initialization_mode(self):
        self.dt, *self.samples = map(float, Path(self.resources, "record.csv").read_text().split())
        self.a = self.samples[0]

    def do_step(self, current_time, step_size):
        place = (current_time + step_size) / self.dt
        k = min(int(place), len(self.samples) - 2)
        self.a = self.samples[k] + (place - k) * (self.samples[k + 1] - self.samples[k])
        return True
