"""A block on the floor of an elastic storey in an earthquake: an SSP package with its parameters in .ssv files.

    python examples/ssp/floor.py [FOLDER]

Builds the package, runs it in fmpy, libcosim and Ecos, and prints the largest rotations. A folder keeps floor.ssp.
"""

import argparse
import sys
import tempfile
import zipfile
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent), str(HERE.parent / "coupling/bridge")]
import bridge
from common import BLOCK

FILES = ("block.ssv", "storey.ssv")
WATCHED = {"storey": ("a", "u"), "block": ("theta",)}
SCALE, BEGIN = 0.8, 3.0  # factor of the record, and its beginning [s]


def build(folder) -> Path:
    """Builds floor.ssp: two small FMUs made with pythonfmu, the block, the structure and its parameters."""
    from pythonfmu.builder import FmuBuilder

    package = Path(folder) / "floor.ssp"
    with tempfile.TemporaryDirectory() as made, zipfile.ZipFile(package, "w") as ssp:
        ssp.write(HERE / "SystemStructure.ssd", "SystemStructure.ssd")
        for name in FILES:
            ssp.write(HERE / name, f"resources/{name}")
        ssp.write(BLOCK, "resources/RockingBlock.fmu")
        ssp.write(bridge.build_ground(made, *bridge.earthquake(SCALE, BEGIN)), "resources/Ground.fmu")
        ssp.write(FmuBuilder.build_FMU(HERE / "storey.py", dest=made, canHandleVariableCommunicationStepSize=True), "resources/Storey.fmu")
    return package


def run_fmpy(package, h: float, stop: float) -> dict[str, np.ndarray]:
    """Runs the package in fmpy, which takes the parameters as one set with the names of the components in front."""
    from fmpy.ssp.simulation import simulate_ssp
    from fmpy.ssp.ssd import ParameterSet, read_ssd

    parameters = ParameterSet(name="all")
    for component in read_ssd(package).system.elements:
        for binding in component.parameterBindings:
            for values in binding.parameterValues:
                for parameter in values.parameters:
                    parameter.name = f"{component.name}.{parameter.name}"
                    parameters.parameters.append(parameter)
    # Half a step less, since fmpy adds up the time and would take another step at the end.
    result = simulate_ssp(package, stop_time=stop - h / 2, step_size=h, parameter_set=parameters)
    return {f"{component}.{name}": result[f"{component}.{name}"] for component, names in WATCHED.items() for name in names}


def run_libcosim(package, h: float, stop: float) -> dict[str, np.ndarray]:
    return bridge.run_libcosim(package, h, stop, WATCHED)


def run_ecos(package, h: float, stop: float) -> dict[str, np.ndarray]:
    return bridge.run_ecos(package, h, stop, WATCHED)


MASTERS = {"fmpy": run_fmpy, "libcosim": run_libcosim, "Ecos": run_ecos}


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("folder", nargs="?", help="where floor.ssp is kept")
    arguments = options.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        package = build(arguments.folder or temporary)
        for name, run in MASTERS.items():
            try:
                result = run(package, 0.001, 8.0)
            except (ImportError, OSError) as error:
                print(f"{name}: not installed ({error})")
                continue
            largest = {variable: np.abs(values).max() for variable, values in result.items()}
            print(f"{name}: largest rotation {largest['block.theta']:.6f} rad, acceleration of the floor {largest['storey.a']:.4f} m/s², "
                  f"drift {1000 * largest['storey.u']:.3f} mm")


if __name__ == "__main__":
    main()
