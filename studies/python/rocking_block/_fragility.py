"""Fragility curves."""

from __future__ import annotations

import dataclasses
import os
import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np
import numpy.typing as npt

from rocking_block import _engine
from rocking_block._cases import Files, Question, Rows, cases_of, limit_of, limit_word, rows_of
from rocking_block._record import Record
from rocking_block._surface import Second, Surface, columns_of
from rocking_block._table import Table, split_heading
from rocking_block._html import html_table
from rocking_block._words import Floats, chosen, ticking

if TYPE_CHECKING:
    import pandas
    from matplotlib.axes import Axes
    from typing_extensions import Self


def intensity(
    record: Record,
    periods: npt.ArrayLike = (),
    *,
    g: float = 9.81,
    transverse: Record | None = None,
    percentile: float = 50.0,
) -> dict[str, float]:
    """Returns intensity measures of a record, exact for accelerations that are linear between samples.

    The baseline is not corrected. With a transverse record they are percentiles over all directions: RotD50, or RotD100
    with percentile = 100 (Boore, 2010).

    PGA [m/s²], PGV [m/s], PGD [m], PGV/PGA [s], Arias intensity [m/s], CAV [m/s], significant duration D5-95 [s], mean
    period T_m [s], Housner's spectrum intensity SI [m], and Sa [m/s²] and Sv [m/s] of 5 % damping at each period; nan
    for undefined measures.

    Parameters
    ----------
    record : Record
        The record.
    periods : array_like
        Periods of Sa and Sv [s], 0.001 to 1000.
    g : float
        Gravity in the Arias intensity [m/s²].
    transverse : Record, optional
        The horizontal component at a right angle to the record.
    percentile : float
        Percentile over 180 directions, one degree apart, 0 to 100; only with `transverse`.

    Examples
    --------
    >>> import rocking_block as rb
    >>> measures = rb.intensity(rb.Record([0.0, 1.0, -1.0, 0.0], dt=0.5), periods=[1.0])
    >>> measures["PGA"], measures["PGV"]
    (1.0, 0.375)
    """
    listed = np.atleast_1d(np.asarray(periods, dtype=np.float64)).tolist()
    if transverse is None:
        return dict(_engine.intensity(record, listed, g))
    return dict(_engine.rot_d(record, transverse, percentile, listed, g))


class GoodnessOfFit(NamedTuple):
    """The deviance of a curve from the fractions of groups of rows, compared with χ²; corrected where records repeat."""

    deviance: float
    degrees_of_freedom: int
    p: float
    """Probability of at least this deviance if the curve is true."""


