"""A cabinet on the roof of a frame: OpenSees computes the roof's acceleration, under which the cabinet rocks.

The cabinet is light and does not act on the frame; examples/coupling/roof has a block that does.

python examples/python/opensees_frame.py
"""

import sys
from math import tau
from pathlib import Path

import rocking_block as rb

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "examples/coupling/roof"))
from opensees_worker import load_opensees

ops, ground = load_opensees(), rb.read_record(ROOT / "examples/records/np01002p_4225a_a.smc").scaled(2)
# A storey of 100 t with a period of 0.5 s that yields at 0.3 of its weight; 3 % damping.
mass, omega = 100e3, tau / 0.5
ops.wipe()
ops.model("basic", "-ndm", 1, "-ndf", 1)
ops.node(1, 0.0)
ops.node(2, 0.0, "-mass", mass)
ops.fix(1, 1)
ops.uniaxialMaterial("Steel01", 1, 0.3 * 9.81 * mass, mass * omega**2, 0.03)
ops.element("zeroLength", 1, 1, 2, "-mat", 1, "-dir", 1, "-doRayleigh", 1)
ops.rayleigh(2 * 0.03 * omega, 0.0, 0.0, 0.0)
ops.timeSeries("Path", 1, "-dt", ground.dt, "-values", *ground.acceleration)
ops.pattern("UniformExcitation", 1, 1, "-accel", 1)
ops.integrator("Newmark", 0.5, 0.25)
ops.analysis("Transient", "-noWarnings")
roof = [ground.acceleration[0]]
for k in range(1, len(ground)):
    assert ops.analyze(1, ground.dt) == 0, f"OpenSees found no equilibrium at t = {ground.t[k]} s"
    roof.append(ops.nodeAccel(2, 1) + ground.acceleration[k])

cabinet = rb.Block(width=0.6, height=2.2, K=4e5, C=4e3, mass=300)
for motion in (ground, rb.Record(roof, ground.dt, "roof")):
    print(f"PGA {motion.pga:.2f} m/s²: {cabinet.run(motion)}")
