"""The same block, released at a tilt, in one statement each of fmpy, libcosimpy, ecospy and fmi-sim.

    python examples/coupling/one_line/one_line.py

Each function gives the rotation [rad] after every step of 10 ms. Writes one_line.png to the folder in which it is started;
with --update, result.png beside this file.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1]))
from common import BLOCK, load_tbb, parser, picture

START = {"initial.theta": 0.15}
STOP, STEP = 10.0, 0.01  # s


def with_fmpy() -> np.ndarray:
    from fmpy import simulate_fmu

    return simulate_fmu(BLOCK, start_values=START, stop_time=STOP, output_interval=STEP, output=["theta"])["theta"][1:]


def with_libcosimpy() -> np.ndarray:
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    log_output_level(CosimLogLevel.ERROR)
    execution, observer = CosimExecution.from_step_size(1e9 * STEP), CosimObserver.create_last_value()  # ns
    block = execution.add_local_slave(CosimLocalSlave(str(BLOCK), "block"))
    references = {variable.name.decode(): variable.reference for variable in execution.slave_variables(block)}
    execution.add_observer(observer)
    set_value = {float: execution.real_initial_value, int: execution.integer_initial_value, str: execution.string_initial_value}
    for name, value in START.items():
        set_value[type(value)](block, references[name], value)
    theta = []
    while len(theta) < round(STOP / STEP):
        if not execution.step():
            raise RuntimeError("libcosim stopped")
        theta += observer.last_real_values(block, [references["theta"]])
    return np.array(theta)


def with_ecospy() -> np.ndarray:
    load_tbb()
    from ecospy import EcosSimulation, EcosSimulationStructure

    with EcosSimulationStructure() as structure:
        structure.add_model("block", str(BLOCK))
        structure.add_parameter_set("start", {f"block::{name}": value for name, value in START.items()})
        with EcosSimulation(structure=structure, step_size=STEP) as simulation:
            simulation.init(parameter_set="start")
            return np.array([simulation.step() and simulation.get_real("block::theta") for _ in range(round(STOP / STEP))])


def with_fmi_sim() -> np.ndarray:
    with tempfile.TemporaryDirectory() as folder:
        table = Path(folder, "table.csv")
        values = [f"--init-values={name}={value}" for name, value in START.items()]
        subprocess.run(["fmi-sim", "--model", BLOCK, "-o", table, "co-simulation", *values, f"--step={STEP}",
                        f"--output-interval={STEP}", f"-f{STOP}"], check=True, stdout=subprocess.DEVNULL)
        return np.genfromtxt(table, delimiter=",", names=True)["theta"][1:]


MASTERS = {"fmpy": with_fmpy, "libcosimpy": with_libcosimpy, "ecospy": with_ecospy, "fmi-sim": with_fmi_sim}


def main() -> None:
    arguments = parser(__doc__).parse_args()
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    _, axis = plt.subplots(figsize=(9, 4), layout="constrained")
    expected = with_fmpy()
    axis.plot(STEP * np.arange(1, len(expected) + 1), expected, color="0.7", lw=4, label="fmpy")
    for k, (name, run) in enumerate(list(MASTERS.items())[1:]):
        try:
            theta = run()
        except (ImportError, FileNotFoundError, OSError) as error:
            print(f"{name}: not installed ({error})")
            continue
        print(f"{name}: differs from fmpy by at most {np.abs(theta - expected).max():.1e} rad")
        places = slice(10 * k, None, 30)
        axis.plot(STEP * np.arange(1, len(theta) + 1)[places], theta[places], "osd"[k], ms=4, label=name)
    axis.set(xlabel="time [s]", ylabel="rotation [rad]")
    axis.grid(alpha=0.3)
    axis.legend()
    plt.savefig(picture(arguments, HERE), dpi=90)


if __name__ == "__main__":
    main()