class Fragility(_engine.Fragility):
    """A maximum-likelihood fragility curve `P = F(a + b ln IM)`; made by `fragility`.

    If F is the normal distribution (probit), it is the lognormal curve with the median `median`, exp(−a/b), and the
    dispersion `beta`, 1/b; if F is logistic (logit), it is logistic regression. `median_ci` and `beta_ci` are
    confidence intervals, and `coefficients` are a and b with their `standard_errors`. `log_likelihood`, `auc` (area
    under the receiver operating characteristic), `brier` (Brier score) and `efficiency` (scatter of the peaks about a
    power of the measure) show how well the measure predicts the outcome. `rocking` is the number of blocks behind the
    efficiency, which lifted off, reached a thousandth of α and stand. `independence` names the units that the intervals
    treat as independent.
    """

    im: str
    """The intensity measure."""
    unit: str
    """Unit of the measure; empty if the table has none."""
    limit: str | float
    """The limit: "overturned", "balance", a rotation |θ|/α [1], a slip or plastic elongation [m] as in "slip>0.1" or "plastic>0.02", "half_cycles>20", or "breaks"; of blocks in space "tilt/alpha>0.5", "twist>0.1" or "drift>0.1"."""
    ci: float
    """Confidence level of intervals and bands."""
    failed: int
    """Rows omitted because their runs failed."""
    undecided: int
    """Rows omitted because their duration was too short."""
    separated: int
    """Rows omitted because their runs ended at complete separation, with the outcome open."""
    without_response: int
    """Rows omitted because their runs were completed without the response of the limit."""
    fraction_range: tuple[float, float]
    """Least and greatest fraction of all rows that exceed the limit [1]: without and with rows and samples whose outcome is unknown."""
    sufficiency: Mapping[str, float]
    """For each column of `beside`, the probability that the likelihood grows as much by chance with it: below 0.05, say, the measure is not sufficient."""
    surface: Surface | None
    """The surface over both measures, with `surface`."""
    _source: Rows | Files
    _arguments: tuple[Any, ...]
    _cluster: str | None

    def __new__(
        cls,
        source: Rows | Files,
        options: tuple[str, float, int | None, int],
        labels: tuple[str, str, str | float, int, int, int, int, tuple[float, float]],
        tick: Any = lambda done, total: None,
        cases: _engine.Cases | None = None,
        cluster: str | None = None,
        unknown_exceed: bool | None = None,
    ) -> Self:
        if cases is None and isinstance(source, Files):
            cases = source.cases(unknown_exceed=unknown_exceed)
        if cases is not None:
            store, motions = cases.stored()
        else:
            assert not isinstance(source, Files)
            store, (measures, *_, numbers) = _engine.CaseStore(), source
            store.push(np.arange(len(measures), dtype=np.int64), *source, unknown_exceed)
            # Motions are numbered in the order of their first rows.
            motions = _engine.Motions.in_order(cluster, int(numbers.max(initial=-1)) + 1)
        fit = super().__new__(cls, store, motions, *options, tick)
        fit._source, fit.ci = source, options[1]
        fit.im, fit.unit, fit.limit, fit.failed, fit.separated, fit.undecided, fit.without_response, fit.fraction_range = labels
        fit._arguments, fit._cluster = (source, options, labels), motions.cluster
        fit.sufficiency, fit.surface = {}, None
        return fit

    def __reduce__(self) -> tuple[Any, ...]:
        return (_fragility_of, (*self._arguments, self._cluster, (self.rows, self.coefficients)), {"sufficiency": self.sufficiency, "surface": self.surface})

    def __copy__(self) -> Self:
        return self

    def __deepcopy__(self, _: object) -> Self:
        # Nothing changes a curve, and its files may have changed.
        return self

    @property
    def measures(self) -> Floats:
        """The intensity measure of each row in the fit, shape (n,). A curve of files reads them again, in the order of the files."""
        return self._rows()[0]

    @property
    def fractions(self) -> Floats:
        """The fraction of each row's runs that exceeded the limit, 0 or 1 for a single run, shape (n,); read as `measures`."""
        return self._rows()[1]

    def _rows(self) -> tuple[Floats, Floats]:
        source = self._every_row()
        # Those in the fit.
        known = ~np.isnan(source[0]) & ~np.isnan(source[1])
        if known.sum() != self.rows:
            raise ValueError(f"found {known.sum()} rows in the files of the curve; expected the {self.rows} of its fit")
        return source[0][known], source[1][known]

    def _every_row(self) -> Rows:
        source = self._source
        return rows_of(source.cases(keep=True)) if isinstance(source, Files) else source

    def _completed(self, unknown_exceed: bool) -> Fragility | None:
        """Returns the curve if all runs without a known outcome exceed the limit, or none; None where there is no such curve."""
        source, (link, ci, _, seed), labels = self._arguments
        try:
            return Fragility(source, (link, ci, None, seed), labels, cluster=self._cluster, unknown_exceed=unknown_exceed)
        except ValueError:
            return None

    @property
    def goodness_of_fit(self) -> GoodnessOfFit | None:
        """Whether the curve fits up to twelve groups of rows with adjacent measures; None for fewer than three."""
        return None if self.goodness is None else GoodnessOfFit(*self.goodness)

    def curve(self, x: npt.ArrayLike) -> Floats:
        """Returns the probability of exceeding the limit [1] at measures `x` > 0 of any array shape."""
        measures = np.asarray(x, dtype=np.float64)
        return self.probabilities(measures.ravel()).reshape(measures.shape)

    def band(self, x: npt.ArrayLike) -> tuple[Floats, Floats]:
        """Returns the lower and upper ends of the pointwise confidence interval of that probability [1]."""
        measures = np.asarray(x, dtype=np.float64)
        low, high = self.intervals(measures.ravel())
        return low.reshape(measures.shape), high.reshape(measures.shape)

    def plot(
        self, ax: Axes | None = None, *, label: str | None = None, color: Any = None, runs: bool = True, **style: Any
    ) -> Axes:
        """Draws the curve, its band and the runs with Matplotlib. Several curves can share axes.

        Parameters
        ----------
        ax : Axes, optional
            Axes to draw on; by default pyplot's current axes, or a new figure if these show another kind of plot.
        label : str, optional
            Name of the curve in the legend; by default the measure, the median and β.
        color
            Colour of the curve, its band and its runs.
        runs : bool
            Whether to mark the runs, and the fraction that exceeds the limit in up to ten classes of equal size.
        **style
            Options of `Axes.plot` for the curve.
        """
        from rocking_block import _plot

        return _plot.fragility(self, self._limit(), ax, label, color, runs, style)

    def export(self, program: Literal["pelicun", "openquake"], path: str | os.PathLike[str], **options: Any) -> None:
        """Writes the curve for a program of loss assessment: `export_fragility` with this curve alone.

        Parameters
        ----------
        program, path
            As there.
        **options
            `id`, the component of pelicun or the taxonomy of OpenQuake's assets, "rocking.block" by default; and the
            `alpha`, `p` and `g` of `export_fragility`.
        """
        export_fragility({options.pop("id", "rocking.block"): self}, program, path, **options)

    def _repr_html_(self) -> str:
        unit = f" {self.unit}" if self.unit not in ("", "1") else ""
        fit = self.goodness_of_fit
        ends = [[f"{end:.4g}" for end in pair] for pair in (self.median_ci, self.beta_ci)]
        rows = [
            ("median", f"{self.median:.4g}{unit}", f"[{', '.join(ends[0])}]"),
            ("β", f"{self.beta:.3g}", f"[{', '.join(ends[1])}]"),
            ("exceeded", self._exceeded(), ""),
            ("left out", f"{self.failed} failed, {self.separated} separated, {self.undecided} undecided, {self.without_response} without response", ""),
            *([("deviance of the fit", f"{fit.deviance:.4g} (df = {fit.degrees_of_freedom}), p = {fit.p:.3g}", "")] if fit else []),
            ("AUC, Brier score", f"{self.auc:.3f}, {self.brier:.3f}", ""),
        ]
        return html_table(f"{self._limit()} over {self.im}, {100 * self.ci:g} % intervals", (), rows)

    def _limit(self) -> str:
        return self.limit if isinstance(self.limit, str) else f"|θ|/α > {self.limit:g}"

    def __repr__(self) -> str:
        unit = f" {self.unit}" if self.unit not in ("", "1") else ""
        median, beta = self.median_ci, self.beta_ci
        return (
            f"<Fragility of {self._limit()} over {self.im}: median {self.median:.4g}{unit} "
            f"[{median[0]:.4g}, {median[1]:.4g}], beta {self.beta:.3g} [{beta[0]:.3g}, {beta[1]:.3g}], "
            f"{self._exceeded()}>"
        )

    def _exceeded(self) -> str:
        # Digits beyond the tenth are round-off of the fractions of ensembles.
        return f"{self.exceeded:.10g} of {self.rows} runs"


