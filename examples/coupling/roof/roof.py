"""A block as equipment on the roof of a frame in an earthquake: two FMUs, two ways of exchange.

    python examples/coupling/roof/roof.py

Writes roof.png to the folder in which it is started (with --update, result.png beside this file), and prints the
README's table.
"""

import sys
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1]))
from common import BLOCK, Instance, instance, parser, picture, read_record

MASS, GRAVITY = 1500.0, 9.81  # kg, m/s2
WEIGHT = MASS * GRAVITY
# Equipment 0.6 m wide and 1.8 m high on pads. With epsilon = 1 a landing corner keeps its velocity and is stopped by spring
# and dashpot alone, so that H and N contain the whole effect of an impact on the roof.
EQUIPMENT = {
    "parameterization": 2,
    "physical.width": 0.6,
    "physical.height": 1.8,
    "physical.K": 2.0e6,
    "physical.C": 1.0e4,
    "mass": MASS,
    "epsilon": 1.0,
    "on_separation": 3,
}
FORCES = ("H", "N_L", "N_R")
# Signs of H, N_L, N_R on the roof: a force to the right on the block acts to the left on the roof, and N acts downwards.
ON_ROOF = np.array([[-1.0, 0.0, 0.0], [0.0, -1.0, -1.0]])


@dataclass
class History:
    h: float  # s
    time: list = field(default_factory=list)
    rows: dict = field(default_factory=dict)
    iterations: list = field(default_factory=list)
    diverged: bool = False
    dashpots: float = 0.0  # J, lost in the block's dashpots
    impacts: float = 0.0  # J, lost at its changes of regime

    def add(self, **values):
        for name, value in values.items():
            self.rows.setdefault(name, []).append(value)

    def __getitem__(self, name) -> np.ndarray:
        return np.array(self.rows[name])


def build_frame(folder) -> Path:
    """Packs the frame as an FMU."""
    from pythonfmu.builder import FmuBuilder

    return FmuBuilder.build_FMU(HERE / "frame.py", dest=folder, project_files=[HERE / "opensees_worker.py"],
                                canGetAndSetFMUstate=True, canHandleVariableCommunicationStepSize=True)


def roof_step(frame: Instance, t: float, h: float, a_base: float, force) -> np.ndarray:
    """Steps the frame; returns the roof's acceleration [m/s2] at the end of the step."""
    frame.set(a_base=a_base, F_x=force[0], F_z=force[1])
    frame.slave.doStep(t, h)
    return frame.get("a_x", "a_z")


def block_step(block: Instance, t: float, h: float, before, after) -> np.ndarray:
    """Steps the block on a roof accelerating from `before` to `after`; returns the force [N] on the roof at the end."""
    ground = block.references(("a_gx", "a_gz"))
    block.slave.setReal(ground, list(before))
    block.slave.setRealInputDerivatives(ground, [1, 1], list((after - before) / h))
    block.slave.doStep(t, h)
    block.slave.setReal(ground, list(after))
    return ON_ROOF @ block.get(*FORCES)


def flexibility(frame: Instance, h: float, force) -> np.ndarray:
    """Returns the effect of a force on the roof's acceleration at the end of a step, from steps that are undone."""
    state = frame.slave.getFMUstate()
    ends = []
    for extra in ((0.0, 0.0), (1000.0, 0.0), (0.0, 1000.0)):
        ends.append(roof_step(frame, 0.0, h, 0.0, force + extra))
        frame.slave.setFMUstate(state)
    frame.slave.freeFMUstate(state)
    return np.array([ends[1] - ends[0], ends[2] - ends[0]]).T / 1000


def iterate(frame: Instance, block: Instance, t, h, a_base, a, mobility, tolerance, most, derivatives):
    """Takes one step after which the roof's acceleration and the block's force agree: Newton's method for
    `x - roof(force(x)) = 0` with the block's derivatives at the end of the step. Broyden's update learns the part that
    they omit, the motion within the step, from the residuals. Without derivatives it is the plain iteration
    `x = roof(force(x))`. Returns acceleration, force, count, agreement."""
    start = frame.slave.getFMUstate(), block.slave.getFMUstate()
    x, jacobian, step, last = a.copy(), None, None, None
    for count in range(1, most + 1):
        if count > 1:
            frame.slave.setFMUstate(start[0])
            block.slave.setFMUstate(start[1])
        force = block_step(block, t, h, a, x)
        residual = x - roof_step(frame, t, h, a_base, force)
        if not np.all(np.isfinite(residual)) or np.abs(residual).max() < tolerance:
            break
        if not derivatives:
            jacobian = np.eye(2)
        elif jacobian is None:
            reaction = ON_ROOF @ block.derivatives(FORCES, ("a_gx", "a_gz"))
            jacobian = np.eye(2) - mobility @ reaction
        else:
            jacobian += np.outer(residual - last - jacobian @ step, step) / (step @ step)
        step = -np.linalg.solve(jacobian, residual)
        last, x = residual, x + step
    frame.slave.freeFMUstate(start[0])
    block.slave.freeFMUstate(start[1])
    return x, force, count, np.abs(residual).max()


