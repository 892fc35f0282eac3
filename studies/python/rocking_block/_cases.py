"""Rows of a table, batch by batch → their outcomes relative to a limit."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

from rocking_block import _engine
from rocking_block._table import BATCH, Table, by_name, for_each_batch, split_heading
from rocking_block._words import Floats

Rows = tuple[Floats, Floats, Floats, Floats, npt.NDArray[np.int64]]
"""Measures, fractions of the known runs that exceeded the limit, nan without any, fractions of runs without a verdict, peaks of the blocks
that rock and stand, and numbers of the ground motions, which are -1 for rows that have their own."""


@dataclasses.dataclass(frozen=True)
class Question:
    """A measure and a limit, with the column of the clusters, and columns with the values of the rows that count."""

    im: str
    limit: str | float | None
    cluster: str | None = None
    where: tuple[tuple[str, Any], ...] = ()

    def begin(self, unknown_exceed: bool | None = None, keep: bool = False) -> _engine.Cases:
        """Returns cases without rows. With `keep` they keep their rows as arrays; `unknown_exceed` is the outcome of unknown runs."""
        if isinstance(self.limit, bool):
            raise TypeError(f"limit = {self.limit}; expected a word or a number")
        limit = None if self.limit is None else str(self.limit)
        cluster = None if self.cluster is None else split_heading(self.cluster)[0]
        where = [(split_heading(name)[0], str(value)) for name, value in self.where]
        return _engine.Cases(split_heading(self.im)[0], limit, cluster, where, unknown_exceed, keep)


@dataclasses.dataclass(frozen=True)
class Files:
    """A table in files, which is read once for a curve and again for its rows."""

    path: str
    partial: bool
    question: Question

    def cases(self, keep: bool = False, unknown_exceed: bool | None = None) -> _engine.Cases:
        """Reads the cases; with `keep` they have their rows, in the order of the files. `unknown_exceed` is the outcome of unknown runs."""
        cases = self.question.begin(unknown_exceed, keep)

        def take(table: Table, is_part: bool) -> None:
            cases.take(self.path, list(columns(table, cases.needs)), [*map(table.heading, table)], is_part)

        for_each_batch(self.path, self.partial, cases, take)
        cases.check(self.path)
        return cases


def cases_of(table: Any, question: Question) -> _engine.Cases:
    """Returns the cases of a table in memory, whose rows are kept."""
    cases = question.begin(keep=True)
    # The texts of a frame become Python's, and those of a table are copied: of all rows they would take more memory than the table.
    is_frame = hasattr(table, "iloc")
    table = table if is_frame else by_name(table)
    rows = len(table) if is_frame else table.rows
    for first in range(0, max(rows, 1), BATCH):
        some = by_name(table.iloc[first : first + BATCH]) if is_frame else table[first : first + BATCH]
        cases.take("table", list(columns(some, cases.needs)), [*map(some.heading, some)], False)
    cases.check("table")
    return cases


def rows_of(cases: _engine.Cases) -> Rows:
    """Returns the kept rows of cases, which nothing changes."""
    rows = cases.kept()
    assert rows is not None
    for column in rows:
        column.setflags(write=False)
    return rows


def columns(table: Table, needs: Callable[[str], bool] = lambda name: True) -> Iterator[tuple[str, str | None, Any]]:
    """Yields the columns of a table that are needed, for the engine: their names, units and values."""
    for name in filter(needs, table):
        column = table[name]
        kind = {"f": np.float64, "i": np.int64, "u": np.int64, "b": np.bool_}.get(column.dtype.kind)
        yield name, table.units.get(name), _words(column) if kind is None else column.astype(kind, copy=False)


def _words(column: npt.NDArray[Any]) -> tuple[list[str], npt.NDArray[np.int64]]:
    """Returns the words of a column, and the position of each row's. Missing ones, for which pandas has nan, None or NA, are empty."""
    words, positions = np.unique(column.astype(str), return_inverse=True)
    return ["" if word in ("nan", "<NA>", "None") else word for word in words.tolist()], positions.astype(np.int64)


def numbers(table: Table, name: str) -> Floats:
    """Returns a column of numbers."""
    if name not in table:
        raise ValueError(f"there is no column {name!r}; expected one of {', '.join(table)}")
    try:
        return table[name].astype(np.float64)
    except (TypeError, ValueError):
        raise ValueError(f"column {name!r} has {table[name][0]!r}; expected numbers") from None


def limit_word(limit: str | float) -> str:
    """Returns the word of a limit in the columns of tables."""
    return limit if isinstance(limit, str) else "theta/alpha>" + repr(float(limit)).removesuffix(".0")


def limit_of(word: str) -> str | float:
    """Returns the limit of a word: a rotation is a number."""
    quantity, _, number = word.partition(">")
    return float(number) if quantity == "theta/alpha" else word
