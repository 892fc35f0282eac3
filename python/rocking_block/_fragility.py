"""Fragility curves."""

from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import numpy.typing as npt

from rocking_block import _engine
from rocking_block._record import Record
from rocking_block._table import Table
from rocking_block._words import Floats, ticking

if TYPE_CHECKING:
    import matplotlib.figure
    import pandas
    from typing_extensions import Self


def intensity(record: Record, periods: npt.ArrayLike = (), *, g: float = 9.81) -> dict[str, float]:
    """Intensity measures of a record, exact for accelerations that are linear between samples; no base line is taken away.

    PGA [m/s²], PGV [m/s], PGD [m], PGV/PGA [s], Arias intensity [m/s], CAV [m/s], significant duration D5-95 [s], mean
    period T_m [s], Housner's spectrum intensity SI [m], and Sa [m/s²] and Sv [m/s] of 5 % damping at each period; nan where
    a record has none.

    Parameters
    ----------
    record : Record
        The record.
    periods : array_like
        Periods of Sa and Sv [s], 0.001 to 1000.
    g : float
        Gravity in the Arias intensity [m/s²].

    Examples
    --------
    >>> import rocking_block as rb
    >>> measures = rb.intensity(rb.Record([0.0, 1.0, -1.0, 0.0], dt=0.5), periods=[1.0])
    >>> measures["PGA"], measures["PGV"]
    (1.0, 0.375)
    """
    return dict(_engine.intensity(record, np.atleast_1d(np.asarray(periods, dtype=np.float64)).tolist(), g))


class Fragility(_engine.Fragility):
    """A fragility curve `P = F(a + b ln IM)` of the greatest likelihood; `fragility` makes it.

    With the normal distribution for F (probit) it is the lognormal curve of `median` exp(−a/b) and dispersion `beta` 1/b,
    with the logistic one (logit) it is logistic regression.
    """

    im: str
    """The intensity measure."""
    unit: str
    """Its unit."""
    limit: str | float
    """What exceeds: "overturned", "separated", or a rotation |θ|/α [1]."""
    link: str
    """"probit" or "logit"."""
    ci: float
    """Confidence of intervals and bands."""
    measures: Floats
    """The intensity measure of each run, shape (n,)."""
    exceeded: npt.NDArray[np.bool_]
    """Whether the run exceeded the limit, shape (n,)."""

    def __new__(
        cls,
        measures: Floats,
        exceeded: npt.NDArray[np.bool_],
        link: str,
        ci: float,
        groups: list[int] | None,
        samples: int,
        seed: int,
        tick: Any,
        names: tuple[str, str, str | float],
    ) -> "Self":
        fit = super().__new__(cls, measures, exceeded, link, ci, groups, samples, seed, tick)
        fit.measures, fit.exceeded, fit.link, fit.ci = measures, exceeded, link, ci
        fit.im, fit.unit, fit.limit = names
        fit._resampling = (groups, samples, seed)
        return fit

    def __getnewargs__(self) -> tuple[Any, ...]:
        names = (self.im, self.unit, self.limit)
        return (self.measures, self.exceeded, self.link, self.ci, *self._resampling, _no_tick, names)

    _resampling: tuple[list[int] | None, int, int]

    def curve(self, x: npt.ArrayLike) -> Floats:
        """Probability that the limit is exceeded, at measures `x` > 0 of any shape [1]."""
        measures = np.asarray(x, dtype=np.float64)
        return self.probabilities(measures.ravel()).reshape(measures.shape)

    def band(self, x: npt.ArrayLike) -> tuple[Floats, Floats]:
        """Lower and upper end of the confidence interval of that probability, point by point [1]."""
        measures = np.asarray(x, dtype=np.float64)
        low, high = self.intervals(measures.ravel())
        return low.reshape(measures.shape), high.reshape(measures.shape)

    def plot(self) -> "matplotlib.figure.Figure":
        """The curve, its band and the runs, as a figure of Matplotlib."""
        from rocking_block import _plot

        return _plot.fragility(self)

    def __repr__(self) -> str:
        unit = "" if self.unit == "1" else f" {self.unit}"
        median, beta = self.median_ci, self.beta_ci
        return (
            f"<Fragility of {self.limit} over {self.im}: median {self.median:.4g}{unit} "
            f"[{median[0]:.4g}, {median[1]:.4g}], beta {self.beta:.3g} [{beta[0]:.3g}, {beta[1]:.3g}], "
            f"{np.count_nonzero(self.exceeded)} of {len(self.exceeded)} runs>"
        )