def couple(frame_fmu, h: float, stop: float, iterated: bool, scale: float = 1.8, tolerance: float = 1e-7,
           most: int = 30, begin: float = 3.5, start_values=None, derivatives: bool = True) -> History:
    """Runs frame and block under the record, times `scale`, from `begin` [s] on, to `stop` [s], in steps of `h` [s].

    Explicit: the frame steps with the force of the step before, then the block with the roof's motion. Iterated: both
    step again until they agree to `tolerance` [m/s2]."""
    time, record = read_record()
    sample = lambda t: scale * np.interp(t, time - begin, record)
    history = History(h)
    with (instance(frame_fmu, {"F_z": -WEIGHT}) as frame,
          instance(BLOCK, EQUIPMENT | (start_values or {}), tolerance=1e-10) as block):
        force = ON_ROOF @ block.get(*FORCES)
        mobility = flexibility(frame, h, force) if iterated else None
        a, a_base = np.zeros(2), 0.0
        base_velocity, velocity = 0.0, np.zeros(2)
        frame_work = block_work = height = 0.0
        impulse = np.zeros(2)
        loads, count, agreement = force, 0, 0.0

        for k in range(round(stop / h)):
            t = k * h
            a_base_next = sample(t + h)
            try:
                if iterated:
                    a_next, force, count, agreement = iterate(
                        frame, block, t, h, a_base_next, a, mobility, tolerance, most, derivatives)
                    loads_next = force
                else:
                    loads_next = force
                    a_next = roof_step(frame, t, h, a_base_next, force)
                    if np.abs(a_next).max() > 1e4:
                        raise ArithmeticError("the roof's acceleration grows without bound")
                    force = block_step(block, t, h, a, a_next)
            except Exception as error:
                print(f"  stopped at {t:.3f} s: {str(error).splitlines()[0]}")
                history.diverged = True
                break

            # The frame's side of the interface: its force times its displacement, as Newmark's method sees them.
            base_next = base_velocity + h * (a_base + a_base_next) / 2
            v_x, v_z, u_x, shear = frame.get("v_x", "v_z", "u_x", "shear")
            roof = np.array([v_x + base_next, v_z])
            frame_work += (loads + loads_next) / 2 @ (velocity + roof) * h / 2
            # The block's side, from its own sums: d/dt of the kinetic energy that the moving frame of reference adds.
            u_dot, v_dot, put_in, theta = block.get("u_dot", "v_dot", "energy.input", "theta")
            height += h * velocity[1] + h * h * (2 * a[1] + a_next[1]) / 6
            relative = np.array([u_dot, v_dot])
            block_work = MASS * (relative @ roof + roof @ roof / 2 + GRAVITY * height) + put_in
            # The block's actual momentum, and the momentum according to the exchanged forces.
            momentum = MASS * (relative + roof)
            impulse = impulse - h * (loads + loads_next) / 2 - np.array([0.0, WEIGHT * h])

            history.time.append(t + h)
            history.iterations.append(count)
            history.add(a_x=a_next[0], a_z=a_next[1], u_x=u_x, shear=shear, theta=theta, H=-force[0], N=-force[1],
                        frame_work=frame_work, block_work=block_work, agreement=agreement,
                        lost_momentum=momentum - impulse, base=a_base_next)
            a, a_base, base_velocity, velocity, loads = a_next, a_base_next, base_next, roof, loads_next
        history.dashpots, history.impacts = block.get("energy.dashpots", "energy.impacts")
    return history


def missing(history: History) -> float:
    """Returns the largest difference of the energy received by the block and given by the frame, over the largest exchanged."""
    return np.abs(history["frame_work"] + history["block_work"]).max() / np.abs(history["block_work"]).max()


def plot(runs: dict[tuple[bool, float], History], path) -> None:
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    _, axes = plt.subplots(2, 2, figsize=(11, 7), layout="constrained")
    (top, hysteresis), (rotation, energy) = axes
    finest = min(h for iterated, h in runs if iterated)
    for (iterated, h), run in runs.items():
        label = f"{'iterated' if iterated else 'explicit'}, {1000 * h:g} ms"
        style = {"ls": "-" if iterated else "--", "lw": 1.6 if (iterated, h) == (True, finest) else 1.0}
        line, = rotation.plot(run.time, run["theta"], label=label, **style)
        style["color"] = line.get_color()
        energy.semilogy(run.time, np.maximum(np.abs(run["frame_work"] + run["block_work"]), 1e-3), label=label, **style)
    best = runs[True, finest]
    top.plot(best.time, best["base"], color="0.6", lw=0.8, label="ground")
    top.plot(best.time, best["a_x"], lw=0.9, label="roof")
    top.set(title="Horizontal acceleration (iterated)", xlabel="time [s]", ylabel="m/s²")
    hysteresis.plot(1000 * best["u_x"], best["shear"] / 1000, lw=0.8)
    hysteresis.set(title="Columns: they yield", xlabel="drift [mm]", ylabel="shear [kN]")
    rotation.set(title="Rotation of the block", xlabel="time [s]", ylabel="rad", ylim=(-0.3, 0.3))
    energy.set(title="Energy gained or lost at the interface", xlabel="time [s]", ylabel="J")
    for axis in (top, rotation):
        axis.legend(fontsize=8, loc="lower left")
    for axis in axes.flat:
        axis.grid(alpha=0.3)
    plt.savefig(path, dpi=90)


def main() -> None:
    arguments = parser(__doc__).parse_args()
    with tempfile.TemporaryDirectory() as folder:
        frame = build_frame(folder)
        runs = {}
        print("exchange   step   iterations  greatest rotation  energy missing at the interface  lost in the dashpots")
        for h in (0.02, 0.01, 0.005):
            for iterated in (False, True):
                run = runs[iterated, h] = couple(frame, h, 6.0, iterated)
                print(f"{'iterated' if iterated else 'explicit'}  {1000 * h:4.0f} ms  {np.mean(run.iterations):7.1f}"
                      f"  {np.abs(run['theta']).max():13.4f} rad  {100 * missing(run):20.2f} %  {run.dashpots:28.0f} J")
    plot(runs, picture(arguments, HERE))


if __name__ == "__main__":
    main()