def _fragility_of(source: Rows | Files, options: Any, labels: Any, cluster: str | None, found: tuple[int, tuple[float, float]]) -> Fragility:
    """Restores a pickled curve with its number of rows and its coefficients."""
    fit = Fragility(source, options, labels, cluster=cluster)
    if (fit.rows, fit.coefficients) != found:
        of = source.path if isinstance(source, Files) else "the rows"
        raise ValueError(f"{of}: changed since the curve was fitted; expected {found[0]} rows with the coefficients {found[1]}")
    return fit


def fragility(
    table: Table | pandas.DataFrame | Mapping[str, npt.ArrayLike] | str | os.PathLike[str],
    im: str,
    limit: str | float | None = None,
    *,
    ci: float = 0.95,
    link: Literal["probit", "logit"] = "probit",
    intervals: Literal["profile", "bootstrap"] = "profile",
    samples: int = 1000,
    seed: int = 1,
    cluster: str | None = None,
    where: Mapping[str, str | float] | None = None,
    surface: str | None = None,
    beside: str | Sequence[str] = (),
    partial: bool = False,
    progress: bool | None = None,
) -> Fragility:
    """Fits a fragility curve to the runs of a table, by maximum likelihood.

    The method is that of J. W. Baker, Efficient analytical fragility function fitting using dynamic structural
    analysis, Earthquake Spectra 31 (2015) 579-599, without grouping by levels.

    Parameters
    ----------
    table : Table, DataFrame, mapping or path
        Runs of `sweep`, `outcomes` or `spectrum`, or ensembles of a sweep with their probabilities; the CSV file of
        `rocking sweep`, a Parquet file of `Table.to_parquet`, or a DataFrame of either; a folder of parts or of other such files, or
        a pattern of them, read in batches, so that tables larger than the memory can be fitted; or your own table
        with the measure and an `outcome`, and for other limits `peak.theta/alpha`, `peak.slip` or `peak.damper_1.plastic` or `half_cycles>0.005`. The fit omits
        rows without the measure, failed runs, and runs whose duration or complete separation ended them before the outcome was
        decided.
    im : str
        Name of the column of the intensity measure, such as "PGV", "Sa(0.5)" or "p PGV/(g tan alpha)", with or without the unit in its
        heading.
    limit : "overturned", "balance", float or str, optional
        The limit: overturning, the balance (the rotation that puts the centre of mass over the corner), a rotation |θ|/α > 0 [1], or a
        slip or a plastic elongation of any tie or damper in metres, as in "slip:0.1" or "plastic:0.02", or the half cycles of a study, as in "half_cycles:20", or "breaks", a tie or damper that breaks; a block that overturned exceeds any. For blocks in space a number is the tilt
        over that of the balance in the direction of the lean, "balance" is 1 of it, and there are "twist:0.1" in rad and "drift:0.1" in metres. By default overturning, or the balance for blocks with
        ties, which may hold a block beyond it.
    ci : float
        Confidence level of intervals and bands, above 0 and below 1.
    link : {"probit", "logit"}
        Normal or logistic distribution: a lognormal curve, or logistic regression.
    intervals : {"profile", "bootstrap"}
        Profile-likelihood intervals, clustered by ground motion if several runs share one, or intervals from a bootstrap of
        whole motions, which needs ten or more. `Fragility.independence` names the rule. Runs without records are independent.
    samples, seed : int
        Number of bootstrap samples, and their random seed.
    cluster : str, optional
        Column whose values cluster the rows, instead of the ground motions: event and station, as far as `motion`, or the names in
        `record` and `vertical`, tell them.
    where : mapping, optional
        Use only the rows in which each of these columns has this value, as in `{"foundation": "rigid"}`.
    surface : str, optional
        Second measure, for a surface of both: `Fragility.surface`.
    beside : str or list of str
        Columns against which the sufficiency of the measure is tested: `Fragility.sufficiency`.
    partial : bool
        Fit the parts of a folder although some are missing.
    progress : bool, optional
        Whether to show a tqdm progress bar.

    Raises
    ------
    ValueError
        The measure does not exist, no best curve exists (a single class, or classes that do not overlap), the rows are searches for
        least levels, or an option is invalid.

    Warns
    -----
    UserWarning
        Runs are undecided or lack the response of the limit, the probability falls as the measure grows, or a bootstrap of fewer than ten records has no intervals.

    Examples
    --------
    >>> import rocking_block as rb
    >>> rows = {"PGV": [0.2, 0.25, 0.3, 0.4, 0.45, 0.5, 0.6, 0.7, 0.9, 1.1], "outcome": ["completed"] * 10,
    ...         "peak.theta/alpha": [0.5] * 10}
    >>> for i in (3, 6, 7, 8, 9):
    ...     rows["outcome"][i] = "overturned"
    >>> fit = rb.fragility(rb.Table(rows, {"PGV": "m/s"}), im="PGV")
    >>> fit
    <Fragility of overturned over PGV: median 0.4732 m/s [0.3027, 0.7396], beta 0.272 [0.0908, 1.3], 5 of 10 runs>
    >>> fit.curve([0.3, 0.6]).round(3)
    array([0.047, 0.809])
    """
    if not isinstance(im, str):
        raise TypeError(f"im = {im!r}; expected the name of one column, such as 'PGV'")
    source: Rows | Files
    question = Question(im, limit, cluster, tuple((where or {}).items()))
    resampled = chosen("intervals", intervals, ("profile", "bootstrap")) == "bootstrap"
    if isinstance(table, str | os.PathLike):
        source = Files(os.fspath(table), partial, question)
        cases = source.cases()
        source = dataclasses.replace(source, question=dataclasses.replace(question, limit=limit_of(cases.limit)))
    elif not hasattr(table, "keys") or not hasattr(table, "__getitem__"):
        raise TypeError(f"table = {table!r}; expected a Table, a DataFrame, a mapping of columns, or the path of a file")
    elif partial:
        raise ValueError("partial has no effect without a folder of parts")
    else:
        cases = cases_of(table, question)
        source = rows_of(cases)
    (im, unit), (rows, failed, separated, undecided, missing, partly) = cases.heading, cases.counts
    least, most = cases.exceeded
    # The fit refuses a table without rows.
    rows = max(rows, 1)
    labels = (im, unit or "", limit_of(cases.limit), failed, separated, undecided, missing, (least / rows, most / rows))
    options = (link, ci, samples if resampled else None, seed)
    with ticking(progress) as tick:
        fit = Fragility(source, options, labels, tick, cases, cluster)
    tested = [split_heading(column)[0] for column in ([beside] if isinstance(beside, str) else beside)]
    other = None if surface is None else split_heading(surface)[0]
    if tested or other is not None:
        columns = columns_of(table, [*tested, *([] if other is None else [other])], question, partial)
        second = Second(fit._every_row(), columns, link, fit._cluster)
        fit.sufficiency = {name: second.sufficiency(name) for name in tested}
        fit.surface = None if other is None else second.surface(im, other)
    doubts = [f"{fit.undecided} undecided rows may exceed the limit and are left out of the curve"] if fit.undecided else []
    if partly:
        doubts.append(f"in {partly} rows, samples without a known outcome may exceed the limit and are left out of its probability")
    if fit.without_response:
        doubts.append(f"{fit.without_response} rows without the response of the limit are left out of the curve")
    if doubts:
        span = " to ".join(f"{100 * share:.1f} %" for share in fit.fraction_range)
        warnings.warn(f"{'; '.join(doubts)}: it is exceeded in {span} of all rows", stacklevel=2)
    for warning in fit.warnings(f"{im} [{unit}]" if unit else im):
        warnings.warn(warning, stacklevel=2)
    return fit


