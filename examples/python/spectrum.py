"""A rocking spectrum of an earthquake: the largest rotations of blocks of many sizes and slendernesses, each a run of the FMU.

    python examples/python/spectrum.py                            # one process
    python examples/python/spectrum.py --dask                     # all cores of this machine
    python examples/python/spectrum.py --dask tcp://scheduler:8786   # an existing cluster
    python examples/python/spectrum.py --record my.csv --scale 1 --unit g   # a record in any format that rocking reads

The FMU's bytes travel to the workers with the tasks, so a cluster needs no shared disk, only fmpy and the platform
for which the FMU was built. Writes spectrum.png to the working directory. The numbers are those of
`rocking spectrum --duration` to the last bit: the same blocks, the same tolerance, and runs of the same duration.
"""

import argparse
import functools
import sys
import tempfile
from itertools import product
from pathlib import Path
from typing import NamedTuple

import numpy as np

EXAMPLES = Path(__file__).resolve().parents[1]
SLENDERNESS = (0.15, 0.2, 0.3)  # rad
TOLERANCE = 1e-6  # that of `rocking spectrum`
FOUNDATION = {"dimensionless.eta": 40.0, "dimensionless.xi_v": 0.1, "epsilon": 0.4}


def sizes(least: float, greatest: float, count: int) -> np.ndarray:
    """Returns frequency parameters p [rad/s], evenly spaced in 1/p from the largest to the smallest, as in `rocking spectrum`."""
    part = np.arange(count) / (count - 1)
    p = 1 / ((1 - part) / greatest + part / least)
    # Exactly, without rounding.
    p[0], p[-1] = greatest, least
    return p


class Motion(NamedTuple):
    """A record in any format that `rocking` reads, as sent to the workers, with its scale and options."""

    name: str
    content: bytes
    begin: float = 0.0  # of the record's time axis [s]
    scale: float = 1.0
    unit: str = ""  # g, m/s2 or cm/s2, if the file does not say
    dt: float = 0.0  # between two samples [s], if the file does not say


@functools.lru_cache(maxsize=1)
def prepared(fmu: bytes, motion: Motion, fly: bool):
    """Returns an FMU instance, its value references by name, and its state with the record read; once per process.

    The block is not chosen yet. With `fly`, a block that leaves the ground flies and lands.
    """
    from fmpy import extract, read_model_description
    from fmpy.fmi2 import FMU2Slave

    folder = Path(tempfile.mkdtemp(prefix="rocking"))
    record, path = folder / motion.name, folder / "RockingBlock.fmu"
    record.write_bytes(motion.content)
    path.write_bytes(fmu)
    description = read_model_description(path)
    references = {variable.name: variable.valueReference for variable in description.modelVariables}
    slave = FMU2Slave(guid=description.guid, unzipDirectory=extract(path, folder / "unpacked"), instanceName="block",
                      modelIdentifier=description.coSimulation.modelIdentifier)
    slave.instantiate()
    slave.setupExperiment(startTime=motion.begin, tolerance=TOLERANCE)
    slave.setString([references["record.horizontal"], references["record.horizontal_unit"]], [str(record), motion.unit])
    start = FOUNDATION | {"record.scale": motion.scale, "record.dt": motion.dt}
    slave.setReal([references[name] for name in start], start.values())
    # 3 is Fly; with Hold, 2, a block that separates or overturns is frozen while time goes on.
    slave.setInteger([references["on_separation"], references["on_overturning"]], [3 if fly else 2, 2])
    slave.enterInitializationMode()
    # Reading the record's end makes the FMU read the record.
    slave.getReal([references["record.end"]])
    return slave, references, slave.getFMUState()


def run(fmu: bytes, motion: Motion, duration: float, fly: bool, alpha: float, p: float) -> tuple[float, str]:
    """Returns the largest rotation [rad] and the outcome of a block under a ground motion.

    The block has slenderness `alpha` [rad] and frequency parameter `p` [rad/s]. The run is completed after `duration` [s],
    unless the block has overturned or separated before.
    """
    slave, references, state = prepared(fmu, motion, fly)
    slave.setFMUState(state)
    slave.setReal([references["dimensionless.alpha"], references["dimensionless.p"]], [alpha, p])
    slave.exitInitializationMode()
    # The FMU itself follows the record from sample to sample.
    slave.doStep(motion.begin, duration)
    (peak,) = slave.getReal([references["peak.theta"]])
    separated, overturned = slave.getBoolean([references["separated"], references["overturned"]])
    # A block that leaves the ground on its way over has both flags.
    return peak, "overturned" if overturned else "separated" if separated else "completed"


