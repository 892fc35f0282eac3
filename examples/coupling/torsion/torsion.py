"""A block in space on the floor of a building that twists: floor accelerations in two directions, reactions returned.

    python examples/coupling/torsion/torsion.py

Writes torsion.png to the folder in which it is started (with --update, result.png beside this file), and prints the
README's table.
"""

import sys
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from scipy.linalg import eigh, expm

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1]))
from common import BLOCK, RECORD, ROOT, Instance, instance, parser, picture, read_record

IN_SPACE = BLOCK.with_name("RockingBlockInSpace.fmu")
# Along 133 and 43 degrees from north: y is a quarter turn to the left of x, seen from above.
RECORDS = RECORD, ROOT / "examples/space/np01002p_4225c_a.smc"
GRAVITY = 9.81  # m/s2

# A transformer on four pads.
MASS = 2500.0  # kg
TRANSFORMER = {
    "parameterization": 2,
    "physical.width": 0.9,
    "physical.depth": 0.7,
    "physical.height": 2.2,
    "physical.K": 2.0e6,
    "physical.C": 1.0e4,
    "friction": 0.7,
    "mass": MASS,
    "on_separation": 3,
    "on_overturning": 2,
}
PLACE = np.array([3.5, 2.0])  # m, on the floor from its centre of mass
FORCES = ("H_x", "H_y")


class Building:
    """A floor on columns, linear: displacements in x and y, and a twist. Its stiffness is off its centre of mass."""

    MASS, SIDES = 18e3, (10.0, 7.0)  # kg, m
    PERIOD, TWIST_PERIOD, DAMPING = 0.55, 0.5, 0.05  # s, of the floor without eccentricity
    ECCENTRICITY = np.array([1.5, 0.8])  # m, from the centre of mass to that of the stiffness

    def __init__(self, h: float):
        inertia = self.MASS * (self.SIDES[0] ** 2 + self.SIDES[1] ** 2) / 12
        self.masses = np.array([self.MASS, self.MASS, inertia])
        lateral, twisting = (mass * (2 * np.pi / period) ** 2 for mass, period in ((self.MASS, self.PERIOD), (inertia, self.TWIST_PERIOD)))
        # The displacement of the centre of stiffness, by those of the floor.
        arms = np.array([[1.0, 0.0, -self.ECCENTRICITY[1]], [0.0, 1.0, self.ECCENTRICITY[0]]])
        stiffness = lateral * arms.T @ arms + np.diag([0.0, 0.0, twisting])
        squares, modes = eigh(stiffness, np.diag(self.masses))
        self.periods = 2 * np.pi / np.sqrt(squares)
        weighted = np.diag(self.masses) @ modes
        damping = weighted @ np.diag(2 * self.DAMPING * np.sqrt(squares)) @ weighted.T
        # The displacement of the block's place, and forces there as loads on the floor.
        self.at_place = np.array([[1.0, 0.0, -PLACE[1]], [0.0, 1.0, PLACE[0]]])
        inverse = np.diag(1 / self.masses)
        self.system = np.block([[np.zeros((3, 3)), np.eye(3)], [-inverse @ stiffness, -inverse @ damping]])
        # Inputs: ground acceleration in x and y, forces of the block on the floor.
        ground = np.vstack([np.zeros((3, 2)), -np.eye(3)[:, :2]])
        force = np.vstack([np.zeros((3, 2)), inverse @ self.at_place.T])
        self.inputs = np.hstack([ground, force])
        # One step under linear inputs, exactly.
        n, m = 6, 4
        block = np.zeros((n + 2 * m, n + 2 * m))
        block[:n, :n], block[:n, n : n + m], block[n : n + m, n + m :] = self.system, self.inputs, np.eye(m)
        transition = expm(h * block)
        self.step_state, self.step_start = transition[:n, :n], transition[:n, n : n + m]
        self.step_change = transition[:n, n + m :] / h

    def step(self, state, before, after):
        """Returns the state a step later, under inputs that are linear in between."""
        return self.step_state @ state + self.step_start @ before + self.step_change @ (after - before)

    def motion(self, state, inputs):
        """Returns absolute acceleration [m/s2] and velocity over the ground [m/s] of the block's place."""
        rates = self.system @ state + self.inputs @ inputs
        return self.at_place @ rates[3:] + inputs[:2], self.at_place @ state[3:]


@dataclass
class History:
    time: list = field(default_factory=list)
    rows: list = field(default_factory=list)
    iterations: list = field(default_factory=list)
    names = ("tilt", "twist", "drift_x", "drift_y", "a_x", "a_y", "given", "received")

    def __getitem__(self, name) -> np.ndarray:
        return np.array(self.rows)[:, self.names.index(name)]


def block_step(block: Instance, t: float, h: float, before, after) -> np.ndarray:
    """Steps the block on a floor accelerating from `before` to `after`; returns the force [N] on the floor at the end."""
    ground = block.references(("a_gx", "a_gy"))
    block.slave.setReal(ground, list(before))
    block.slave.setRealInputDerivatives(ground, [1, 1], list((after - before) / h))
    block.slave.doStep(t, h)
    return -block.get(*FORCES)