def export_fragility(
    curves: Mapping[str, Fragility | Sequence[Fragility]],
    program: Literal["pelicun", "openquake"],
    path: str | os.PathLike[str],
    *,
    alpha: float | None = None,
    p: float | None = None,
    g: float = 9.81,
) -> None:
    """Writes lognormal curves for a program of loss assessment.

    Several curves of a component, over one measure and of different limits, are its damage states in the order of their medians.

    Parameters
    ----------
    curves : mapping
        The curve or curves of each component of pelicun, or of each taxonomy of OpenQuake's assets. Identifiers have letters,
        digits, dots and underscores.
    program : {"pelicun", "openquake"}
        pelicun's component library, over PGA, PGV, PFA, PFV, Sa(T) or Sv(T); or OpenQuake's fragility model in NRML 0.5, over
        PGA, PGV or Sa(T), with the same limits for all components.
    path : path
        Folder for pelicun's `fragility.csv` and `fragility.json`, or the file for OpenQuake. Existing files are replaced.
    alpha, p : float, optional
        Slenderness [rad] and frequency parameter [rad/s] of the block, for curves over "p PGV/(g tan alpha)" and the like.
    g : float
        Gravity of accelerations in g, and for the same [m/s²].

    Raises
    ------
    ValueError
        A logistic or falling curve, a measure without a unit or that the program does not have, or curves that do not fit together.

    Warns
    -----
    UserWarning
        The curves of two damage states cross at a probability above 0.0001 and below 0.9999.

    Examples
    --------
    >>> import tempfile
    >>> import rocking_block as rb
    >>> rows = {"PFV": [0.2, 0.3, 0.4, 0.5, 0.6, 0.8], "outcome": ["completed", "overturned"] * 3}
    >>> fit = rb.fragility(rb.Table(rows, {"PFV": "m/s"}), im="PFV")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     rb.export_fragility({"E.20.22.102a": fit}, "pelicun", folder)
    ...     print(open(f"{folder}/fragility.csv").read().splitlines()[1][:42])
    E.20.22.102a,0,Peak Floor Velocity,mps,0,1
    """
    components = []
    for name, curve in curves.items():
        states = [curve] if isinstance(curve, Fragility) else curve
        if not isinstance(states, Sequence) or not states or not all(isinstance(state, Fragility) for state in states):
            raise TypeError(f"curves[{name!r}] = {curve!r}; expected a Fragility or several")
        measures = sorted({(state.im, state.unit) for state in states})
        if len(measures) > 1:
            shown = " and ".join(f"{im} [{unit}]" if unit else im for im, unit in measures)
            raise ValueError(f"found curves over {shown} for {name}; expected one measure in one unit")
        im = measures[0][0]
        limits = [limit_word(state.limit) for state in states]
        rows = states[0].rows
        description = f"{', '.join(limits)} over {im} in {rows} rows, by rocking-block {_engine.__version__}"
        components.append((name, measures[0], list(zip(limits, states, strict=True)), description))
    texts, remarks = _engine.export_fragility(program, components, alpha, p, g)
    files = [Path(path)]
    if len(texts) == 2:
        files[0].mkdir(parents=True, exist_ok=True)
        files = [files[0] / "fragility.csv", files[0] / "fragility.json"]
    for file, text in zip(files, texts, strict=True):
        file.write_text(text, encoding="utf-8", newline="\n")
    for remark in remarks:
        warnings.warn(remark, stacklevel=2)
