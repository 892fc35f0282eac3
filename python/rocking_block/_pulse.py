"""Pulses of ground acceleration."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from rocking_block import _engine
from rocking_block._words import Floats, Shape


@dataclass(frozen=True)
class Pulse:
    """A pulse of horizontal ground acceleration, zero outside its duration.

    Cycloidal pulses of Palmeri & Makris (2008), Table I: type A is "one-sine", type B "one-cosine", each over one period;
    "C1" and "C2" bring the ground back after one and a half and two and a half periods, less their phase.

    Parameters
    ----------
    shape : {"one-sine", "one-cosine", "C1", "C2"}
        Shape of the acceleration.
    amplitude : float, optional
        Amplitude a_p of the acceleration [m/s²]; only a search for it does without.
    period : float
        Period T_p [s], > 0.
    start : float
        Time at which it begins [s].

    Raises
    ------
    ValueError
        An unknown shape, or a number that makes no pulse.

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

    def __post_init__(self) -> None:
        _engine.check_pulse(self)

    @property
    def duration(self) -> float:
        """Time from its beginning to its end [s]."""
        return _engine.pulse_duration(self)

    def acceleration(self, t: npt.ArrayLike) -> Floats:
        """Ground acceleration at times `t` [s], of any shape [m/s²]."""
        times = np.asarray(t, dtype=np.float64)
        return np.array(_engine.pulse_acceleration(self, times.ravel())).reshape(times.shape)
