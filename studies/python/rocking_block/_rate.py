"""Annual rates from hazard and fragility curves."""

from __future__ import annotations

import os
import warnings
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from rocking_block import _engine
from rocking_block._fragility import Fragility
from rocking_block._html import html_table
from rocking_block._table import Table, split_heading
from rocking_block._words import Floats, number

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from typing_extensions import Self


class Hazard:
    """A hazard curve: the annual rate at which an intensity measure is exceeded.

    Between levels it is a power law, linear in logarithmic axes; the first and the last one continue beyond them.

    Parameters
    ----------
    levels : array_like
        Levels of the measure, above 0 and increasing.
    rates : array_like
        Their annual rates of exceedance, which do not increase. Levels at the end with a rate of 0 are left out.
    im : str
        The measure, such as "PGV" or "Sa(1 s)".
    unit : str
        Unit of the levels. g, cm/s2, cm/s and cm are converted to SI units.
    g : float
        Gravity, for levels in g [m/s²].

    Raises
    ------
    ValueError
        Levels that do not increase, rates that do, or fewer than two rates above 0.

    Examples
    --------
    >>> import rocking_block as rb
    >>> rb.Hazard([10, 20, 50], [5e-3, 1e-3, 1e-4], im="PGV", unit="cm/s")
    <Hazard of PGV: 3 levels from 0.1 to 0.5 m/s, annual rates 0.005 to 0.0001>
    """

    def __init__(
        self, levels: npt.ArrayLike, rates: npt.ArrayLike, im: str = "", unit: str = "", *, g: float = 9.81
    ) -> None:
        fields = _engine.check_hazard(_floats("levels", levels), _floats("rates", rates), unit or None, g)
        self._set(_engine.measure_name(im), *fields)

    def _set(self, im: str, levels: Floats, rates: Floats, _: str | None, unit: str | None, remarks: list[str]) -> None:
        for column in (levels, rates):
            column.setflags(write=False)
        self._levels, self._rates, self._im, self._unit, self._remarks = levels, rates, im, unit or "", tuple(remarks)

    def _over(self, measure: tuple[str, str], alpha: float | None, p: float | None, g: float) -> Hazard:
        """Returns the curve over the measure of a fragility curve, with its name and its unit."""
        fields = _engine.hazard_over(self.levels, self.rates, self.im, self.unit, measure, alpha, p, g)
        curve = Hazard.__new__(Hazard)
        curve._set(fields[2] or "", *fields)
        curve._remarks = self._remarks
        return curve

    @property
    def levels(self) -> Floats:
        """Levels of the measure, shape (n,)."""
        return self._levels

    @property
    def rates(self) -> Floats:
        """Annual rates of exceedance [1/year], shape (n,)."""
        return self._rates

    @property
    def im(self) -> str:
        """The intensity measure; empty if unknown."""
        return self._im

    @property
    def unit(self) -> str:
        """Unit of the levels; empty if unknown."""
        return self._unit

    @property
    def remarks(self) -> tuple[str, ...]:
        """Remarks on levels of a file that were left out."""
        return self._remarks

    def _repr_html_(self) -> str:
        headings = [f"{self.im or 'level'} [{self.unit}]" if self.unit else self.im or "level", "annual rate [1/year]", "return period [years]"]
        rows = zip(self.levels[:10], self.rates[:10], 1.0 / self.rates[:10], strict=True)
        more = "; the first 10 are shown" if len(self.levels) > 10 else ""
        return html_table(f"hazard curve of {len(self.levels)} levels{more}", headings, rows)

    def __repr__(self) -> str:
        measure, unit = f" of {self.im}" if self.im else "", f" {self.unit}" if self.unit not in ("", "1") else ""
        levels = f"{len(self.levels)} levels from {self.levels[0]:.4g} to {self.levels[-1]:.4g}{unit}"
        return f"<Hazard{measure}: {levels}, annual rates {self.rates[0]:.3g} to {self.rates[-1]:.3g}>"


def read_hazard(
    path: str | os.PathLike[str],
    *,
    im: str | None = None,
    unit: str | None = None,
    site: str | Sequence[float] | None = None,
    investigation_time: float | None = None,
    kind: str | None = None,
    g: float = 9.81,
) -> Hazard:
    """Reads a hazard curve, in SI units.

    Parameters
    ----------
    path : path
        CSV with two columns such as `PGV [m/s],rate [1/year]`; hazard curves that OpenQuake or nshmp-haz exported as CSV; or
        JSON of the hazard services of the USGS.
    im : str, optional
        The measure: the choice in a file of several, or that of a file that does not name it.
    unit : str, optional
        Unit of the levels, if the file does not name it.
    site : str or sequence of float, optional
        Name of the site, or its longitude and latitude as in (-122.4, 37.75), in a file of several.
    investigation_time : float, optional
        Years to which the probabilities of the file refer. Without it, the file has annual rates, or names the time itself.
    kind : str, optional
        Kind of the curves of OpenQuake, such as "quantile-0.84", instead of the mean.
    g : float
        Gravity, for levels in g [m/s²].

    Raises
    ------
    ValueError
        Another format, several curves without a choice, or curves of another kind.
    """
    if site is not None and not isinstance(site, str):
        site = ",".join(repr(number("site", coordinate)) for coordinate in site)
    curve = Hazard.__new__(Hazard)
    fields = _engine.read_hazard(path, im=im, unit=unit, site=site, investigation_time=investigation_time, kind=kind, g=g)
    curve._set(fields[2] or "", *fields)
    return curve


