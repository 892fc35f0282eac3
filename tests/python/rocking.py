"""Drives the FMU step by step with fmpy, following a record exactly: its value and its slope are set before each step.

`fmpy.simulate_fmu(..., set_input_derivatives=True)` is not used for this: up to fmpy 0.3.32 it fails unless the FMU has
exactly nine inputs, and at a sample of the record it takes the slope that ends there, not the one that begins.
"""

import shutil
from contextlib import contextmanager

import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave


@contextmanager
def instance(fmu, start_values=None, tolerance=None, stop_time=None):
    """An initialized instance of the FMU, and its value references by name."""
    description = read_model_description(fmu)
    variables = {variable.name: variable for variable in description.modelVariables}
    references = {name: variable.valueReference for name, variable in variables.items()}
    folder = extract(fmu)
    slave = FMU2Slave(
        guid=description.guid,
        unzipDirectory=folder,
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="block",
    )
    slave.instantiate()
    try:
        slave.setupExperiment(tolerance=tolerance, startTime=0.0, stopTime=stop_time)
        for name, value in (start_values or {}).items():
            setter = {
                "Real": slave.setReal,
                "Integer": slave.setInteger,
                "Boolean": slave.setBoolean,
                "String": slave.setString,
            }[variables[name].type]
            setter([references[name]], [value])
        slave.enterInitializationMode()
        slave.exitInitializationMode()
        yield slave, references
        slave.terminate()
    finally:
        slave.freeInstance()
        shutil.rmtree(folder, ignore_errors=True)


def follow(fmu, dt, a_gx, parts=1, outputs=("theta",), tolerance=None, start_values=None):
    """Runs the FMU under a record with samples `a_gx` [m/s2] every `dt` [s], linear in between, in communication steps
    of `dt / parts`. Returns the times and, for each output, its values at the record's samples."""
    with instance(fmu, start_values, tolerance) as (slave, references):
        ground = [references["a_gx"]]
        wanted = [references[name] for name in outputs]
        rows = [slave.getReal(wanted)]
        for i, (a, b) in enumerate(zip(a_gx[:-1], a_gx[1:])):
            for k in range(parts):
                slave.setReal(ground, [a + (b - a) * k / parts])
                slave.setRealInputDerivatives(ground, [1], [(b - a) / dt])
                slave.doStep((i * parts + k) * dt / parts, dt / parts)
            rows.append(slave.getReal(wanted))
    return dt * np.arange(len(a_gx)), np.array(rows)
