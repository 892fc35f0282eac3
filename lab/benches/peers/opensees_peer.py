"""Runs a case in OpenSees, as an engineer with a finite-element program but no rocking block would model it.

    opensees_peer.py CASE INTEGRATOR-PENALTY-GRIP STEP time|trace

Prints one line of JSON: the CPU time of the run, or the rotation at multiples of the case's dt.

The block is a mass at its centre and two stiff massless corotational beams to the corners. Each corner rests on a
Kelvin-Voigt pad through a contact that transmits compression only, and grips while it does. PENALTY is the stiffness of
contacts and beams, GRIP the horizontal stiffness of the contacts, both relative to a support; STEP is the time step (s).

OpenSees has no impact map: a landing corner keeps its velocity, as with epsilon = 1. While both corners grip, the block
cannot turn without stretching its base, whereas the model of docs/unit/model.md holds only the middle of the base. GRIP must
therefore be neither small nor large.
"""

import json
import math
import sys
import time
from pathlib import Path

import cases
import openseespy.opensees as ops

CENTRE, LEFT, RIGHT = 1, 2, 3
INTEGRATORS = {"newmark": ("Newmark", 0.5, 0.25), "hht": ("HHT", 0.9), "trbdf2": ("TRBDF2",)}


def build(values, penalty, grip):
    """Builds nodes and elements per unit of the block's mass, and settles them under gravity."""
    alpha, p, gravity, gamma = values["alpha"], values["p"], values["gravity"], values["gamma"]
    r0 = gamma / (1.0 + gamma) * gravity / p**2
    b, h = r0 * math.sin(alpha), r0 * math.cos(alpha)
    omega_v = values["eta"] * p
    k, c = 0.5 * omega_v**2, values["xi_v"] * omega_v
    stiff = penalty * k
    ops.wipe()
    ops.model("basic", "-ndm", 2, "-ndf", 3)
    ops.node(CENTRE, 0.0, h)
    ops.mass(CENTRE, 1.0, 1.0, r0**2 / gamma)
    ops.geomTransf("Corotational", 1)
    ops.uniaxialMaterial("Elastic", 1, k, c)
    ops.uniaxialMaterial("Elastic", 2, stiff)
    for corner, x in ((LEFT, -b), (RIGHT, b)):
        top, ground = corner + 10, corner + 20
        for node in (corner, top, ground):
            ops.node(node, x, 0.0)
        ops.fix(ground, 1, 1, 1)
        ops.fix(top, 1, 0, 1)
        # The axial stiffness is `stiff`, and so is the bending stiffness at the end, 3 EI/L^3.
        ops.element("elasticBeamColumn", corner, CENTRE, corner, stiff * r0, 1.0, stiff * r0**3 / 3.0, 1)
        ops.element("zeroLengthContactASDimplex", top, top, corner, stiff, grip * k, 1e6, "-orient", 0.0, 1.0, 0.0)
        ops.element("zeroLength", ground, ground, top, "-mat", 1, "-dir", 2)
    ops.timeSeries("Linear", 1)
    ops.pattern("Plain", 1, 1)
    ops.load(CENTRE, 0.0, -gravity, 0.0)
    ops.constraints("Plain")
    ops.numberer("Plain")
    ops.system("BandGeneral")
    ops.test("NormDispIncr", 1e-12 * b, 100)
    ops.algorithm("Newton")
    ops.integrator("LoadControl", 0.1)
    ops.analysis("Static", "-noWarnings")
    if ops.analyze(10) != 0:
        raise RuntimeError("the block does not settle under gravity")
    ops.loadConst("-time", 0.0)


def run(values, integrator, step):
    """Runs the case; returns CPU time, number of steps, and the rotation (clockwise) at multiples of dt."""
    ops.timeSeries("Trig", 2, 0.0, 2.0 * math.pi / values["omega_p"], 2.0 * math.pi / values["omega_p"],
                   "-factor", values["a_p"])
    ops.pattern("UniformExcitation", 2, 1, "-accel", 2)
    ops.wipeAnalysis()
    ops.constraints("Plain")
    ops.numberer("Plain")
    ops.system("BandGeneral")
    ops.test("NormDispIncr", 1e-12, 50)
    ops.algorithm("Newton")
    ops.integrator(*INTEGRATORS[integrator])
    ops.analysis("Transient", "-noWarnings")
    before = time.process_time()
    start = ops.nodeDisp(CENTRE, 3)
    theta = [0.0]
    steps = round(values["dt"] / step)
    for row in range(1, round(values["t_end"] / values["dt"]) + 1):
        if ops.analyze(steps, values["dt"] / steps) != 0:
            raise RuntimeError(f"no convergence before t = {row * values['dt']:g} s")
        theta.append(start - ops.nodeDisp(CENTRE, 3))
    return time.process_time() - before, steps * (len(theta) - 1), theta


def main():
    path, method, step, task, *_ = sys.argv[1:]
    values, _ = cases.read(Path(path))
    integrator, penalty, grip = method.split("-")
    try:
        build(values, float(penalty), float(grip))
        cpu, steps, theta = run(values, integrator, float(step))
        done = {"theta": theta} if task == "trace" else {"cpu": cpu, "rhs": 0, "steps": steps, "events": 0}
        print(json.dumps(done))
    except RuntimeError as error:
        print(json.dumps({"error": str(error)}))


if __name__ == "__main__":
    main()
