"""Pulses of ground acceleration."""

from __future__ import annotations

import os
import warnings
from dataclasses import dataclass
from typing import cast, get_args

import numpy as np
import numpy.typing as npt

from rocking_block import _engine
from rocking_block._record import IMPLAUSIBLE, Record, as_record
from rocking_block._words import FittedShape, Floats, Shape, chosen, number


@dataclass(frozen=True)
class Pulse:
    """A pulse of horizontal ground acceleration, zero outside its duration.

    Cycloidal pulses of Palmeri & Makris (2008), Table I: type A is "one-sine", type B "one-cosine", each over one
    period; "c1" and "c2" return the ground to its initial position after one and a half and two and a half periods, minus their
    phase. "half-sine" lasts half a period, "rectangular" one (Housner, 1963). The Ricker wavelets of Vassiliou & Makris
    (2011) last 3 and 4 periods. "gabor" is the wavelet of Mavroeidis & Papageorgiou (2003), with velocity
    A/2 (1 + cos(ω_p τ/γ)) cos(ω_p τ + ν) at τ from its middle, and a_p = ω_p A.

    Parameters
    ----------
    shape : {"one-sine", "one-cosine", "c1", "c2", "half-sine", "rectangular", "symmetric-ricker", \
            "antisymmetric-ricker", "gabor"}
        Shape of the acceleration.
    amplitude : float, optional
        Amplitude a_p of the acceleration [m/s²], its peak or ω_p A of "gabor"; only a search for it can omit it.
    period : float
        Period T_p [s], > 0.
    start : float
        Start time [s].
    phase : float
        Phase ν of "gabor" [rad].
    cycles : float
        Duration γ of "gabor" in periods [1], at least 1.

    Raises
    ------
    ValueError
        An unknown shape, or an invalid number; a phase or cycles for a shape without them.

    Warns
    -----
    UserWarning
        An amplitude above 100 m/s², which no earthquake has.

    Examples
    --------
    >>> import rocking_block as rb
    >>> pulse = rb.Pulse("one-sine", amplitude=2.0, period=1.0)
    >>> pulse.duration
    1.0
    >>> pulse.acceleration([0.25, 2.0])
    array([2., 0.])
    """

    shape: Shape
    amplitude: float | None = None
    period: float = 1.0
    start: float = 0.0
    phase: float = 0.0
    cycles: float = 2.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "shape", chosen("shape", self.shape, get_args(Shape)))
        for name in ("amplitude", "period", "start", "phase", "cycles"):
            if getattr(self, name) is not None:
                object.__setattr__(self, name, number(name, getattr(self, name)))
        _engine.check_pulse(self)
        if self.amplitude is not None and abs(self.amplitude) > IMPLAUSIBLE:
            message = f"amplitude = {self.amplitude:.4g} m/s² is {abs(self.amplitude) / 9.81:.3g} g; expected m/s²"
            warnings.warn(message, stacklevel=3)

    @property
    def duration(self) -> float:
        """Duration [s]."""
        return _engine.pulse_duration(self)

    def acceleration(self, t: npt.ArrayLike) -> Floats:
        """Returns the ground acceleration [m/s²] at times `t` [s] of any array shape."""
        times = np.asarray(t, dtype=np.float64)
        return np.array(_engine.pulse_acceleration(self, times.ravel())).reshape(times.shape)


@dataclass(frozen=True)
class PulseFit:
    """A pulse fitted to a record by `fit_pulse`.

    Attributes
    ----------
    pulse : Pulse
        The pulse, on the time axis of the record.
    r_squared : float
        Share R² of the energy ∫v² dt of the record's velocity that the pulse explains [1].
    """

    pulse: Pulse
    r_squared: float


def fit_pulse(record: Record | str | os.PathLike[str], shape: FittedShape = "gabor") -> PulseFit:
    """Fits a pulse to the velocity of a record, by least squares.

    The pulse has the greatest share R² = 1 − ∫(v − v_p)² dt/∫v² dt of all pulses of its shape within the record: the extended
    wavelet transform of Vassiliou & Makris (2011), applied to the velocity. v is the integral of the acceleration from rest.

    Parameters
    ----------
    record : Record or path
        A record, or its file.
    shape : {"gabor", "one-sine", "one-cosine", "c1", "c2", "symmetric-ricker", "antisymmetric-ricker"}
        Shape of the pulse.

    Raises
    ------
    ValueError
        Another shape, or a record of zeros or too short for a pulse.

    Examples
    --------
    >>> import rocking_block as rb
    >>> import numpy as np
    >>> pulse = rb.Pulse("c1", amplitude=3.0, period=1.2, start=2.0)
    >>> record = rb.Record(pulse.acceleration(np.arange(0, 10, 0.005)), dt=0.005)
    >>> fit = rb.fit_pulse(record, "c1")
    >>> round(fit.pulse.period, 2), fit.r_squared > 0.998
    (1.2, True)
    """
    record = as_record("record", record, 9.81)
    word = cast(Shape, chosen("shape", shape, get_args(FittedShape)))
    found = _engine.fit_pulse(record, word)
    if found is None:
        raise ValueError(f"no {word} pulse fits into the record of {record.duration:g} s; expected a longer motion")
    amplitude, period, start, phase, cycles, r_squared = found
    gabor = {"phase": phase, "cycles": cycles} if word == "gabor" else {}
    return PulseFit(Pulse(word, amplitude, period, start, **gabor), r_squared)


def as_pulse(pulse: object) -> Pulse | None:
    """Returns a pulse unchanged; anything else is an error."""
    if pulse is not None and not isinstance(pulse, Pulse):
        raise TypeError(f'pulse = {pulse!r}; expected a Pulse, as in Pulse("one-sine", amplitude=3.0, period=1.2)')
    return pulse
