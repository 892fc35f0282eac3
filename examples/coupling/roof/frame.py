"""The steel frame of `opensees_worker.py` as an FMU, made with pythonfmu.

Ground acceleration and the force on the roof go in; the motion of the roof comes out. Its state can be saved and restored.
"""

import json
import os
import shutil
import socket
import subprocess
import sys
import tempfile
from itertools import count
from pathlib import Path

from pythonfmu import Fmi2Causality, Fmi2Slave, Real

INPUTS = {"a_base": "Ground acceleration [m/s2]", "F_x": "Force on the roof, to the right [N]", "F_z": "Force on the roof, up [N]"}
OUTPUTS = {
    "a_x": "Absolute horizontal acceleration of the roof [m/s2]",
    "a_z": "Absolute vertical acceleration of the roof [m/s2]",
    "v_x": "Horizontal velocity of the roof relative to the ground [m/s]",
    "v_z": "Vertical velocity of the roof [m/s]",
    "u_x": "Horizontal displacement of the roof relative to the ground [m]",
    "u_z": "Vertical displacement of the roof from rest [m]",
    "shear": "Horizontal force of the columns on the roof, to the right [N]",
}


class Saved:
    """A waiting copy of the worker; it ends with the last reference to it."""

    def __init__(self, path: str):
        self.path = path

    def ask(self, what: bytes) -> socket.socket:
        connection = socket.socket(socket.AF_UNIX)
        connection.connect(self.path)
        connection.sendall(what)
        return connection

    def __del__(self):
        try:
            self.ask(b"q").close()
            os.unlink(self.path)
        except OSError:
            pass  # The worker has already ended.


class Frame(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.description = "A steel frame with yielding columns, in OpenSees"
        for name, text in INPUTS.items():
            setattr(self, name, 0.0)
            self.register_variable(Real(name, causality=Fmi2Causality.input, description=text, start=0.0))
        for name, text in OUTPUTS.items():
            setattr(self, name, 0.0)
            self.register_variable(Real(name, causality=Fmi2Causality.output, description=text))
        self.worker = None

    def call(self, *command):
        self.connection.sendall((json.dumps(command) + "\n").encode())
        answer = json.loads(self.lines.readline() or '{"error": "OpenSees has ended"}')
        if isinstance(answer, dict):
            raise RuntimeError(answer["error"])
        return answer

    def connect(self, connection: socket.socket) -> None:
        self.connection, self.lines = connection, connection.makefile("r")

    def read(self, answer) -> None:
        for name, value in zip(OUTPUTS, answer, strict=True):
            setattr(self, name, value)

    def exit_initialization_mode(self):
        self.folder, self.names = tempfile.mkdtemp(prefix="frame"), count()
        here, there = socket.socketpair()
        script = Path(__file__).with_name("opensees_worker.py")
        # The worker and its copies end with their standard input, even if this process is killed.
        self.worker = subprocess.Popen([sys.executable, str(script), str(there.fileno())], stdin=subprocess.PIPE,
                                       pass_fds=[there.fileno()])
        there.close()
        self.connect(here)
        self.read(self.call("start", self.F_x, self.F_z))

    def do_step(self, current_time, step_size):
        self.read(self.call("step", step_size, self.a_base, self.F_x, self.F_z))
        return True

    def _get_fmu_state(self):
        state = super()._get_fmu_state()
        path = f"{self.folder}/{next(self.names)}"
        self.call("save", path)
        return {"saved": Saved(path), "values": state}

    def _set_fmu_state(self, state):
        self.lines.close()
        self.connection.close()
        self.connect(state["saved"].ask(b"r"))
        super()._set_fmu_state(state["values"])

    def terminate(self):
        if self.worker:
            self.lines.close()
            self.connection.close()
            self.worker.stdin.close()
            self.worker.wait()
            self.worker = None
            shutil.rmtree(self.folder, ignore_errors=True)
