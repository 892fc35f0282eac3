#!/usr/bin/env python3
"""Costs of parts and of their tables, as ratios of runs beside each other.

    python lab/benches/parts.py executors STUDY [--parts N] [--rounds 3]
    python lab/benches/parts.py fit FOLDER [--rows 10000000]

`executors` makes the table of a study on two threads, on one process and on two processes of one thread each, in turn, and prints the
scaling of the processes and the share of the executor, both in time and in CPU time, which other work on the machine hardly changes. `fit` writes a Parquet table of planted rows, whose true curve is known,
and compares the curve of `rocking fragility` with one by NumPy and SciPy; needs `cargo build --release --features rocking/parquet`, SciPy
and pyarrow. Both need the Python package, and memory is that of Linux.
"""

import argparse
import json
import os
import resource
import subprocess
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import rocking_block as rb

ROCKING = Path(os.environ.get("ROCKING", Path(__file__).resolve().parents[2] / "target/release/rocking"))


def seconds(work: Callable[[], object]) -> float:
    begun = time.monotonic()
    work()
    return time.monotonic() - begun


def cpu(*pools: ProcessPoolExecutor) -> float:
    """Returns the CPU time of this process and of the workers of pools [s]."""
    ticks = 0
    for pool in pools:
        for worker in pool._processes:
            ticks += sum(map(int, Path(f"/proc/{worker}/stat").read_text().rpartition(")")[2].split()[11:13]))
    return time.process_time() + ticks / os.sysconf("SC_CLK_TCK")


def executors(study: Path, parts: int | None, rounds: int) -> None:
    """Prints medians over rounds in which all ways take their turn, so that a busy machine slows all of them."""
    context = get_context("spawn")
    with ProcessPoolExecutor(1, mp_context=context) as one, ProcessPoolExecutor(2, mp_context=context) as two:
        ways = {
            "two threads": lambda: rb.sweep(study, threads=2, progress=False),
            "one thread": lambda: rb.sweep(study, threads=1, progress=False),
            "one process": lambda: rb.sweep(study, executor=one, parts=parts, progress=False),
            "two processes": lambda: rb.sweep(study, executor=two, parts=parts, progress=False),
        }
        # Workers start, and read the study.
        for way in ways.values():
            way()
        times, costs = {name: [] for name in ways}, {name: [] for name in ways}
        for _ in range(rounds):
            for name, way in ways.items():
                before = cpu(one, two)
                times[name].append(seconds(way))
                costs[name].append(cpu(one, two) - before)
    for unit, found in (("time", times), ("CPU time", costs)):
        median = {name: float(np.median(taken)) for name, taken in found.items()}
        print(f"{unit}: " + ", ".join(f"{name} {taken:.2f} s" for name, taken in median.items()))
        print(f"{unit}: two threads over two processes {median['two threads'] / median['two processes']:.3f}")
        print(f"{unit}: executor {median['one process'] / median['one thread'] - 1:+.1%} of one thread")


MEDIAN, BETA = 0.8, 0.45
"""The planted curve."""


def planted(path: Path, rows: int) -> None:
    """Writes rows with lognormal measures whose outcomes follow the planted curve, a million at a time."""
    import pyarrow
    import pyarrow.parquet
    from scipy.stats import norm

    random, writer = np.random.default_rng(1), None
    for first in range(0, rows, 1_000_000):
        count = min(1_000_000, rows - first)
        measure = np.exp(random.normal(np.log(0.7), 0.6, count))
        falls = random.random(count) < norm.cdf(np.log(measure / MEDIAN) / BETA)
        table = pyarrow.table(
            {
                "row": np.arange(first, first + count),
                "PGV": pyarrow.array(measure),
                "outcome": pyarrow.array(np.where(falls, "overturned", "completed")).dictionary_encode(),
            }
        )
        writer = writer or pyarrow.parquet.ParquetWriter(path, table.schema, compression="zstd")
        writer.write_table(table)
    writer.close()


def by_newton(path: Path) -> tuple[float, float]:
    """Returns median and dispersion of the probit curve, by Newton's method on the likelihood of all rows."""
    import pyarrow.parquet
    from scipy.special import log_ndtr

    table = pyarrow.parquet.read_table(path, columns=["PGV", "outcome"])
    x = np.log(table["PGV"].to_numpy())
    sign = np.where(np.asarray(table["outcome"].to_pandas()) == "overturned", 1.0, -1.0)
    a, b = 0.0, 1.0
    for _ in range(30):
        z = sign * (a + b * x)
        mills = np.exp(-0.5 * z * z - log_ndtr(z)) / np.sqrt(2 * np.pi)
        score, curvature = sign * mills, mills * (mills + z)
        step = np.linalg.solve(
            [[curvature.sum(), (curvature * x).sum()], [(curvature * x).sum(), (curvature * x * x).sum()]],
            [score.sum(), (score * x).sum()],
        )
        a, b = a + step[0], b + step[1]
        if np.abs(step).max() < 1e-13:
            break
    return float(np.exp(-a / b)), float(1 / b)


def fit(folder: Path, rows: int) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"planted-{rows}.parquet"
    if not path.exists():
        planted(path, rows)
    command = [ROCKING, "fragility", path, "--im", "PGV", "--json"]
    begun = time.monotonic()
    printed = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    taken = time.monotonic() - begun
    peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1000
    print(f"{rows} rows, {path.stat().st_size / 1e6:.0f} MB: {taken:.1f} s, {peak:.0f} MB of memory")
    found = json.loads(printed)
    curve = found["measures"][0]
    begun = time.monotonic()
    median, beta = by_newton(path)
    print(f"by NumPy and SciPy: {time.monotonic() - begun:.1f} s")
    print(f"median {curve['median']} and {median}, beta {curve['beta']} and {beta}; planted {MEDIAN}, {BETA}")
    print(f"relative differences {curve['median'] / median - 1:.1e}, {curve['beta'] / beta - 1:.1e}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    kinds = parser.add_subparsers(dest="kind", required=True)
    of_executors = kinds.add_parser("executors")
    of_executors.add_argument("study", type=Path)
    of_executors.add_argument("--parts", type=int)
    of_executors.add_argument("--rounds", type=int, default=3)
    of_fit = kinds.add_parser("fit")
    of_fit.add_argument("folder", type=Path)
    of_fit.add_argument("--rows", type=int, default=10_000_000)
    options = parser.parse_args()
    if options.kind == "executors":
        executors(options.study, options.parts, options.rounds)
    else:
        fit(options.folder, options.rows)


if __name__ == "__main__":
    main()
