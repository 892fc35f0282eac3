"""Shared by the examples: paths of FMU and program, an FMU instance in fmpy, and an earthquake."""

import argparse
import ctypes
import os
import shutil
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

ROOT = Path(__file__).resolve().parents[1]
BLOCK = Path(os.environ.get("ROCKING_BLOCK_FMU", ROOT / "target/release/RockingBlock.fmu"))
ROCKING = Path(os.environ.get("ROCKING", ROOT / "target/release/rocking"))
RECORD = ROOT / "examples/records/np01002p_4225a_a.smc"


class Instance:
    """A Co-Simulation FMU in fmpy, with variables by name."""

    def __init__(self, path, start_values=None, tolerance=None, initialize=True):
        description = read_model_description(path)
        self.variables = {variable.name: variable for variable in description.modelVariables}
        self.folder = extract(path)
        self.slave = FMU2Slave(
            guid=description.guid,
            unzipDirectory=self.folder,
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName=description.modelName,
        )
        self.slave.instantiate()
        self.slave.setupExperiment(startTime=0.0, tolerance=tolerance)
        self.set(**(start_values or {}))
        self.slave.enterInitializationMode()
        if initialize:
            self.slave.exitInitializationMode()

    def references(self, names):
        return [self.variables[name].valueReference for name in names]

    def set(self, **values):
        for name, value in values.items():
            variable = self.variables[name]
            setter = {"Real": self.slave.setReal, "Boolean": self.slave.setBoolean}.get(variable.type, self.slave.setInteger)
            setter([variable.valueReference], [value])

    def get(self, *names) -> np.ndarray:
        return np.array(self.slave.getReal(self.references(names)))

    def derivatives(self, outputs, inputs) -> np.ndarray:
        """Returns the matrix of derivatives of `outputs` with respect to `inputs`."""
        known, unknown = self.references(inputs), self.references(outputs)
        columns = [self.slave.getDirectionalDerivative(unknown, [reference], [1.0]) for reference in known]
        return np.array(columns).T

    def close(self):
        self.slave.terminate()
        self.slave.freeInstance()
        shutil.rmtree(self.folder, ignore_errors=True)


@contextmanager
def instance(path, start_values=None, tolerance=None):
    opened = Instance(path, start_values, tolerance)
    try:
        yield opened
    finally:
        opened.close()


def read_record(path=RECORD, *options) -> tuple[np.ndarray, np.ndarray]:
    """Returns times [s] and accelerations [m/s2] of a record in any format that `rocking` reads.

    `options` are those of `rocking record`, such as "--unit=g".
    """
    run = subprocess.run([ROCKING, "record", path, "--csv=-", *options], capture_output=True, text=True)
    if run.returncode != 0:
        raise ValueError(run.stderr.strip())
    rows = [line for line in run.stdout.splitlines() if not line.startswith("#")]
    return tuple(np.loadtxt(rows, delimiter=",", skiprows=1, unpack=True))


def picture(arguments: argparse.Namespace, folder: Path) -> Path:
    """Returns the path of the example's picture: in the working directory, or on the example's page."""
    return folder / "result.png" if arguments.update else Path(f"{folder.name}.png")


def parser(description: str) -> argparse.ArgumentParser:
    """Returns a parser with the options common to all coupling examples."""
    found = argparse.ArgumentParser(description=description.splitlines()[0])
    found.add_argument("--update", action="store_true", help="renew the picture of this example's page")
    return found


def load_tbb() -> None:
    """Loads TBB for Ecos's library: its package lacks TBB, and the package `tbb` installs it where no loader looks."""
    if sys.platform == "linux":
        path = Path(sys.prefix, "lib/libtbb.so.12")
        ctypes.CDLL(str(path if path.exists() else "libtbb.so.12"), mode=ctypes.RTLD_GLOBAL)
