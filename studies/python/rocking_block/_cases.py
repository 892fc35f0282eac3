"""Rows of a table, batch by batch → their outcomes relative to a limit."""

from __future__ import annotations

import dataclasses
import re
from numbers import Real
from typing import Any, get_args

import numpy as np
import numpy.typing as npt

from rocking_block import _engine
from rocking_block._table import BATCH, Table, by_name, for_each_batch, split_heading
from rocking_block._words import Floats, Outcome

Rows = tuple[Floats, Floats, Floats, Floats, npt.NDArray[np.int64]]
"""Measures, fractions of the known runs that exceeded the limit, nan without any, fractions of runs without a verdict, peaks of the blocks
that rock and stand, and numbers of the ground motions, which are -1 for rows that have their own."""


class Cases:
    """The decided rows of a table with their counts; `limit` is the word or the rotation of the limit after the first batch."""

    def __init__(self, im: str, limit: str | float | None, cluster: str | None = None, unknown_exceed: bool | None = None) -> None:
        self.im, self.limit, self.unit = split_heading(im)[0], limit, ""
        self.all = self.failed = self.separated = self.undecided = self.partly = self.missing = 0
        self.least = self.most = 0.0
        self.store = _engine.CaseStore()
        self.batches: list[Rows] = []
        """The rows of each batch, if they are kept."""
        self.motions = _engine.Motions(None if cluster is None else split_heading(cluster)[0])
        self._unknown_exceed = unknown_exceed
        """Whether runs without a verdict exceed the limit; they are left out of the store if it is None."""
        self._is_begun = False

    def take(self, table: Table, is_part: bool = False, keep: bool = False) -> None:
        """Takes rows; rows of parts are in the order of their numbers, others in that of the batches."""
        if not self._is_begun:
            self._begin(table)
        outcome, limit = outcomes_of(table, self.all), self.limit
        assert limit is not None
        if rotation(table) in table or not isinstance(limit, str):
            peak = numbers(table, rotation(table))
        else:
            peak = np.full(len(outcome), np.nan)
        response = np.full(len(outcome), np.nan)
        if "ensemble.samples" not in table:
            response = _response(table, limit, peak)
        words, codes = np.unique(outcome, return_inverse=True)
        # The engine decides; nan is unknown.
        fraction = _engine.verdicts(limit_word(limit), words.tolist(), codes.astype(np.int64), response)
        unknown = np.zeros(len(outcome))
        if "ensemble.samples" in table:
            # The samples of an ensemble count, not the run in its middle; the probability is nan if none is known.
            word = limit_word(limit)
            fraction = numbers(table, f"P({word})")
            # Tables of earlier versions do not have it.
            if f"ensemble.unknown({word})" in table:
                unknown = numbers(table, f"ensemble.unknown({word})") / numbers(table, "ensemble.samples")
        none = np.isnan(fraction)
        undecided, separated = none & (outcome == "undecided"), none & (outcome == "separated")
        missing = none & (outcome == "completed") & ("ensemble.samples" not in table)
        failed = none & ~undecided & ~separated & ~missing
        decided = ~none
        places = np.asarray(table["row"]) if is_part else np.arange(self.all, self.all + len(outcome))
        least = float(np.sum((fraction * (1.0 - unknown))[decided]))
        self.least += least
        self.most += least + float(np.sum(unknown[decided]) + np.sum(~decided))
        self.partly += int(np.sum(unknown[decided] > 0.0))
        self.all += len(outcome)
        self.failed += int(failed.sum())
        self.separated += int(separated.sum())
        self.undecided += int(undecided.sum())
        self.missing += int(missing.sum())
        peak = np.where((outcome == "completed") & rocks(table, peak), peak, np.nan)
        motions, measures = self._numbered(table, places), numbers(table, self.im)
        rows = (measures, fraction, np.where(none, 1.0, unknown), peak, motions)
        if keep:
            self.batches.append(rows)
        else:
            self.store.push(places.astype(np.int64), *rows, self._unknown_exceed)

    def _begin(self, table: Table) -> None:
        """Checks the columns, and finds the measure and the limit."""
        self.im = self.im if self.im in table else _engine.measure_name(self.im)
        self.unit = table.units.get(self.im, "")
        named, limit = _named(self.limit), self.limit
        if limit is None:
            limit = "balance" if "peak.theta/balance" in table else "overturned"
        elif isinstance(limit, str) and limit.lower() in ("overturned", "balance", "breaks"):
            limit = "tilt/alpha>1" if limit.lower() == "balance" and TILT in table else limit.lower()
        elif named is not None:
            limit = f"{named[0]}>" + repr(named[1]).removesuffix(".0")
        elif isinstance(limit, str | bool) or not isinstance(limit, Real) or not 0.0 < limit < np.inf:
            shown = f'"{limit}"' if isinstance(limit, str) else limit
            expected = 'expected "overturned", "balance", "breaks", a rotation |θ|/α > 0, in metres "slip:0.1" or "plastic:0.02", or "half_cycles:20"'
            in_space = '; of a block in space "tilt:0.5" over that of its balance, "twist:0.1" in rad, or "drift:0.1" in metres'
            raise ValueError(f"limit = {shown}; {expected}{in_space}")
        elif TILT in table:
            limit = f"tilt/alpha>{float(limit)!r}".removesuffix(".0")
        self.limit = limit
        searched = [name for name in table if name.startswith("least.")]
        if searched:
            expected = "an outcome at one level in each row, as from a sweep with scales or levels"
            raise ValueError(f"found the least levels of searches, {searched[0]}; expected {expected}")
        self._is_begun = True

    def _numbered(self, table: Table, places: npt.NDArray[Any]) -> npt.NDArray[np.int64]:
        """Returns the numbers that the engine gives the ground motions, and has it take note of their first rows."""
        names = self.motions.columns(list(table))
        codes, words = np.zeros(table.rows, dtype=np.int64), []
        for name in names:
            known, code = np.unique(_column(table, name).astype(str), return_inverse=True)
            codes = codes * len(known) + code
            words.append(known)
        if not words:
            return np.full(table.rows, -1, dtype=np.int64)
        found, index, inverse = np.unique(codes, return_index=True, return_inverse=True)
        first = np.full(len(found), np.iinfo(np.int64).max)
        np.minimum.at(first, inverse, places)
        # In the order of the rows, for the numbers of a table that is one batch.
        order = np.argsort(index, kind="stable")
        keys = [[_text(known[code]) for known, code in zip(words, _digits(int(of), words), strict=True)] for of in found[order]]
        of_found = np.empty(len(found), dtype=np.int64)
        of_found[order] = self.motions.number(names, keys)
        self.motions.see(of_found.tolist(), first.tolist())
        return np.asarray(of_found[inverse])