def couple(h: float, returned: bool, scale: float = 0.8, stop: float = 16.0, tolerance: float = 1e-8) -> History:
    """Runs building and block in steps of `h` [s]; without `returned` the floor does not feel the block.

    All forces of the block in space follow from its state, so that the exchange has no algebraic loop: repeating a step
    from saved states makes acceleration and forces agree to `tolerance` [m/s2] after a few rounds."""
    records = [read_record(path) for path in RECORDS]
    ground = lambda t: scale * np.array([np.interp(t, time, record) for time, record in records])
    building, history = Building(h), History()
    state, before, a = np.zeros(6), np.zeros(4), np.zeros(2)
    velocity, ground_velocity, given, last = np.zeros(2), np.zeros(2), 0.0, np.zeros(2)
    with instance(IN_SPACE, TRANSFORMER, tolerance=1e-9) as block:
        for k in range(round(stop / h)):
            t = k * h
            after = np.concatenate([ground(t + h), before[2:]])
            saved = block.slave.getFMUstate()
            for count in range(1, 31):
                later = building.step(state, before, after)
                a_later, v = building.motion(later, after)
                if count > 1:
                    block.slave.setFMUstate(saved)
                force = block_step(block, t, h, a, a_later)
                agrees = not returned or np.abs(force - after[2:]).max() < tolerance * MASS
                if agrees:
                    break
                after[2:] = force
            assert agrees, f"no agreement at {t:.3f} s"
            block.slave.freeFMUstate(saved)
            # Work of the floor on the block, and what the block received, both from its energies and its motion.
            ground_velocity = ground_velocity + h * (before[:2] + after[:2]) / 2
            v = v + ground_velocity
            given -= h * (last + force) / 2 @ (velocity + v) / 2
            u_dot, w_dot, put_in = block.get("u_dot", "w_dot", "energy.input")
            received = MASS * (np.array([u_dot, w_dot]) @ v + v @ v / 2) + put_in
            history.time.append(t + h)
            history.iterations.append(count)
            history.rows.append((*block.get("tilt", "twist", "drift_x", "drift_y"), *a_later, given, received))
            state, before, a, velocity, last = later, after, a_later, v, force
    return history


def missing(history: History) -> float:
    """Returns the largest difference of the energy given by the floor and received by the block, over the largest received."""
    return np.abs(history["given"] - history["received"]).max() / np.abs(history["received"]).max()


def plot(alone: History, coupled: History, path) -> None:
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    _, axes = plt.subplots(2, 2, figsize=(11, 7), layout="constrained")
    (floor, tilt), (walk, twist) = axes
    for run, label, style in ((alone, "floor does not feel the block", {"color": "0.6"}), (coupled, "reactions returned", {"color": "C0"})):
        floor.plot(run.time, run["a_y"], label=label, lw=0.8, **style)
        tilt.plot(run.time, run["tilt"], label=label, lw=1.0, **style)
        twist.plot(run.time, run["twist"], label=label, lw=1.0, **style)
        walk.plot(1000 * run["drift_x"], 1000 * run["drift_y"], label=label, lw=1.0, **style)
    floor.set(title="Acceleration under the block, along y", xlabel="time [s]", ylabel="m/s²")
    tilt.set(title="Tilt of the block", xlabel="time [s]", ylabel="rad")
    twist.set(title="Twist of the block", xlabel="time [s]", ylabel="rad")
    walk.set(title="Path of the middle of its base on the floor", xlabel="x [mm]", ylabel="y [mm]", aspect="equal")
    for axis in axes.flat:
        axis.grid(alpha=0.3)
        if axis is not walk:
            axis.legend(fontsize=8)
    plt.savefig(path, dpi=90)


def main() -> None:
    arguments = parser(__doc__).parse_args()
    print("scale  step     reactions  rounds  peak tilt   peak twist  peak drift  acceleration y  energy missing at the interface")
    runs = {}
    for scale, steps in ((0.8, (0.01, 0.005, 0.0025)), (1.2, (0.0025,))):
        for h in steps:
            for returned in (False, True):
                run = runs[scale, h, returned] = couple(h, returned, scale)
                drift = np.hypot(run["drift_x"], run["drift_y"]).max()
                print(f"{scale:<5g}  {1000 * h:4.1f} ms  {'returned' if returned else 'kept':9}  {np.mean(run.iterations):6.1f}"
                      f"  {run['tilt'].max():6.4f} rad  {np.abs(run['twist']).max():6.3f} rad  {1000 * drift:7.0f} mm"
                      f"  {np.abs(run['a_y']).max():9.2f} m/s²  {100 * missing(run):8.2f} %")
    plot(runs[0.8, 0.0025, False], runs[0.8, 0.0025, True], picture(arguments, HERE))


if __name__ == "__main__":
    main()
