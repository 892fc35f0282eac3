"""Cloud and stripe analysis."""

from __future__ import annotations

import math
import os
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np
import numpy.typing as npt

from rocking_block import _engine
from rocking_block._cases import Question, cases_of, numbers, rows_of
from rocking_block._fragility import Fragility, fragility
from rocking_block._table import Table, by_name, read_table, split_heading
from rocking_block._words import Floats

if TYPE_CHECKING:
    import pandas
    from matplotlib.axes import Axes

_Runs = Table | Mapping[str, npt.ArrayLike] | str | os.PathLike[str]


class Sufficiency(NamedTuple):
    """The regression of the residuals of a cloud on a property of the records."""

    slope: float
    """Change of ln(|θ|/α) with the property."""
    p: float
    """Probability of at least this slope, to either side, if the property has no effect: below 0.05, say, the measure is not sufficient.

    Rows that share a ground motion count once, as for the intervals of `Cloud`.
    """


@dataclass(frozen=True)
class Share:
    """The probability that blocks overturn, or rock, over the measure."""

    exceeded: int
    """Rows that do."""
    rows: int
    """Rows in all."""
    threshold: float
    """Without a fit, the measure from which all do: 0 if all do, inf if none does, otherwise between the classes, in their geometric mean; nan with a fit."""
    _found: _engine.Cloud = field(repr=False)
    _is_rocking: bool = field(repr=False)

    @cached_property
    def fit(self) -> Fragility | None:
        """The logistic regression on ln IM; None where one class is empty or a measure separates both."""
        if not math.isnan(self.threshold):
            return None
        measures, does, motions = self._found.cases(self._is_rocking)
        *_, ci, cluster = self._found.__getnewargs__()
        assert isinstance(ci, float) and isinstance(cluster, str | None)
        rows = {"IM": measures, "outcome": does, cluster or "motion": motions}
        return fragility(Table(rows), "IM", link="logit", ci=ci, cluster=cluster)

    def curve(self, x: npt.ArrayLike) -> Floats:
        """Returns the probability [1] at measures `x` > 0."""
        return _at(x, lambda measures: self._found.probabilities(self._is_rocking, measures))


