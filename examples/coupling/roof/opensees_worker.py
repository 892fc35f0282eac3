"""A steel frame in OpenSees, in a separate process that can be copied.

OpenSees keeps one model per process and commits every step; its `database` and `restore` do not restore a transient
analysis. `fork` does: a copy of the process waits on a socket until its state is needed, with everything in it (fibres,
integrator, loads) unchanged to the last bit. Linux and macOS only.

The frame: two steel columns 3 m high, fixed at their feet, 140 mm x 11.5 mm, fibre sections of Steel02 (yield 235 MPa, 2 %
hardening), P-Delta; a roof that stays level, with a slab between the columns that is flexible vertically. Newmark's method of
average acceleration. Motions are relative to the ground. SI units.
"""

import ctypes
import importlib.util
import json
import os
import select
import signal
import socket
import sys
from pathlib import Path

HEIGHT, SPAN = 3.0, 4.0  # m
EDGE_MASS, SLAB_MASS = 400.0, 1000.0  # kg, at each column and in the middle
DEPTH, WIDTH = 0.14, 0.0115  # m, of a column
YIELD, MODULUS = 235e6, 200e9  # Pa
SLAB_FREQUENCY = 80.0  # rad/s, of the bare slab
DAMPING = 0.004  # s, stiffness-proportional: 2 % at 10 rad/s
GRAVITY = 9.81  # m/s2
SLAB = 5
MASSES = {3: EDGE_MASS, 4: EDGE_MASS, SLAB: SLAB_MASS}


def load_opensees():
    """Returns OpenSees's module. Its LAPACK does not find the BLAS beside it, so the BLAS is loaded first."""
    package = importlib.util.find_spec("openseespylinux")
    if package is not None:
        ctypes.CDLL(str(Path(package.origin).parent / "lib/libblas.so.3"), mode=ctypes.RTLD_GLOBAL)
    import openseespy.opensees

    return openseespy.opensees


