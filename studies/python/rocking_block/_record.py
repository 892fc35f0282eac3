"""Accelerograms."""

from __future__ import annotations

import os
import warnings
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import numpy.typing as npt

from rocking_block import _engine
from rocking_block._html import html_table
from rocking_block._obspy import check_gaps, refuse_masked, samples_of
from rocking_block._words import Floats

if TYPE_CHECKING:
    from collections.abc import Iterable

    from matplotlib.axes import Axes
    from typing_extensions import Self


# Files with a larger peak are refused as well [g].
LARGEST_PEAK = 20.0
# No earthquake has reached this acceleration [m/s²], 5 g; a larger value usually means a wrong unit.
IMPLAUSIBLE = 49.0


class Record(_engine.Record):
    """A ground acceleration, linear between evenly spaced samples and zero outside. It is immutable.

    Parameters
    ----------
    acceleration : array_like, shape (n,)
        Samples [`unit`], n ≥ 2; positive to the right in a horizontal record, upwards in a vertical one.
    dt : float
        Time between two samples [s], > 0.
    name : str
        Earthquake, station and component.
    start : float
        Time of the first sample [s].
    unit : {"g", "m/s2", "cm/s2", "gal"}
        Unit of the samples; the record has m/s².
    g : float
        Gravity that converts samples in g [m/s²].

    Raises
    ------
    ValueError
        Too few samples, a sample that is not finite, no time step, or a PGA above 20 g, as in files.

    Warns
    -----
    UserWarning
        A PGA above 100 m/s², which no earthquake has: the samples are probably in another unit.

    Examples
    --------
    >>> import rocking_block as rb
    >>> record = rb.Record([0.0, 3.0, -2.0, 0.0], dt=0.5, name="made up")
    >>> record
    Record('made up', 4 samples, dt=0.5 s, 1.5 s, PGA 3 m/s²)
    >>> record.t
    array([0. , 0.5, 1. , 1.5])
    """

    __slots__ = ()

    def __new__(
        cls,
        acceleration: npt.ArrayLike,
        dt: float,
        name: str = "",
        start: float = 0.0,
        *,
        unit: Literal["g", "m/s2", "cm/s2", "gal"] = "m/s2",
        g: float = 9.81,
    ) -> Self:
        refuse_masked(acceleration, f"{name}: " if name else "acceleration: ")
        samples = np.asarray(acceleration, dtype=np.float64) * _engine.unit_factor(unit, g)
        if samples.ndim != 1:
            raise ValueError(f"acceleration has shape {samples.shape}; expected one dimension, of samples")
        record = super().__new__(cls, samples, dt, name, start)
        if record.pga > LARGEST_PEAK * g:
            named = f"{name}: " if name else ""
            message = f"{named}the PGA is {record.pga:.4g} m/s², {record.pga / g:.3g} g, with unit = {unit!r}"
            raise ValueError(f"{message}; expected at most {LARGEST_PEAK:g} g")
        if record.pga > IMPLAUSIBLE:
            named = f"{name}: " if name else ""
            message = f"{named}the PGA is {record.pga:.4g} m/s², {record.pga / g:.3g} g; expected samples in m/s²"
            warnings.warn(message, stacklevel=2)
        return record

    @classmethod
    def from_obspy(cls, trace: Any, *, unit: str | None = None, g: float = 9.81) -> Self:
        """Returns the record of a trace of ObsPy, which reads miniSEED, SAC and many other formats.

        The name is the trace's id and start; the first sample is at 0 s.

        Parameters
        ----------
        trace : obspy.Trace
            Evenly spaced samples without a gap.
        unit : {"g", "m/s2", "cm/s2", "gal", "mm/s2"}, optional
            Unit of `trace.data` as they are. Without it, the response attached to the trace gives the unit: counts of an accelerometer are
            divided by its overall sensitivity; after `remove_response(output="ACC")` or `remove_sensitivity()` they are in its unit.
        g : float
            Gravity that converts samples in g [m/s²].

        Raises
        ------
        ValueError
            Masked samples, with the place of the first; no unit and no response; a sensor of velocities whose response has not been removed;
            and the errors of `Record`.
        """
        samples, dt, name = samples_of(trace, unit, g)
        return cls(samples, dt, name, g=g)

    @property
    def t(self) -> Floats:
        """Times of the samples [s], shape (n,)."""
        return self.start + np.arange(len(self), dtype=np.float64) * self.dt

    def scaled(self, factor: float) -> Record:
        """Returns the record with all accelerations multiplied by a factor.

        >>> import rocking_block as rb
        >>> rb.Record([0.0, 3.0, -2.0], dt=0.5).scaled(-2).pga
        6.0
        """
        return Record(self.acceleration * factor, self.dt, self.name, self.start)

    def processed(
        self,
        *,
        baseline: bool = False,
        band_pass: tuple[float, float] | None = None,
        resample: float | None = None,
    ) -> Record:
        """Returns the record without its linear trend, filtered, or with another time step, in this order.

        The name says what was done. A file read with the same options of the program gives the same bits.

        Parameters
        ----------
        baseline : bool
            Whether to subtract the line that fits the accelerations best.
        band_pass : (float, float), optional
            Corner frequencies [Hz] of a Butterworth filter of order 4, run forwards and backwards between zeros of
            1.5 · 4 periods of the lower corner.
        resample : float, optional
            New time step [s], with accelerations linear between the samples. A longer one needs a band-pass filter with its
            upper corner below the new Nyquist frequency.

        Raises
        ------
        ValueError
            Corners that do not increase from 0 to the Nyquist frequency, or a time step that would alias.

        Examples
        --------
        >>> import rocking_block as rb
        >>> rb.Record([0.0, 1.0, 0.0], dt=0.5, name="triangle").processed(resample=0.25)
        Record('triangle; resampled every 0.25 s', 5 samples, dt=0.25 s, 1 s, PGA 1 m/s²)
        """
        samples, dt, words = self._processed(baseline, band_pass, resample)
        return Record(samples, dt, "; ".join(part for part in (self.name, words) if part), self.start)

    def rotated(self, transverse: Record, angle: float) -> Record:
        """Returns the horizontal component at `angle` [degrees] from this record towards a transverse one.

        >>> import rocking_block as rb
        >>> a, b = rb.Record([0.0, 3.0, 0.0], dt=0.5), rb.Record([0.0, 4.0, 0.0], dt=0.5)
        >>> round(a.rotated(b, 53.13).pga, 4)
        5.0
        """
        samples, name = _engine.rotate(self, transverse, angle)
        return Record(samples, self.dt, name, self.start)

    def plot(self, ax: Axes | None = None, **style: Any) -> Axes:
        """Draws the acceleration over time with Matplotlib.

        Parameters
        ----------
        ax : Axes, optional
            Axes to draw on; by default pyplot's current axes, or a new figure if these show another kind of plot.
        **style
            Options of `Axes.plot`, such as `label`.
        """
        from rocking_block import _plot

        return _plot.record(self, self.t, ax, style)

    def _repr_html_(self) -> str:
        rows = [
            ("samples", f"{len(self)} every {self.dt:g} s, {self.duration:g} s"),
            ("PGA", f"{self.pga:.4g} m/s²"),
            ("PGV", f"{self.pgv:.4g} m/s"),
        ]
        return html_table(self.name or "record", (), rows)

    def __repr__(self) -> str:
        name = f"{self.name!r}, " if self.name else ""
        return f"Record({name}{len(self)} samples, dt={self.dt:g} s, {self.duration:g} s, PGA {self.pga:.3g} m/s²)"