class AnnualRate(_engine.AnnualRate):
    """The annual rate at which a limit is exceeded; made by `annual_rate`.

    `rate` is the rate [1/year] and `rate_ci` its interval, None without a fitted curve. `rate_of_unknown` are the rates if none, and if all, of
    the rows without a known outcome exceed the limit, nan without a curve then, and None where all outcomes are known. `below_hazard` and `above_hazard` are its
    parts from measures outside the hazard's levels [1/year]. `between(low, high)` gives the part from a range of the measure,
    `quantile(share)` the measure below which a share of the rate arises, and `probability(years)` the probability of at
    least one event in some years.
    """

    hazard: Hazard
    """The hazard curve, of the measure of the fragility curve."""
    rows: tuple[float, float] | None
    """Least and greatest measure of the rows behind a fitted curve."""
    rate_of_unknown: tuple[float, float] | None
    """Annual rates [1/year] if none, and if all, of the rows without a known outcome exceed the limit."""
    _arguments: tuple[Any, ...]

    def __new__(
        cls,
        hazard: Hazard,
        fit: Fragility | None,
        lognormal: tuple[float, float] | None,
        table: tuple[Floats, Floats] | None,
    ) -> Self:
        rate = super().__new__(cls, hazard.levels, hazard.rates, fit, lognormal, table)
        rate.hazard = hazard
        rate.rows = None if fit is None else fit.range
        rate.rate_of_unknown = None
        if fit is not None and fit.fraction_range[1] > fit.fraction_range[0]:
            rate.rate_of_unknown = (cls._completed(hazard, fit, False), cls._completed(hazard, fit, True))
        rate._arguments = (hazard, fit, lognormal, table)
        return rate

    @staticmethod
    def _completed(hazard: Hazard, fit: Fragility, unknown_exceed: bool) -> float:
        """Returns the rate if all rows without a known outcome exceed the limit, or none; nan without a curve."""
        completed = fit._completed(unknown_exceed)
        try:
            return np.nan if completed is None else _engine.AnnualRate(hazard.levels, hazard.rates, completed, None, None).rate
        except ValueError:
            return np.nan

    def __reduce__(self) -> tuple[Any, ...]:
        return (type(self), self._arguments)

    @property
    def return_period(self) -> float:
        """The mean time between two events, 1/rate [years]."""
        return 1.0 / self.rate if self.rate > 0.0 else np.inf

    @property
    def deaggregation(self) -> Table:
        """The parts of the rate below, between and above the hazard's levels: columns from, to, rate and share."""
        unit = self.hazard.unit or "1"
        units = {"from": unit, "to": unit, "rate": "1/year", "share": "1"}
        return Table(dict(zip(units, self.parts(), strict=True)), units)

    @property
    def extrapolated(self) -> dict[str, float]:
        """Shares of the rate from beyond the hazard's levels, and beyond the rows of a fitted curve [1]."""
        parts = {"below_hazard": self.below_hazard, "above_hazard": self.above_hazard}
        if self.rows is not None:
            parts |= {"below_rows": self.between(0.0, self.rows[0]), "above_rows": self.between(self.rows[1], np.inf)}
        return {name: part / self.rate if self.rate > 0.0 else 0.0 for name, part in parts.items()}

    def plot(self, ax: Axes | None = None, **style: Any) -> Axes:
        """Draws the measures from which the rate comes with Matplotlib: its density over the logarithm of the measure.

        Parameters
        ----------
        ax : Axes, optional
            Axes to draw on; by default pyplot's current axes, or a new figure if these show another kind of plot.
        **style
            Options of `Axes.plot`.
        """
        from rocking_block import _plot

        return _plot.annual_rate(self, self.hazard.im or "intensity measure", self.hazard.unit, ax, style)

    def _rows(self) -> list[tuple[str, str]]:
        unit = f" {self.hazard.unit}" if self.hazard.unit not in ("", "1") else ""
        ends = "" if self.rate_ci is None else f" [{self.rate_ci[0]:.3g}, {self.rate_ci[1]:.3g}]"
        unknown = ""
        if self.rate_of_unknown is not None:
            unknown = " ({:.3g} to {:.3g} with the rows of unknown outcome)".format(*self.rate_of_unknown)
        low, middle, high = (self.quantile(share) for share in (0.05, 0.5, 0.95))
        return [
            ("annual rate", f"{self.rate:.3g}{ends}{unknown}"),
            ("return period", f"{self.return_period:.4g} years"),
            ("in 50 years", f"{100 * self.probability(50.0):.3g} %"),
            ("comes from", f"half below {middle:.4g}{unit}, 90 % between {low:.4g} and {high:.4g}{unit}"),
        ]

    def _repr_html_(self) -> str:
        return html_table(f"over {self.hazard.im}", (), self._rows())

    def __repr__(self) -> str:
        return "<AnnualRate " + "; ".join(f"{name} {value}" for name, value in self._rows()[:3]) + ">"