def spectrum(fmu: bytes, motion: Motion, duration: float, fly: bool, alphas, ps,
             client=None) -> tuple[np.ndarray, np.ndarray]:
    """Returns the largest rotations [rad] and the outcomes, by slenderness and frequency parameter.

    The runs go to the cluster of `client`, a `dask.distributed.Client`, if there is one.
    """
    blocks = list(product(map(float, alphas), map(float, ps)))
    if client is None:
        found = [run(fmu, motion, duration, fly, *block) for block in blocks]
    else:
        # Each worker gets FMU and record once.
        shared = client.scatter([fmu, motion], broadcast=True)
        futures = [client.submit(run, *shared, duration, fly, *block, pure=False) for block in blocks]
        found = client.gather(futures)
    shape = len(alphas), len(ps)
    peaks, ends = zip(*found)
    return np.reshape(peaks, shape), np.reshape(ends, shape)


def main() -> None:
    sys.path.insert(0, str(EXAMPLES))
    from common import BLOCK, RECORD, read_record

    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--record", default=RECORD, help="a record of any format that `rocking` reads")
    parser.add_argument("--scale", type=float, default=2.0, help="what the record is multiplied by")
    parser.add_argument("--duration", type=float, help="of all runs [s]; without it 20/p of the largest block after the record")
    parser.add_argument("--on-separation", choices=["terminate", "fly"], default="fly",
                        help="what happens at complete separation")
    parser.add_argument("--dask", nargs="?", const="", metavar="ADDRESS",
                        help="use dask.distributed: at ADDRESS, or all cores here")
    parser.add_argument("--unit", default="", help="of the record's values: g, m/s2 or cm/s2, where the file does not say")
    parser.add_argument("--dt", type=float, default=0.0, help="between two samples [s], where the file does not say")
    options = parser.parse_args()
    reading = [f"--{name}={value}" for name, value in (("unit", options.unit), ("dt", options.dt)) if value]
    try:
        times, _ = read_record(options.record, *reading)
    except ValueError as error:
        parser.error(str(error))
    file = Path(options.record)
    motion = Motion(file.name, file.read_bytes(), float(times[0]), options.scale, options.unit, options.dt)
    ps = sizes(0.8, 3.2, 25)
    duration = options.duration or float(times[-1] - times[0] + 20 / ps.min())
    client = None
    if options.dask is not None:
        from dask.distributed import Client, LocalCluster

        client = Client(options.dask or LocalCluster(threads_per_worker=1, dashboard_address=None))
        # Workers on other machines lack this file.
        client.upload_file(__file__)
    fly = options.on_separation == "fly"
    peaks, ends = spectrum(BLOCK.read_bytes(), motion, duration, fly, SLENDERNESS, ps, client)
    if client is not None:
        client.close()

    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    _, axis = plt.subplots(figsize=(9, 5), layout="constrained")
    for lane, (alpha, row, end) in enumerate(zip(SLENDERNESS, peaks, ends)):
        completed = end == "completed"
        line, = axis.plot(2 * np.pi / ps, np.where(completed, row / alpha, np.nan), "o-", ms=3, label=f"alpha = {alpha:g} rad")
        for word, mark in (("overturned", "x"), ("separated", "^")):
            axis.plot(2 * np.pi / ps[end == word], np.full((end == word).sum(), 1.6 - 0.07 * lane), mark, color=line.get_color())
    axis.set(xlabel="2π/p [s]", ylabel="greatest rotation / alpha",
             title="Rocking spectrum (crosses: overturned" + (")" if fly else ", triangles: separated)"))
    axis.grid(alpha=0.3)
    axis.legend()
    plt.savefig("spectrum.png", dpi=90)
    counts = ", ".join(f"{(ends == word).sum()} {word}" for word in ("completed", "separated", "overturned"))
    print(f"{ends.size} blocks, {duration:g} s each: {counts}; spectrum.png")


if __name__ == "__main__":
    main()
