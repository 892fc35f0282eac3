"""Many runs in parts, on the executors of `concurrent.futures`, Dask, mpi4py, loky and others."""

from __future__ import annotations

import math
import os
import tempfile
import warnings
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, as_completed
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from rocking_block import _engine
from rocking_block._pulse import Pulse
from rocking_block._table import Table, of_columns
from rocking_block._tie import links
from rocking_block._words import is_url, optional, ticking

_ROWS = 10_000
"""Rows of a part by default, some ten seconds of work."""

_PARTS = 32
"""Number of parts by default if there are enough rows, so that workers end at about the same time."""

_MIN_ROWS = 500
"""Least number of rows of a part by default: with 75, the processor's vectors are rarely full, and a study takes 1.7 times as long."""


class Source(NamedTuple):
    """The file or the content of a study, as workers need it: small, since they read the records themselves."""

    name: str | None
    text: str
    folder: str
    on_separation: str | None


def _idle(done: int, total: int) -> None:
    pass


@lru_cache(maxsize=2)
def _study(source: Source) -> _engine.Study:
    """Returns the study, which a worker reads once for all parts."""
    # The caller has checked the study.
    return _engine.Study(*source, True, _idle)


Scales = dict[str, float]
"""The greatest factors on the records of a hunt, by their names."""


def _rows(source: Source, number: int, count: int, threads: int) -> tuple[Any, str | None, Scales]:
    """Returns the columns of a part, the reason of the first failed run, and the greatest factors on records."""
    return _study(source).part(number, count, threads, _idle)


def _file(source: Source, number: int, count: int, threads: int, out: str, format: str) -> tuple[int, str | None, Scales]:
    """Writes a part unless it is complete; returns the number of its rows, and the others of `_rows`."""
    study, name = _study(source), _engine.part_file_name(number, count, format)
    folder = _folder(out)
    if folder.is_complete(name, lambda file: study.is_complete(file, number, count)):
        return 0, None, {}
    content, rows, failure, scales = study.part_file(number, count, format, threads, _idle)
    folder.write(name, content)
    return rows, failure, scales


class Folder:
    """A folder of this machine, or one that all machines share."""

    def __init__(self, path: str) -> None:
        self.path = Path(path)
        self.path.mkdir(parents=True, exist_ok=True)

    def names(self) -> list[str]:
        return os.listdir(self.path)

    def is_complete(self, name: str, check: Callable[[Path], bool]) -> bool:
        return (self.path / name).exists() and check(self.path / name)

    def write(self, name: str, content: bytes) -> None:
        """Writes a file under a temporary name, and renames it once it is on disk."""
        descriptor, temporary = tempfile.mkstemp(prefix=f".{name}.", suffix=".tmp", dir=self.path)
        try:
            with open(descriptor, "wb") as file:
                file.write(content)
                file.flush()
                os.fsync(file.fileno())
            umask = os.umask(0)
            os.umask(umask)
            os.chmod(temporary, 0o666 & ~umask)
            os.replace(temporary, self.path / name)
        except BaseException:
            os.unlink(temporary)
            raise


class Store:
    """A folder by its URL, such as s3://bucket/runs, of any storage that fsspec knows."""

    def __init__(self, url: str) -> None:
        with optional(f"out = {url}", "fsspec"):
            import fsspec.core
        self.files, self.path = fsspec.core.url_to_fs(url)
        self.files.makedirs(self.path, exist_ok=True)

    def names(self) -> list[str]:
        # A bucket has no empty folders.
        listed = self.files.ls(self.path, detail=False) if self.files.exists(self.path) else []
        return [file.rsplit("/", 1)[-1] for file in listed]

    def is_complete(self, name: str, check: Callable[[Path], bool]) -> bool:
        if not self.files.exists(f"{self.path}/{name}"):
            return False
        with tempfile.TemporaryDirectory() as folder:
            self.files.get(f"{self.path}/{name}", f"{folder}/{name}")
            return check(Path(folder) / name)

    def write(self, name: str, content: bytes) -> None:
        with self.files.transaction, self.files.open(f"{self.path}/{name}", "wb") as file:
            file.write(content)


