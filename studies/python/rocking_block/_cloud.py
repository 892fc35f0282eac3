"""Cloud and stripe analysis."""

from __future__ import annotations

import math
import os
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
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
    fit: Fragility | None
    """The logistic regression on ln IM; None where one class is empty or a measure separates both."""
    threshold: float
    """Without a fit, the measure from which all do: 0 if all do, inf if none does, otherwise between the classes, in their geometric mean."""

    def curve(self, x: npt.ArrayLike) -> Floats:
        """Returns the probability [1] at measures `x` > 0."""
        if self.fit is not None:
            return self.fit.curve(x)
        return (np.asarray(x, dtype=np.float64) >= self.threshold).astype(np.float64)


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

    @property
    def efficiency(self) -> float:
        """The scatter `beta`: the smaller, the more efficient the measure (Luco and Cornell, 2007)."""
        return self.beta

    @property
    def proficiency(self) -> float:
        """The scatter over the slope, `beta / b`: the smaller, the better the measure (Padgett and others, 2008)."""
        return self.beta / self.b

    def median(self, x: npt.ArrayLike) -> Floats:
        """Returns the median |θ|/α [1] of blocks that rock and stand, at measures `x` > 0."""
        return np.exp(self.a + self.b * np.log(np.asarray(x, dtype=np.float64)))

    def curve(self, x: npt.ArrayLike, limit: float | Literal["overturned"] = "overturned") -> Floats:
        """Returns the probability [1] of overturning, or of exceeding a rotation |θ|/α > 0, at measures `x` > 0 of any shape."""
        collapse = self.overturning.curve(x)
        if limit == "overturned":
            return collapse
        if isinstance(limit, str | bool) or not 0.0 < limit < np.inf:
            raise ValueError(f'limit = {limit!r}; expected "overturned" or a rotation |θ|/α > 0')
        above = (np.log(self.median(x)) - math.log(limit)) / self.beta
        exceeds: Floats = 0.5 * np.vectorize(math.erfc)(-above / math.sqrt(2.0))
        return collapse + (1.0 - collapse) * self.rocking.curve(x) * exceeds

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
    if not 0.0 < ci < 1.0:
        raise ValueError(f"ci = {ci}; expected a number above 0 and below 1")
    measure, overturned, _, peak, motions = rows_of(cases_of(table, Question(im, "overturned", cluster)))
    known = ~np.isnan(measure) & ~np.isnan(overturned)
    missing = int((np.isnan(measure) & ~np.isnan(overturned)).sum())
    if missing:
        warnings.warn(f"{missing} rows without {im} are left out", stacklevel=2)
    measure, overturned, peak, motions = measure[known], overturned[known], peak[known], motions[known]
    if (measure <= 0.0).any():
        raise ValueError(f"{im} = {measure.min():g} in a row; expected measures > 0")
    # Blocks that stand have their peak if they rock.
    rocking, standing = ~np.isnan(peak), overturned == 0.0
    x, y = np.log(measure[rocking]), np.log(peak[rocking])
    line = _engine.line(x, y, motions[rocking], ci, cluster)
    if line is None:
        raise ValueError(f"found {rocking.sum()} rows that rock and stand; expected three or more, at different {im}")
    tests = {}
    for column in [beside] if isinstance(beside, str) else beside:
        name = split_heading(column)[0]
        others = numbers(table, name)[known][rocking]
        if not np.isfinite(others).all():
            raise ValueError(f"{name} is missing in a row that rocks and stands; expected a number in each")
        of_residuals = _engine.line(others, line.residuals, motions[rocking], ci, cluster)
        if of_residuals is None:
            raise ValueError(f"{name} does not vary; expected a property that differs between records")
        tests[name] = Sufficiency(of_residuals.coefficients[1], of_residuals.p)
    return Cloud(
        im=im,
        unit=table.units.get(im, ""),
        a=line.coefficients[0],
        b=line.coefficients[1],
        beta=line.deviation,
        standard_errors=line.standard_errors,
        a_ci=line.intervals[0],
        b_ci=line.intervals[1],
        independence=line.independence,
        r_squared=1.0 - float(np.sum(line.residuals**2) / np.sum((y - y.mean()) ** 2)),
        overturning=_share(measure, overturned, motions, cluster),
        rocking=_share(measure[standing], rocking[standing].astype(np.float64), motions[standing], cluster),
        unknown=int((~known).sum()),
        sufficiency=tests,
        measures=measure[rocking],
        rotations=peak[rocking],
    )


def _share(measure: Floats, does: Floats, motions: npt.NDArray[np.int64], cluster: str | None) -> Share:
    """Returns the logistic regression of a class of rows, or the step between classes that a measure separates."""
    count, rows = int(does.sum()), len(does)
    if count in (0, rows):
        return Share(count, rows, None, np.inf if count == 0 else 0.0)
    below, above = float(measure[does == 0.0].max()), float(measure[does == 1.0].min())
    if below < above:
        return Share(count, rows, None, math.sqrt(below * above))
    words = np.where(does == 1.0, "overturned", "completed")
    # Rows without a motion are independent.
    of = np.where(motions < 0, "", motions.astype(str))
    column = cluster or "motion"
    return Share(count, rows, fragility(Table({"IM": measure, "outcome": words, column: of}), "IM", link="logit", cluster=cluster), np.nan)


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
    order = np.sort(fit.measures)
    # A scaled record meets its level to round-off.
    starts = np.concatenate([[True], np.diff(order) > 1e-9 * order[1:]])
    levels = order[starts]
    if 2 * len(levels) > len(order):
        raise ValueError(f"found {len(levels)} levels of {im} in {len(order)} rows; expected stripes of several runs, as of levels in a sweep")
    stripe = np.searchsorted(levels, fit.measures * (1.0 + 1e-9), side="right") - 1
    runs = np.bincount(stripe, minlength=len(levels))
    exceeded = np.bincount(stripe, weights=fit.fractions, minlength=len(levels)).astype(np.float64)
    return Stripes(levels, runs, exceeded, fit)


def _unrolled(table: Table, im: str) -> Table:
    """Returns a row for each run of levels with their counts."""
    levels, runs, exceeded = numbers(table, im), numbers(table, "runs"), numbers(table, "exceeded")
    wrong = np.flatnonzero(~((exceeded >= 0) & (exceeded <= runs) & (exceeded % 1 == 0) & (runs % 1 == 0)))
    if wrong.size:
        raise ValueError(f"{exceeded[wrong[0]]:g} of {runs[wrong[0]]:g} runs are exceeded in row {wrong[0]}; expected whole numbers, 0 to all")
    of = np.repeat(np.arange(len(runs)), runs.astype(np.int64))
    number = np.arange(len(of)) - np.repeat(np.cumsum(runs) - runs, runs.astype(np.int64))
    return Table({im: levels[of], "outcome": np.where(number < exceeded[of], "overturned", "completed")}, {im: table.units[im]} if im in table.units else {})


def _runs(table: Any, im: str) -> tuple[Table, str]:
    """Returns the runs, and the name of the column of a measure."""
    found = read_table(table) if isinstance(table, str | os.PathLike) else by_name(table)
    name = split_heading(im)[0]
    return found, name if name in found else _engine.measure_name(name)
