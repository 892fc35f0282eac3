"""A rocking spectrum of an earthquake: the greatest rotation of blocks of many sizes and slendernesses, each a run of the FMU.

    python examples/python/spectrum.py                            # one process
    python examples/python/spectrum.py --dask                     # all cores of this machine
    python examples/python/spectrum.py --dask tcp://scheduler:8786   # a cluster that runs already

The FMU's bytes go to the workers with the work, so that a cluster needs no common disk, only fmpy, and machines of the kind
that the FMU was built on. Writes spectrum.png to the folder in which it is started.
"""

import argparse
import functools
import sys
import tempfile
from itertools import product
from pathlib import Path

import numpy as np

EXAMPLES = Path(__file__).resolve().parents[1]
SLENDERNESS = (0.15, 0.2, 0.3)  # rad
PERIODS = np.linspace(2.0, 8.0, 25)  # s, 2 pi / p


@functools.lru_cache(maxsize=1)
def unpacked(fmu: bytes):
    """The FMU's description and folder, once in each process."""
    from fmpy import extract, read_model_description

    folder = Path(tempfile.mkdtemp(prefix="rocking"))
    path = folder / "RockingBlock.fmu"
    path.write_bytes(fmu)
    return read_model_description(path), extract(path, folder / "unpacked")


def run(fmu: bytes, dt: float, record: np.ndarray, alpha: float, period: float) -> tuple[float, bool]:
    """The greatest rotation [rad] of a block of slenderness `alpha` [rad] and 2 pi/p = `period` [s] under a record [m/s2]
    with a sample every `dt` [s], linear in between, and whether it overturns."""
    from fmpy.fmi2 import FMU2Slave

    description, folder = unpacked(fmu)
    references = {variable.name: variable.valueReference for variable in description.modelVariables}
    slave = FMU2Slave(guid=description.guid, unzipDirectory=folder, instanceName="block",
                      modelIdentifier=description.coSimulation.modelIdentifier)
    slave.instantiate()
    slave.setupExperiment(startTime=0.0)
    slave.setReal([references["dimensionless.alpha"], references["dimensionless.p"]], [alpha, 2 * np.pi / period])
    # A block that leaves the ground lands again; one that overturns stays down.
    slave.setInteger([references["on_separation"], references["on_overturning"]], [3, 2])
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    ground, slopes = [references["a_gx"]], np.diff(record) / dt
    for k, (value, slope) in enumerate(zip(record[:-1], slopes)):
        slave.setReal(ground, [value])
        slave.setRealInputDerivatives(ground, [1], [slope])
        slave.doStep(k * dt, dt)
    (peak,) = slave.getReal([references["peak.theta"]])
    (overturned,) = slave.getBoolean([references["overturned"]])
    slave.terminate()
    slave.freeInstance()
    return peak, bool(overturned)


def spectrum(fmu: bytes, dt: float, record: np.ndarray, alphas, periods, client=None) -> tuple[np.ndarray, np.ndarray]:
    """Greatest rotations [rad] and whether the block overturns, by slenderness and period; on the cluster of `client`, a
    `dask.distributed.Client`, if there is one."""
    alphas, periods = zip(*product(map(float, alphas), map(float, periods)))
    if client is None:
        found = [run(fmu, dt, record, *block) for block in zip(alphas, periods)]
    else:
        # Each worker gets FMU and record once.
        shared = client.scatter([fmu, record], broadcast=True)
        futures = [client.submit(run, shared[0], dt, shared[1], *block, pure=False) for block in zip(alphas, periods)]
        found = client.gather(futures)
    shape = len(set(alphas)), -1
    peaks, overturned = zip(*found)
    return np.reshape(peaks, shape), np.reshape(overturned, shape)


def main() -> None:
    sys.path.insert(0, str(EXAMPLES))
    from common import BLOCK, RECORD, read_smc

    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--record", default=RECORD, help="a record in SMC format")
    parser.add_argument("--scale", type=float, default=2.0, help="what the record is multiplied by")
    parser.add_argument("--dask", nargs="?", const="", metavar="ADDRESS",
                        help="use dask.distributed: at ADDRESS, or all cores here")
    options = parser.parse_args()
    dt, record = read_smc(options.record)
    client = None
    if options.dask is not None:
        from dask.distributed import Client, LocalCluster

        client = Client(options.dask or LocalCluster(threads_per_worker=1, dashboard_address=None))
        # Workers elsewhere do not have this file.
        client.upload_file(__file__)
    peaks, overturned = spectrum(BLOCK.read_bytes(), dt, options.scale * record, SLENDERNESS, PERIODS, client)
    if client is not None:
        client.close()

    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    _, axis = plt.subplots(figsize=(9, 5), layout="constrained")
    for alpha, row, fallen in zip(SLENDERNESS, peaks, overturned):
        line, = axis.plot(PERIODS, np.where(fallen, np.nan, row / alpha), "o-", ms=3, label=f"alpha = {alpha:g} rad")
        axis.plot(PERIODS[fallen], np.full(fallen.sum(), 1.6), "x", color=line.get_color())
    axis.set(xlabel="2π/p [s]", ylabel="greatest rotation / alpha", title="Rocking spectrum (crosses: overturned)")
    axis.grid(alpha=0.3)
    axis.legend()
    plt.savefig("spectrum.png", dpi=90)
    print(f"{overturned.sum()} of {overturned.size} blocks overturn; spectrum.png")


if __name__ == "__main__":
    main()
