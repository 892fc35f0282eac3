"""A second measure beside that of a fragility curve: surfaces and tests of sufficiency."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from rocking_block import _engine
from rocking_block._cases import Files, Question, Rows, cases_of, rows_of
from rocking_block._words import Floats


@dataclass(frozen=True)
class Surface:
    """A fragility surface `P = F(a + b ln IM + c ln IM₂)` of maximum likelihood; made by `fragility` with `surface`."""

    im: tuple[str, str]
    """Both intensity measures."""
    rows: int
    """Number of rows with both measures."""
    coefficients: tuple[float, float, float]
    """a, b and c, of natural logarithms in the units of the table."""
    standard_errors: tuple[float, float, float]
    """Their standard errors, clustered by ground motion where rows share one; inf if one motion alone determines one."""
    log_likelihood: float
    """Greatest log-likelihood."""
    auc: float
    """Area under the receiver operating characteristic [1]."""
    brier: float
    """Brier score [1]."""
    link: Literal["probit", "logit"]
    """The distribution F."""

    def curve(self, x: npt.ArrayLike, y: npt.ArrayLike) -> Floats:
        """Returns the probability of exceeding the limit [1] at measures `x` and `y` > 0, whose shapes are broadcast."""
        first, second = np.broadcast_arrays(np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64))
        if not ((first > 0.0).all() and (second > 0.0).all()):
            raise ValueError("found a measure that is not above 0; expected measures > 0")
        a, b, c = self.coefficients
        predictors = np.asarray(a + b * np.log(first) + c * np.log(second), dtype=np.float64)
        return _engine.link_probabilities(self.link, predictors.ravel()).reshape(predictors.shape)

    def __repr__(self) -> str:
        a, b, c = (f"{value:.4g} ± {error:.2g}" for value, error in zip(self.coefficients, self.standard_errors, strict=True))
        one, other = self.im
        return f"<Surface of {self.rows} rows: ({a}) + ({b}) ln {one} + ({c}) ln {other}; AUC {self.auc:.3f}>"


@dataclass(frozen=True)
class Second:
    """The rows of a curve with the measures of other columns."""

    rows: Rows
    columns: dict[str, Floats]
    link: Literal["probit", "logit"]
    cluster: str | None

    def _store(self, name: str) -> tuple[_engine.CaseStore, _engine.Motions, str]:
        store, motions = _engine.CaseStore(), self.rows[4]
        store.push(np.arange(len(motions), dtype=np.int64), *self.rows, None, self.columns[name])
        # Motions are numbered in the order of their first rows.
        return store, _engine.Motions.in_order(self.cluster, int(motions.max(initial=-1)) + 1), self.link

    def sufficiency(self, name: str) -> float:
        """Returns the p-value of the hypothesis that the measure of the rows is sufficient beside a column."""
        return _engine.sufficiency(*self._store(name))

    def surface(self, im: str, name: str) -> Surface:
        """Returns the surface over the measure of the rows and a column."""
        found = _engine.surface(*self._store(name))
        return Surface((im, name), found.rows, found.coefficients, found.standard_errors, found.log_likelihood, found.auc, found.brier, self.link)


def columns_of(table: Any, names: Sequence[str], question: Question, partial: bool) -> dict[str, Floats]:
    """Returns the columns of these names, of the rows that a question is about."""

    def column(name: str) -> Floats:
        asked = replace(question, im=name)
        is_file = isinstance(table, str | os.PathLike)
        return rows_of(Files(os.fspath(table), partial, asked).cases(keep=True) if is_file else cases_of(table, asked))[0]

    return {name: column(name) for name in names}