def read_record(
    path: str | os.PathLike[str],
    *,
    unit: str | None = None,
    dt: float | None = None,
    format: str | None = None,
    channel: int | str | None = None,
    layout: str | None = None,
    skip: int | None = None,
    npts: int | None = None,
    value_scale: float | None = None,
    time_column: int | str | None = None,
    acceleration_column: int | str | None = None,
    g: float = 9.81,
) -> Record:
    """Reads an accelerogram in any format of docs/studies/records.md: PEER, COSMOS, CSMIP, ESM, K-NET, GeoNet, columns (CSV) and others.

    The content determines the format. The options supply the information that the file lacks, and must agree with the
    information that it has.

    Parameters
    ----------
    path : path
        The file.
    unit : {"g", "m/s2", "cm/s2", "gal", "mm/s2", "g/10"}, optional
        Unit of the values.
    dt : float, optional
        Time between two samples [s].
    format : {"peer", "smc", "columns", "cosmos", "csmip", "esm", "knet", "geonet", "nsmn", "unam", "renadic", "bhrc", "usc", \
"jma", "cwb", "csmnc", "esd", "npts", "fixed"}, optional
        Format of the file.
    channel : int or str, optional
        Channel of a file with several, by number from 1 or by name, such as "N-S" or "90 Deg".
    layout : str, optional
        Columns of fixed width in a line, as an edit descriptor of Fortran: "10F8.2", "5E15.7", "8(1PE10.4E1)". It reads any file of
        such lines.
    skip : int, optional
        Lines before the first line of the layout.
    npts : int, optional
        Number of values in the layout, if other lines follow them.
    value_scale : float, optional
        Value of a printed 1 in the unit of the file, for a layout or a table.
    time_column, acceleration_column : int or str, optional
        Columns of a table, by number from 1 or by name.
    g : float
        Gravity that converts values in g [m/s²].

    Raises
    ------
    OSError
        The file cannot be read.
    ValueError
        The file is not an accelerogram, or is incomplete, or lacks information that no option supplies. The message is
        one line with the place in the file, the value found and the one expected.

    Warns
    -----
    UserWarning
        The peak differs from that of the file's header, or is more than in any earthquake; or the frequencies are those of
        velocities.
    """
    acceleration, step, name, start, doubt = _engine.read_record(
        path,
        unit=unit,
        dt=dt,
        format=format,
        channel=channel,
        layout=layout,
        skip=skip,
        npts=npts,
        value_scale=value_scale,
        time_column=time_column,
        acceleration_column=acceleration_column,
        g=g,
    )
    if doubt:
        warnings.warn(f"{path}: {doubt}", stacklevel=2)
    # The engine has checked the peak.
    return _engine.Record.__new__(Record, acceleration, step, name, start)


def records_from(stream: Iterable[Any], *, unit: str | None = None, g: float = 9.81) -> list[Record]:
    """Returns the record of each trace of a stream of ObsPy, as `Record.from_obspy` does.

    Parameters
    ----------
    stream : obspy.Stream
        One trace for each channel.
    unit : {"g", "m/s2", "cm/s2", "gal", "mm/s2"}, optional
        Unit of the samples of all traces; by default that of their responses.
    g : float
        Gravity that converts samples in g [m/s²].

    Raises
    ------
    ValueError
        Several traces of one channel, with the gap or overlap between them, and the errors of `Record.from_obspy`.
    """
    return [Record.from_obspy(trace, unit=unit, g=g) for trace in check_gaps(stream)]


def as_record(name: str, given: object, g: float) -> Record:
    """Returns a record unchanged, or reads it from a file."""
    if isinstance(given, str | os.PathLike):
        return read_record(given, g=g)
    if not isinstance(given, Record):
        raise TypeError(f"{name} has {_shown(given)}; expected a Record or the path of a file")
    return given


def _shown(given: object) -> str:
    text = repr(given)
    return text if len(text) <= 60 else f"{text[:60]}…"