# Share of the rate from beyond the data that draws a warning.
_NOTABLE = 0.01


def annual_rate(
    hazard: Hazard,
    fragility: Fragility | Sequence[Any],
    im: str | None = None,
    *,
    alpha: float | None = None,
    p: float | None = None,
    g: float = 9.81,
) -> AnnualRate:
    """Integrates a fragility curve over a hazard curve: the annual rate at which the limit is exceeded.

    The rate is `∫ P |dH|` (Cornell et al. 2002). With a hazard that is a power law between its levels, the integral is exact for
    lognormal and tabulated curves. The interval comes from the curve's band, or from its bootstrap.

    Parameters
    ----------
    hazard : Hazard
        The hazard curve, of the same measure as the fragility curve, or of the record's measure if that is relative to a block.
    fragility : Fragility or pair
        A fitted curve; a median and a dispersion β (0 for a step); or levels and their probabilities, linear in the
        logarithm of the measure between levels and constant beyond.
    im : str, optional
        Measure of a median or of levels with its unit, such as "PGA [g]". A fitted curve has that of its table.
    alpha, p : float, optional
        Slenderness [rad] and frequency parameter [rad/s] of the block, for curves over "p PGV/(g tan alpha)" and the like.
    g : float
        Gravity, for the same and for a curve over g [m/s²].

    Raises
    ------
    ValueError
        Measures that differ, a unit that is missing or of another dimension, or a curve whose probability falls with the measure.

    Warns
    -----
    UserWarning
        One per cent of the rate or more comes from beyond the hazard's levels or the rows of a fitted curve.

    Examples
    --------
    >>> import rocking_block as rb
    >>> hazard = rb.Hazard([0.1, 0.2, 0.5, 1.0, 2.0], [5e-3, 1e-3, 9e-5, 1.2e-5, 9e-7], im="PGV", unit="m/s")
    >>> rate = rb.annual_rate(hazard, (0.5, 0.4), "PGV [m/s]")
    >>> rate
    <AnnualRate annual rate 0.000154; return period 6487 years; in 50 years 0.768 %>
    >>> rate.deaggregation["share"].round(3)
    array([0.   , 0.031, 0.536, 0.356, 0.071, 0.006])
    """
    fit, lognormal, table = None, None, None
    if isinstance(fragility, Fragility):
        if im is not None:
            raise ValueError(f"im has no effect on a curve fitted over {fragility.im}")
        fit, over = fragility, (fragility.im, fragility.unit)
    else:
        try:
            first, second = fragility
        except (TypeError, ValueError):
            message = "a Fragility, a median and a dispersion, or levels and probabilities"
            raise TypeError(f"fragility = {fragility!r}; expected {message}") from None
        if np.ndim(first) == 0 and np.ndim(second) == 0:
            lognormal = (number("median", first), number("beta", second))
        else:
            table = (_floats("levels", first), _floats("probabilities", second))
        if im is None:
            of = "the median" if table is None else "the levels"
            raise ValueError(f'im is missing; expected the measure and the unit of {of}, such as im="PGA [g]"')
        name, unit = split_heading(im)
        over = (name, unit or "")
    hazard = hazard._over(over, alpha, p, g)
    found = AnnualRate(hazard, fit, lognormal, table)
    sources = {
        "below_hazard": f"below {hazard.levels[0]:.4g}, the least level of the hazard curve",
        "above_hazard": f"above {hazard.levels[-1]:.4g}, the greatest level of the hazard curve",
    }
    if found.rows is not None:
        sources["below_rows"] = f"below {found.rows[0]:.4g}, the least value in the rows of the fragility curve"
        sources["above_rows"] = f"above {found.rows[1]:.4g}, the greatest value in the rows of the fragility curve"
    for name, share in found.extrapolated.items():
        if share >= _NOTABLE:
            message = f"{100 * share:.3g} % of the rate comes from {hazard.im or 'measures'} {sources[name]}"
            warnings.warn(message, stacklevel=2)
    return found


def _floats(name: str, values: npt.ArrayLike) -> Floats:
    column = np.asarray(values, dtype=np.float64)
    if column.ndim != 1:
        raise ValueError(f"{name} has shape {column.shape}; expected one dimension")
    return column