def _folder(out: str) -> Folder | Store:
    return Store(out) if is_url(out) else Folder(out)


def _count(parts: int | None, rows: int) -> int:
    """Returns the number of parts, by default one that suits the number of rows."""
    count = parts if parts is not None else min(max(_PARTS, -(-rows // _ROWS)), max(rows // _MIN_ROWS, 1))
    if count < 1:
        raise ValueError(f"parts = {parts}; expected at least 1")
    return count


def check_executor(executor: object) -> None:
    """Refuses what takes no tasks, such as a number of processes."""
    if executor is not None and not callable(getattr(executor, "submit", None)):
        expected = "expected an executor of concurrent.futures, such as ProcessPoolExecutor(4); threads=4 takes four cores without one"
        raise TypeError(f"executor = {executor!r}; {expected}")


def _results(
    executor: Executor, task: Callable[..., Any], calls: Sequence[tuple[Any, ...]], rows: int, kept: str, progress: bool | None
) -> Iterator[tuple[int, Any]]:
    """Yields the index of each call of the task and its result, in the order in which they end; cancels the others on an error."""
    futures: dict[Any, int] = {}
    with ticking(progress) as tick:
        try:
            for index, call in enumerate(calls):
                futures[executor.submit(task, *call)] = index
            for done, future in enumerate(as_completed(futures), 1):
                try:
                    result = future.result()
                except Exception as error:
                    raise RuntimeError(f"part {futures[future] + 1} of {len(calls)}: {error}{kept}") from error
                # The future keeps its result.
                yield futures.pop(future), result
                tick(done * rows // len(calls), rows)
        finally:
            for future in futures:
                future.cancel()


def _format(out: str, count: int, wanted: str | None) -> str:
    """Returns the format of the parts: the one that is wanted, or that of the parts in the folder."""
    try:
        return _engine.part_format(_folder(out).names(), count, wanted)
    except ValueError as error:
        raise ValueError(f"{out}: {error}") from None


def made(
    source: Source,
    study: _engine.Study,
    out: str | None,
    parts: int | None,
    part_format: str | None,
    executor: Executor,
    threads: int | None,
    progress: bool | None,
) -> tuple[Table | None, str | None, Scales]:
    """Makes the parts of a study on an executor; returns their table unless they are files, and the others of `_rows`."""
    count = _count(parts, study.rows)
    task: Callable[..., tuple[Any, str | None, Scales]] = _rows if out is None else _file
    place = () if out is None else (out, _format(out, count, part_format))
    calls = [(source, number, count, threads or 1, *place) for number in range(1, count + 1)]
    kept = "" if out is None else "; the same call makes the missing parts"
    failures, greatest, table = [], Scales(), _Rows(study.rows)
    for _, (result, failure, scales) in _results(executor, task, calls, study.rows, kept, progress):
        failures.extend([failure] if failure else [])
        greatest |= {name: max(scale, greatest.get(name, 0.0)) for name, scale in scales.items()}
        if out is None:
            table.take(result)
    return None if out is not None else table.whole(), failures[0] if failures else None, greatest


class _Rows:
    """The rows of a study, part by part: there may be no memory for the parts beside their table."""

    def __init__(self, rows: int) -> None:
        self.rows = rows
        self.columns: dict[str, tuple[str | None, npt.NDArray[Any]]] = {}

    def take(self, part: list[tuple[str, str | None, npt.NDArray[Any]]]) -> None:
        """Takes the columns of a part, the first with the numbers of its rows; a part without rows has none."""
        if not part:
            return
        (_, _, places), *columns = part
        self.columns = self.columns or {name: (unit, np.empty(self.rows, dtype=values.dtype)) for name, unit, values in columns}
        if [name for name, _, _ in columns] != list(self.columns):
            raise ValueError("the parts have different columns; expected workers with the same version of rocking_block")
        for name, unit, values in columns:
            column = self.columns[name][1]
            if column.dtype != values.dtype:
                column = column.astype(np.promote_types(column.dtype, values.dtype))
                self.columns[name] = (unit, column)
            column[places] = values

    def whole(self) -> Table:
        return of_columns((name, unit, column) for name, (unit, column) in self.columns.items())


class Settings(NamedTuple):
    """What all runs of a list of blocks share: periods of spectral measures [s], g [m/s²], pulse, friction demand, options of the run."""

    periods: list[float]
    g: float
    pulse: Pulse | None
    friction_demand: float | None
    options: dict[str, Any]


def _outcomes(
    blocks: Sequence[_engine.Block], pairs: list[Any], scales: list[float], settings: Settings, threads: int, holds: tuple[bool, int, int, bool]
) -> tuple[Any, str | None]:
    with warnings.catch_warnings():
        # The caller has been warned.
        warnings.simplefilter("ignore")
        return _engine.outcomes(_engine.Blocks.of(blocks), pairs, scales, *settings, threads, holds, _idle)


def outcomes(
    blocks: Sequence[_engine.Block],
    pairs: list[Any],
    scales: list[float],
    settings: Settings,
    parts: int | None,
    executor: Executor,
    threads: int | None,
    progress: bool | None,
) -> tuple[Any, str | None]:
    """Returns what `_engine.outcomes` does, from parts that have some of the pairs of records and some of the blocks.

    Pairs are divided first: with at least as many pairs as parts, each record goes to one worker.
    """
    # Mistakes and warnings come from here.
    _engine.outcomes(_engine.Blocks.of([]), pairs, scales, *settings, threads, None, _idle)
    rows = len(pairs) * len(scales) * len(blocks)
    count = _count(parts, rows)
    of_pairs = np.array_split(np.arange(len(pairs)), min(count, len(pairs)))
    of_blocks = np.array_split(np.arange(len(blocks)), min(-(-count // len(of_pairs)), len(blocks)))
    # Each part has the columns of all blocks.
    holds = (
        any(math.isfinite(block.friction) for block in blocks),
        max(len(block.ties) for block in blocks),
        max(len(block.dampers) for block in blocks),
        any(link.yield_force > 0.0 for block in blocks for link in links(block).values()),
    )
    split = [(motions, some) for motions in of_pairs for some in of_blocks]
    calls = [
        ([blocks[i] for i in some], [pairs[i] for i in motions], scales, settings, threads or 1, holds)
        for motions, some in split
    ]
    found: list[Any] = [None] * len(calls)
    for index, result in _results(executor, _outcomes, calls, rows, "", progress):
        found[index] = result

    def joined(each: list[Any]) -> Any:
        """Returns the values of a column in the order record, scale, block, from those of all parts."""
        shaped = [values.reshape(len(motions), len(scales), len(some)) for (motions, some), values in zip(split, each, strict=True)]
        lines = [np.concatenate(shaped[i : i + len(of_blocks)], axis=2) for i in range(0, len(shaped), len(of_blocks))]
        return np.concatenate(lines).ravel()

    # The reason of a failure belongs to the first row that failed.
    owners = joined([np.full(len(columns[0][2]), index) for index, (columns, _) in enumerate(found)])
    failing = [index for index, (_, failure) in enumerate(found) if failure]
    columns = [
        (name, unit, joined([columns[number][2] for columns, _ in found])) for number, (name, unit, _) in enumerate(found[0][0])
    ]
    if not failing:
        return columns, None
    outcome = next(values for name, _, values in columns if name == "outcome")
    return columns, found[owners[np.argmax(outcome == "failed")]][1]