class Frame:
    def __init__(self, ops, f_x: float, f_z: float):
        """Builds the frame, at rest under its weight and the force [N] on the roof."""
        self.ops = ops
        ops.wipe()
        ops.model("basic", "-ndm", 2, "-ndf", 3)
        for node, x, z in ((1, 0.0, 0.0), (2, SPAN, 0.0), (3, 0.0, HEIGHT), (4, SPAN, HEIGHT), (SLAB, SPAN / 2, HEIGHT)):
            ops.node(node, x, z)
        for foot in (1, 2):
            ops.fix(foot, 1, 1, 1)
        for node, mass in MASSES.items():
            ops.mass(node, mass, mass, 0.0)
            ops.fix(node, 0, 0, 1)
        for edge in (3, 4):
            ops.equalDOF(SLAB, edge, 1)
        ops.geomTransf("PDelta", 1)
        ops.geomTransf("Linear", 2)
        ops.uniaxialMaterial("Steel02", 1, YIELD, MODULUS, 0.02, 15.0, 0.925, 0.15)
        ops.section("Fiber", 1)
        ops.patch("rect", 1, 12, 1, -DEPTH / 2, -WIDTH / 2, DEPTH / 2, WIDTH / 2)
        ops.beamIntegration("Lobatto", 1, 1, 5)
        for column, (foot, head) in enumerate(((1, 3), (2, 4)), 1):
            ops.element("forceBeamColumn", column, foot, head, 1, 1)
        # Two beams with level ends: 24 E I / l^3 is the slab's stiffness.
        inertia = SLAB_MASS * SLAB_FREQUENCY**2 * (SPAN / 2) ** 3 / (24 * MODULUS)
        for beam, (left, right) in enumerate(((3, SLAB), (SLAB, 4)), 3):
            ops.element("elasticBeamColumn", beam, left, right, 0.01, MODULUS, inertia, 2)
        ops.rayleigh(0.0, 0.0, DAMPING, 0.0)
        ops.timeSeries("Constant", 1)
        ops.pattern("Plain", 1, 1)
        for node, mass in MASSES.items():
            ops.load(node, 0.0, -mass * GRAVITY, 0.0)
        self.apply(0.0, f_x, f_z)
        ops.constraints("Transformation")
        ops.numberer("RCM")
        ops.system("BandGeneral")
        ops.test("NormDispIncr", 1e-13, 50)
        ops.algorithm("Newton")
        ops.integrator("LoadControl", 0.0)
        ops.analysis("Static")
        self.advance(ops.analyze(1))
        self.rest = ops.nodeDisp(SLAB, 1), ops.nodeDisp(SLAB, 2)
        ops.wipeAnalysis()
        ops.constraints("Transformation")
        ops.numberer("RCM")
        ops.system("BandGeneral")
        ops.test("NormDispIncr", 1e-13, 50)
        ops.algorithm("Newton")
        ops.integrator("Newmark", 0.5, 0.25)
        ops.analysis("Transient")

    @staticmethod
    def advance(failed: int) -> None:
        if failed:
            raise RuntimeError("OpenSees finds no equilibrium")

    def apply(self, a_base: float, f_x: float, f_z: float) -> None:
        """Sets the ground acceleration [m/s2] and the force on the slab [N] at the end of the next step."""
        self.ops.pattern("Plain", 2, 1)
        for node, mass in MASSES.items():
            self.ops.load(node, -mass * a_base + (f_x if node == SLAB else 0.0), f_z if node == SLAB else 0.0, 0.0)

    def step(self, h: float, a_base: float, f_x: float, f_z: float) -> list[float]:
        self.ops.remove("loadPattern", 2)
        self.apply(a_base, f_x, f_z)
        self.advance(self.ops.analyze(1, h))
        return self.outputs(a_base)

    def outputs(self, a_base: float) -> list[float]:
        """Returns a_x, a_z (absolute), v_x, v_z, u_x, u_z of the slab from its position at rest, and the shear of both columns."""
        (u_x, u_z, _), (v_x, v_z, _), (a_x, a_z, _) = (get(SLAB) for get in (
            self.ops.nodeDisp, self.ops.nodeVel, self.ops.nodeAccel))
        shear = sum(self.ops.eleResponse(column, "globalForce")[3] for column in (1, 2))
        return [a_x + a_base, a_z, v_x, v_z, u_x - self.rest[0], u_z - self.rest[1], shear]


def wait(listener: socket.socket) -> socket.socket:
    """Serves a saved state: waits for requests and answers each with a copy of itself. Ends with its host."""
    while True:
        ready, _, _ = select.select([listener, sys.stdin], [], [])
        if sys.stdin in ready:
            os._exit(0)
        connection, _ = listener.accept()
        if connection.recv(1) != b"r":
            os._exit(0)
        if os.fork() == 0:
            listener.close()
            return connection
        connection.close()


def serve(connection: socket.socket) -> None:
    """Answers commands, one line each, until the host hangs up."""
    ops, frame = load_opensees(), None
    lines = connection.makefile("r")
    while True:
        ready, _, _ = select.select([connection, sys.stdin], [], [])
        line = lines.readline() if connection in ready else ""
        if not line:
            os._exit(0)
        command, *values = json.loads(line)
        try:
            if command == "start":
                frame = Frame(ops, *values)
                answer = frame.outputs(0.0)
            elif command == "step":
                answer = frame.step(*values)
            else:  # save
                listener = socket.socket(socket.AF_UNIX)
                listener.bind(values[0])
                listener.listen()
                answer = None
                if os.fork() == 0:
                    lines.close()
                    connection.close()
                    connection = wait(listener)
                    lines = connection.makefile("r")
                    continue
                listener.close()
        except Exception as error:
            answer = {"error": str(error)}
        connection.sendall((json.dumps(answer) + "\n").encode())


if __name__ == "__main__":
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)
    serve(socket.socket(fileno=int(sys.argv[1])))