@dataclasses.dataclass(frozen=True)
class Files:
    """A table in files, which is read once for a curve and again for its rows."""

    path: str
    im: str
    limit: str | float | None
    partial: bool
    cluster: str | None = None
    where: tuple[tuple[str, Any], ...] = ()

    def cases(self, keep: bool = False, unknown_exceed: bool | None = None) -> Cases:
        """Reads the cases; with `keep` their rows are arrays, in the order of the files. `unknown_exceed` is the outcome of unknown runs."""
        cases = Cases(self.im, self.limit, self.cluster, unknown_exceed)
        named = [self.im, *(() if self.cluster is None else (self.cluster,)), *(name for name, _ in self.where)]
        found = 0

        def take(table: Table, is_part: bool) -> None:
            nonlocal found
            chosen = _where(table, self.where)
            found += int(chosen.sum())
            cases.take(table if chosen.all() else table[chosen], is_part, keep)

        for_each_batch(self.path, named, self.partial, take)
        _check_found(found, self.where)
        return cases


def _where(table: Table, conditions: tuple[tuple[str, Any], ...]) -> npt.NDArray[np.bool_]:
    """Returns which rows have the values of all conditions."""
    chosen = np.ones(table.rows, dtype=bool)
    for name, value in conditions:
        column = _column(table, split_heading(name)[0])
        chosen &= column == value if column.dtype.kind in "biuf" and isinstance(value, Real) else column.astype(str) == str(value)
    return chosen


def _check_found(rows: int, conditions: tuple[tuple[str, Any], ...]) -> None:
    if rows == 0 and conditions:
        shown = " and ".join(f"{name} = {value}" for name, value in conditions)
        raise ValueError(f"no row has {shown}; expected values of the table")


def cases_of(table: Any, im: str, limit: str | float | None, cluster: str | None, where: tuple[tuple[str, Any], ...] = ()) -> Cases:
    """Returns the cases of a table in memory, whose rows are kept."""
    if where:
        chosen = _where(by_name(table), where)
        _check_found(int(chosen.sum()), where)
        table = table[chosen] if hasattr(table, "iloc") else by_name(table)[chosen]
    cases = Cases(im, limit, cluster)
    # The texts of a frame become Python's, and those of a table are copied: of all rows they would take more memory than the table.
    is_frame = hasattr(table, "iloc")
    table = table if is_frame else by_name(table)
    rows = len(table) if is_frame else table.rows
    whole: list[npt.NDArray[Any]] = []
    for first in range(0, max(rows, 1), BATCH):
        some = by_name(table.iloc[first : first + BATCH]) if is_frame else table[first : first + BATCH]
        cases.take(some, keep=True)
        batch = cases.batches.pop()
        whole = whole or [np.empty(rows, dtype=column.dtype) for column in batch]
        for column, part in zip(whole, batch, strict=True):
            column[first : first + BATCH] = part
    cases.batches.append((whole[0], whole[1], whole[2], whole[3], whole[4]))
    return cases