@dataclass(frozen=True)
class Cloud:
    """A cloud analysis: rotations of the blocks that rock and stand, over an intensity measure, beside those that overturn; made by `cloud`.

    The median rotation is `exp(a) IM^b` times α. The probability of exceeding a rotation is that of F. Jalayer and others, Analytical fragility
    assessment using unscaled ground motion records, EESD 46 (2017) 2639-2663: with the probability C of overturning,
    `P = C + (1 − C) R Φ((a + b ln IM − ln limit)/beta)`. R is the probability that a standing block rocks, since records that do not
    lift a block have no rotation.
    """

    im: str
    """The intensity measure."""
    unit: str
    """Its unit; empty if the table has none."""
    a: float
    """Mean of ln(|θ|/α) at IM = 1."""
    b: float
    """Slope of ln(|θ|/α) over ln IM."""
    beta: float
    """Standard deviation of ln(|θ|/α) about the line, with n − 2 degrees of freedom."""
    standard_errors: tuple[float, float]
    """Standard errors of a and b, clustered by ground motion where several rows share one; inf if one motion alone determines one of them."""
    a_ci: tuple[float, float]
    """Confidence interval of a, by Student's t with one degree of freedom less than there are motions."""
    b_ci: tuple[float, float]
    """Confidence interval of b."""
    independence: str
    """The units that errors, intervals and tests treat as independent."""
    r_squared: float
    """Part of the variance of ln(|θ|/α) that the line describes."""
    overturning: Share
    """The probability of overturning, over all known rows."""
    rocking: Share
    """The probability that a standing block rocks."""
    unknown: int
    """Rows left out, whose outcome or measure is unknown."""
    sufficiency: Mapping[str, Sufficiency]
    """Tests of the measure beside properties of the records, by their columns."""
    measures: Floats = field(repr=False)
    """The measure of each row behind the line, shape (n,)."""
    rotations: Floats = field(repr=False)
    """Its peak |θ|/α, shape (n,)."""
    _found: _engine.Cloud = field(repr=False)

    @property
    def efficiency(self) -> float:
        """The scatter `beta`: the smaller, the more efficient the measure (Luco and Cornell, 2007)."""
        return self.beta

    @property
    def proficiency(self) -> float:
        """The scatter over the slope, `beta / b`: the smaller, the better the measure (Padgett and others, 2008)."""
        return self._found.proficiency

    def median(self, x: npt.ArrayLike) -> Floats:
        """Returns the median |θ|/α [1] of blocks that rock and stand, at measures `x` > 0."""
        return _at(x, self._found.medians)

    def curve(self, x: npt.ArrayLike, limit: float | Literal["overturned"] = "overturned") -> Floats:
        """Returns the probability [1] of overturning, or of exceeding a rotation |θ|/α > 0, at measures `x` > 0 of any shape."""
        if limit == "overturned":
            return self.overturning.curve(x)
        if isinstance(limit, str | bool) or not 0.0 < limit < np.inf:
            raise ValueError(f'limit = {limit!r}; expected "overturned" or a rotation |θ|/α > 0')
        return _at(x, lambda measures: self._found.exceedances(limit, measures))

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draws the rotations, the median and one standard deviation about it, with Matplotlib; ticks above are runs that overturn."""
        from rocking_block import _plot_ida

        return _plot_ida.cloud(self, ax)

    def __repr__(self) -> str:
        unit = f" {self.unit}" if self.unit not in ("", "1") else ""
        return (
            f"<Cloud over {self.im}{f' [{unit.strip()}]' if unit else ''}: |θ|/α = {math.exp(self.a):.4g} IM^{self.b:.3g}, beta {self.beta:.3g} of "
            f"{len(self.measures)} runs; {self.overturning.exceeded} of {self.overturning.rows} overturn>"
        )


def cloud(
    table: _Runs | pandas.DataFrame, im: str, *, beside: str | Sequence[str] = (), ci: float = 0.95, cluster: str | None = None
) -> Cloud:
    """Fits a cloud analysis: a line through the logarithms of rotation and measure, and the probability of overturning.

    The line takes the rows that stand and rock: they lifted off and reached |θ|/α = 0.001, since just above uplift peaks fall to 1e-13, and
    their logarithms would outweigh all others. Overturning is a logistic regression on ln IM of all rows with a known outcome.

    Parameters
    ----------
    table : Table, DataFrame, mapping or path
        Runs of `sweep` or `outcomes` under records at their own strength, or any others; as in `fragility`.
    im : str
        Name of the column of the intensity measure.
    beside : str or list of str
        Columns of properties of the records, such as their magnitude or the logarithm of their distance, for which the residuals are tested.
    ci : float
        Confidence level of intervals, above 0 and below 1.
    cluster : str, optional
        Column whose values cluster the rows, instead of the ground motions, as in `fragility`.

    Raises
    ------
    ValueError
        A column does not exist, fewer than three rows rock and stand, or the rows are ensembles.

    Examples
    --------
    >>> import rocking_block as rb
    >>> rows = {"PGV": [0.1, 0.2, 0.3, 0.4, 0.5, 0.6], "peak.theta/alpha": [0.1, 0.22, 0.28, 0.4, 0.5, 9.0],
    ...         "outcome": ["completed"] * 5 + ["overturned"]}
    >>> found = rb.cloud(rb.Table(rows, {"PGV": "m/s"}), "PGV")
    >>> found
    <Cloud over PGV [m/s]: |θ|/α = 0.9765 IM^0.978, beta 0.0657 of 5 runs; 1 of 6 overturn>
    >>> found.curve([0.2, 0.4, 0.8], limit=0.4).round(3)
    array([0.   , 0.476, 1.   ])
    """
    table, im = _runs(table, im)
    if "ensemble.samples" in table:
        raise ValueError("found an ensemble; expected the rotation and the outcome of a single run in each row")
    measures, overturned, _, peaks, motions = rows_of(cases_of(table, Question(im, "overturned", cluster)))
    known = ~np.isnan(overturned)
    names = [split_heading(column)[0] for column in ([beside] if isinstance(beside, str) else beside)]
    properties = np.array([numbers(table, name)[known] for name in names]).reshape(len(names), int(known.sum()))
    rows = (measures[known], overturned[known] > 0.0, peaks[known], motions[known])
    found = _engine.Cloud(im, *rows, names, properties, ci, cluster)
    for warning in found.warnings():
        warnings.warn(warning, stacklevel=2)
    (a, b), (measures, rotations) = found.coefficients, found.points()
    return Cloud(
        im=im,
        unit=table.units.get(im, ""),
        a=a,
        b=b,
        beta=found.deviation,
        standard_errors=found.standard_errors,
        a_ci=found.intervals[0],
        b_ci=found.intervals[1],
        independence=found.independence,
        r_squared=found.r_squared,
        overturning=_share(found, False),
        rocking=_share(found, True),
        unknown=found.unknown + int((~known).sum()),
        sufficiency={name: Sufficiency(*test) for name, test in zip(names, found.sufficiency, strict=True)},
        measures=measures,
        rotations=rotations,
        _found=found,
    )


def _share(found: _engine.Cloud, is_rocking: bool) -> Share:
    _, does, _ = found.cases(is_rocking)
    threshold = found.threshold(is_rocking)
    return Share(int(does.sum()), len(does), np.nan if threshold is None else threshold, found, is_rocking)


def _at(x: npt.ArrayLike, curve: Callable[[Floats], Floats]) -> Floats:
    """Returns a curve at measures of any array shape."""
    measures = np.asarray(x, dtype=np.float64)
    return curve(measures.ravel()).reshape(measures.shape)


@dataclass(frozen=True)
class Stripes:
    """A multiple-stripe analysis: runs at some levels of an intensity measure, each with records of its own or the same; made by `stripes`."""

    levels: Floats
    """The levels, increasing, shape (n,)."""
    runs: npt.NDArray[np.int64]
    """Decided runs at each level, shape (n,)."""
    exceeded: Floats
    """Runs that exceed the limit; fractions of ensembles count, shape (n,)."""
    fit: Fragility
    """The curve of maximum likelihood, with its intervals and the limit."""

    @property
    def fractions(self) -> Floats:
        """Fraction of the decided runs that exceed the limit at each level [1], shape (n,)."""
        return self.exceeded / self.runs

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draws the fractions and the curve with its band, with Matplotlib."""
        axes = self.fit.plot(ax, runs=False)
        axes.plot(self.levels, self.fractions, "o", color="#404040", mfc="white", ms=6, zorder=3)
        return axes

    def __repr__(self) -> str:
        return f"<Stripes at {len(self.levels)} levels: {self.fit!r}>"