def fragility(
    table: "Table | pandas.DataFrame",
    im: str,
    limit: Literal["overturned", "separated"] | float = "overturned",
    *,
    ci: float = 0.95,
    link: Literal["probit", "logit"] = "probit",
    intervals: Literal["profile", "bootstrap"] = "profile",
    samples: int = 1000,
    seed: int = 1,
    progress: bool | None = None,
) -> Fragility:
    """Fits a fragility curve to the runs of a table, by the greatest likelihood.

    J. W. Baker, Efficient analytical fragility function fitting using dynamic structural analysis, Earthquake Spectra 31
    (2015) 579-599, without grouping by levels.

    Parameters
    ----------
    table : Table or DataFrame
        Runs with an intensity measure above zero each, of `sweep`, `outcomes` or `spectrum`.
    im : str
        Name of the column of the intensity measure, such as "PGV" or "p PGV/(g tan alpha)".
    limit : {"overturned", "separated"} or float
        What exceeds: a block that overturned, one that left its supports at least once, or one that rotated further than
        this |θ|/α [1] or overturned.
    ci : float
        Confidence of intervals and bands, above 0 and below 1.
    link : {"probit", "logit"}
        Normal or logistic distribution: a lognormal curve, or logistic regression.
    intervals : {"profile", "bootstrap"}
        Those of the profile likelihood, which takes the runs to be independent, or of a bootstrap of whole records, which
        does not: runs of the same record stay together.
    samples, seed : int
        How many samples a bootstrap takes, and the number from which they follow.
    progress : bool, optional
        Whether to show a bar of tqdm.

    Raises
    ------
    ValueError
        There is no best curve: no such measure, a single class, or classes that do not overlap; or an option is not valid.

    Examples
    --------
    >>> import rocking_block as rb
    >>> rows = {"PGV": [0.2, 0.25, 0.3, 0.4, 0.45, 0.5, 0.6, 0.7, 0.9, 1.1], "outcome": ["completed"] * 10}
    >>> for i in (3, 6, 7, 8, 9):
    ...     rows["outcome"][i] = "overturned"
    >>> fit = rb.fragility(rb.Table(rows, {"PGV": "m/s"}), im="PGV")
    >>> fit
    <Fragility of overturned over PGV: median 0.4732 m/s [0.3027, 0.7396], beta 0.272 [0.0908, 1.3], 5 of 10 runs>
    >>> fit.curve([0.3, 0.6]).round(3)
    array([0.047, 0.809])
    """
    outcome = np.asarray(table["outcome"])
    measures = np.array(table[im], dtype=np.float64)
    if limit == "overturned":
        exceeded = outcome == "overturned"
    elif limit == "separated":
        exceeded = np.isfinite(np.asarray(table["first_separation"], dtype=np.float64))
    elif isinstance(limit, str):
        raise ValueError(f'limit = "{limit}"; expected "overturned", "separated" or a rotation |θ|/α')
    else:
        exceeded = (np.asarray(table["peak.theta/alpha"]) > float(limit)) | (outcome == "overturned")
    failed = np.flatnonzero(outcome == "failed")
    if failed.size:
        raise ValueError(f"{failed.size} runs failed, the first in row {failed[0]}; expected a table without them")
    if intervals == "bootstrap":
        if "record" not in table:
            raise ValueError("a bootstrap resamples records; expected a table with a column record")
        groups: list[int] | None = np.unique(np.asarray(table["record"]), return_inverse=True)[1].tolist()
    elif intervals == "profile":
        groups = None
    else:
        raise ValueError(f'intervals = "{intervals}"; expected one of "profile", "bootstrap"')
    measures.setflags(write=False)
    exceeded.setflags(write=False)
    units = table.units if isinstance(table, Table) else {}
    names = (im, units.get(im, "1"), limit)
    with ticking(progress) as tick:
        return Fragility(measures, exceeded, link, ci, groups, samples, seed, tick, names)


def _no_tick(done: int, total: int) -> None:
    """What a curve that comes back from a file shows of its progress."""