def _digits(code: int, words: list[npt.NDArray[Any]]) -> list[int]:
    """Returns the position of each word in a code of all."""
    if len(words) == 1:
        return [code]
    return list(divmod(code, len(words[1])))


TILT = "peak.tilt/alpha"
"""The column of blocks in space with the tilt over that of the balance in the direction of the lean."""

_OVER_NEAREST_EDGE = "peak.tilt/alpha_edge"
"""Its predecessor, the tilt over that of the balance over the nearest edge."""

_COLUMNS = {
    "slip": r"peak\.slip",
    "plastic": r"peak\..*\.plastic",
    "half_cycles": "half_cycles>.*",
    "tilt/alpha": re.escape(TILT),
    "twist": r"peak\.twist",
    "drift": r"peak\.drift",
}
"""The columns of limits by their quantities."""


def _named(limit: object) -> tuple[str, float] | None:
    """Returns the quantity and the number of a limit such as "slip:0.1"."""
    quantity, _, number = re.sub("[:>]", ">", limit).partition(">") if isinstance(limit, str) else ("", "", "")
    try:
        found = ("tilt/alpha" if quantity.lower() == "tilt" else quantity.lower(), float(number or np.nan))
    except ValueError:
        return None
    return found if found[0] in _COLUMNS and 0.0 < found[1] < np.inf else None


def _response(table: Table, limit: str | float, peak: Floats) -> Floats:
    """Returns the greatest value of the quantity of a limit in each row, nan where it is missing."""
    named = _named(limit)
    if named is not None:
        return _peaks(table, named[0])
    if limit == "breaks":
        return numbers(table, "ties.broken")
    # Without ties, even blocks have their peaks over the balance in `peak.theta/alpha`.
    if limit == "balance" and ("peak.theta/balance" in table or "eccentricity" in table):
        return numbers(table, "peak.theta/balance")
    return numbers(table, rotation(table)) if limit == "balance" else peak


def _peaks(table: Table, quantity: str) -> Floats:
    """Returns the greatest numbers in the columns of a quantity."""
    columns = [name for name in table if re.fullmatch(_COLUMNS[quantity], name)]
    missing = _COLUMNS[quantity].replace("\\", "")
    return np.asarray(np.fmax.reduce([numbers(table, name) for name in columns or [missing]]))


def limit_word(limit: str | float) -> str:
    """Returns the word of a limit in the columns of tables."""
    return limit if isinstance(limit, str) else "theta/alpha>" + repr(float(limit)).removesuffix(".0")


def _text(name: Any) -> str:
    """Returns a word of a column; empty where it is missing, for which pandas has nan, None or NA."""
    return "" if str(name) in ("nan", "<NA>", "None") else str(name)


def _column(table: Table, name: str) -> npt.NDArray[Any]:
    if name not in table:
        raise ValueError(f"there is no column {name!r}; expected one of {', '.join(table)}")
    return table[name]


def rotation(table: Table) -> str:
    """Returns the column of the peak rotation: |θ|/α, or in space the tilt over that of the balance.

    The table of a former release, whose `peak.tilt/alpha` has another meaning, is refused.
    """
    if _OVER_NEAREST_EDGE in table:
        expected = f"expected only {TILT}, the tilt over that of the balance in the direction of the lean, as from the same study run again"
        raise ValueError(f"found the column {_OVER_NEAREST_EDGE}, of a former release; {expected}")
    return TILT if TILT in table else "peak.theta/alpha"


def rocks(table: Table, peak: Floats) -> npt.NDArray[np.bool_]:
    """Returns whether the blocks of rows that stand rocked, by their peak rotation and their lift-offs if the table has them."""
    counted = next((name for name in ("events.liftoffs", "events.lift_offs") if name in table), None)
    return _engine.rocks(peak, None if counted is None else numbers(table, counted))


def numbers(table: Table, name: str) -> Floats:
    """Returns a column of numbers."""
    column = _column(table, name)
    try:
        return column.astype(np.float64)
    except (TypeError, ValueError):
        raise ValueError(f"column {name!r} has {column[0]!r}; expected numbers") from None


def outcomes_of(table: Table, before: int = 0) -> npt.NDArray[Any]:
    """Returns the outcomes in lower case: 1 or True is overturned. An unknown word is an error, since it would count as a standing block.

    `before` is the number of rows of the batches before.
    """
    column = _column(table, "outcome")
    if column.dtype.kind in "biuf" and np.isin(column, (0, 1)).all():
        column = np.where(column.astype(bool), "overturned", "completed")
    outcome = np.char.lower(column.astype(str))
    unknown = np.flatnonzero(~np.isin(outcome, get_args(Outcome)))
    if unknown.size:
        words = ", ".join(f'"{word}"' for word in get_args(Outcome))
        raise ValueError(f"outcome = {column[unknown[0]]!r} in row {before + unknown[0]}; expected one of {words}")
    return outcome