def stripes(
    table: _Runs | pandas.DataFrame, im: str, limit: str | float | None = None, **options: Any
) -> Stripes:
    """Fits a fragility curve to stripes: runs at levels of an intensity measure (F. Jalayer, C. A. Cornell, EESD 38 (2009) 951-972).

    The curve is that of maximum likelihood of the counts at the levels, each binomial (J. W. Baker, Earthquake Spectra 31 (2015) 579-599),
    which is that of `fragility` over the rows. Where motions repeat between levels, intervals are clustered by motion.

    Parameters
    ----------
    table : Table, DataFrame, mapping or path
        Runs of a sweep with `levels`, or several such tables as one, each with the records selected for its level; or a row for each level,
        with the number of its `runs` and of those `exceeded`.
    im : str
        Name of the column of the levels.
    limit : "overturned", "balance", float or str, optional
        As in `fragility`.
    **options
        Further options of `fragility`.

    Raises
    ------
    ValueError
        More than half of the rows have a level of their own, or as `fragility`.

    Examples
    --------
    >>> import rocking_block as rb
    >>> rows = {"PGV": [0.2] * 5 + [0.4] * 5 + [0.8] * 5,
    ...         "outcome": ["completed"] * 5 + ["overturned"] * 2 + ["completed"] * 3 + ["overturned"] * 4 + ["completed"]}
    >>> found = rb.stripes(rb.Table(rows, {"PGV": "m/s"}), "PGV")
    >>> found.fractions
    array([0. , 0.4, 0.8])
    """
    table, im = _runs(table, im)
    if "outcome" not in table and "runs" in table and "exceeded" in table:
        table = _unrolled(table, im)
    fit = fragility(table, im, limit, **options)
    return Stripes(*_engine.stripes(fit.measures, fit.fractions, im), fit)


def _unrolled(table: Table, im: str) -> Table:
    """Returns a row for each run of levels with their counts."""
    rows, exceed = _engine.unrolled(numbers(table, "runs"), numbers(table, "exceeded"))
    return Table({im: numbers(table, im)[rows], "outcome": exceed}, {im: table.units[im]} if im in table.units else {})


def _runs(table: Any, im: str) -> tuple[Table, str]:
    """Returns the runs, and the name of the column of a measure."""
    found = read_table(table) if isinstance(table, str | os.PathLike) else by_name(table)
    name = split_heading(im)[0]
    return found, name if name in found else _engine.measure_name(name)
