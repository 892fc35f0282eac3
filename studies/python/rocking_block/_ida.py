"""Incremental dynamic analysis."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import numpy.typing as npt

from rocking_block import _engine
from rocking_block._cases import columns
from rocking_block._studies import swept
from rocking_block._table import Table, by_name, read_table, split_heading
from rocking_block._words import Floats, OnSeparation

if TYPE_CHECKING:
    import pandas
    from matplotlib.axes import Axes
    from typing_extensions import Self


class IdaCurve(NamedTuple):
    """The peaks of one block under one ground motion at increasing levels."""

    name: str
    """Block and ground motion, as the table describes them."""
    levels: Floats
    """Levels of the measure, increasing, shape (n,)."""
    peaks: Floats
    """Peak |θ|/α at the levels [1], in space the tilt over that of the balance, shape (n,): inf where the block overturns, nan where the outcome is unknown."""


class Ida(_engine.Ida):
    """Curves of incremental dynamic analysis over an intensity measure; made by `ida`.

    Overturning ranks above any peak. Between its levels a curve is linear, from rest without shaking; between a level that stands and a higher
    one that overturns, the block stands in the lower half.
    """

    im: str
    """The intensity measure."""
    unit: str
    """Its unit; empty if the table has none."""
    table: Table
    """The runs, one row each."""
    _arguments: tuple[Any, ...]

    def __new__(cls, table: Table, im: str) -> Self:
        found = super().__new__(cls, list(columns(table)), im)
        found.im, found.unit, found.table = im, table.units.get(im, ""), table
        found._arguments = (table, im)
        return found

    def __reduce__(self) -> tuple[Any, ...]:
        return (type(self), self._arguments)

    @property
    def curves(self) -> tuple[IdaCurve, ...]:
        """The curves, one for each block and ground motion."""
        return tuple(IdaCurve(*curve) for curve in self.all())

    @property
    def capacities(self) -> npt.NDArray[np.float64]:
        """For each curve, the least level that overturns and before it the greatest below that does not, shape (n, 2); nan without any."""
        return np.array(self.brackets(), dtype=np.float64).reshape(-1, 2)

    @property
    def breaks(self) -> Floats | None:
        """For each curve, the least level at which a tie or damper breaks, shape (n,): nan where none does; None for blocks without either."""
        return self.breaking_levels()

    def fractile(self, fraction: float) -> Floats:
        """Returns the peak |θ|/α [1] that this fraction of the curves does not exceed, at `levels`; inf is overturning, nan unknown.

        A curve without a decided run at a level, or beyond its last one that stands, may have any peak there: a fractile is known where all
        of them give the same.
        """
        return self.peaks(_fraction(fraction))

    def level(self, fraction: float, peak: float | None = None) -> float | None:
        """Returns the level at which this fraction of the curves has first reached a peak |θ|/α, or has overturned.

        Parameters
        ----------
        fraction : float
            Fraction of the curves, above 0 and below 1.
        peak : float, optional
            The peak |θ|/α > 0 [1]; by default overturning, in the middle between the levels that stand and overturn.

        Returns
        -------
        float or None
            The level, in the unit of the measure; None where fewer curves get there, or where it depends on runs without a known outcome.
        """
        if peak is not None and not 0.0 < peak < np.inf:
            raise ValueError(f"peak = {peak}; expected a peak |θ|/α > 0")
        low, high = self.level_bounds(_fraction(fraction), peak)
        return low if low == high else None

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draws the curves, and their fractiles of 16, 50 and 84 %, with Matplotlib; a curve leaves to the right where it overturns."""
        from rocking_block import _plot_ida

        return _plot_ida.ida(self, ax)

    def __repr__(self) -> str:
        unit = f" {self.unit}" if self.unit not in ("", "1") else ""
        overturned = int(np.isfinite(self.capacities[:, 1]).sum())
        median = self.level(0.5)
        shown = "no known level" if median is None else f"{median:.4g}{unit}"
        return f"<Ida over {self.im}: {len(self.curves)} curves, {overturned} overturn, the median at {shown}>"


def ida(
    study: str | os.PathLike[str] | Mapping[str, Any] | Table | pandas.DataFrame,
    im: str | None = None,
    *,
    on_separation: OnSeparation | None = None,
    out: str | os.PathLike[str] | None = None,
    threads: int | None = None,
    progress: bool | None = None,
) -> Ida:
    """Runs an incremental dynamic analysis, or reads one from a table.

    A study says in `[study]` which levels of an intensity measure to run: given ones, `levels = { im = "PGV", values = [0.2, 0.4] }`, or by hunt
    and fill, `hunt = { im = "PGV", first = 0.1, runs = 12 }`, for each record and block alone: the level rises by growing steps until the
    block overturns, then runs close in on the least level that does, and the others fill the widest gaps below (D. Vamvatsikos,
    C. A. Cornell, Applied incremental dynamic analysis, Earthquake Spectra 20 (2004) 523-553). docs/studies/fragility.md has all keys.

    Parameters
    ----------
    study : path, mapping, Table or DataFrame
        A study as of `sweep`, or the table of one: also the CSV or Parquet file of a table.
    im : str, optional
        Measure of the levels; by default that of the study. A table needs it.
    on_separation, out, threads, progress
        As in `sweep`.

    Raises
    ------
    ValueError
        The study has a mistake or no levels; a row of the table has no level, or two of a curve have one.

    Examples
    --------
    >>> import rocking_block as rb
    >>> rows = {"record": ["a"] * 3 + ["b"] * 3, "scale": [1.0, 2.0, 3.0] * 2, "PGV": [0.2, 0.4, 0.6] * 2,
    ...         "outcome": ["completed", "completed", "overturned"] * 2, "peak.theta/alpha": [0.1, 0.4, 9.0, 0.3, 0.7, 9.0]}
    >>> analysis = rb.ida(rb.Table(rows, {"PGV": "m/s"}), "PGV")
    >>> analysis
    <Ida over PGV: 2 curves, 2 overturn, the median at 0.5 m/s>
    >>> analysis.fractile(0.5)
    array([0.1, 0.4, inf])
    >>> analysis.level(0.84, peak=0.4)
    0.4
    """
    if (isinstance(study, Mapping) and "study" in study) or (
        isinstance(study, str | os.PathLike) and os.fspath(study).lower().endswith(".toml")
    ):
        table, of_study = swept(study, on_separation, out, threads, progress)
        im = im or of_study
        if im is None:
            raise ValueError('the study has no levels; expected levels or hunt in [study], or im, such as "PGV"')
    else:
        for name, value in {"on_separation": on_separation, "out": out, "threads": threads, "progress": progress}.items():
            if value is not None:
                raise ValueError(f"{name} has no effect on a table")
        if im is None:
            raise ValueError('im is missing; expected the measure of the levels of the table, such as "PGV"')
        table = read_table(study) if isinstance(study, str | os.PathLike) else by_name(study)
    name = split_heading(im)[0]
    return Ida(table, name if name in table else _engine.measure_name(name))


def _fraction(fraction: float) -> float:
    if not 0.0 < fraction < 1.0:
        raise ValueError(f"fraction = {fraction}; expected a number above 0 and below 1")
    return float(fraction)
