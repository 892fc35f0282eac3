"""Parameters of a block from measured tests."""

from __future__ import annotations

import dataclasses
import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from rocking_block import _engine
from rocking_block._block import Block
from rocking_block._html import html_table
from rocking_block._pulse import Pulse, as_pulse
from rocking_block._record import Record, as_record
from rocking_block._tie import Damper, Tie, links
from rocking_block._words import Floats, number, optional, ticking

if TYPE_CHECKING:
    import pandas

_Pairs = Mapping[str, Sequence[float]]


@dataclass(frozen=True, eq=False)
class Test:
    """A test of a block: one quantity over time, in a free motion or under a ground motion.

    Parameters
    ----------
    t, values : array_like, shape (n,)
        Times [s], increasing, and measured values in SI units, angles in radians.
    output : str
        The measured quantity, by its name in the columns of a run: "theta", "theta_dot", "u_ddot", "N_L", ...
    noise : float, optional
        Standard deviation of the errors, in the unit of the values. For all tests of a fit or for none: without it the
        residuals determine it.
    record, vertical, scale, pulse, theta, theta_dot, v, v_dot
        Ground motion and initial state, as in `Block.run`.
    zero : float
        Measured value where the quantity is zero: the offset of the sensor.
    delay : float
        Measured time at time 0 of the run [s]. Before it the block is held in its initial state.
    free : sequence of str
        Free parameters of this test alone: "zero", "delay", "initial.theta", "initial.theta_dot", "scale",
        "pulse.amplitude" and so on.
    bounds, prior : mapping
        As in `fit`, for them.
    """

    t: npt.ArrayLike
    values: npt.ArrayLike
    output: str = "theta"
    noise: float | None = None
    record: Record | str | os.PathLike[str] | None = None
    vertical: Record | str | os.PathLike[str] | None = None
    scale: float = 1.0
    pulse: Pulse | None = None
    theta: float = 0.0
    theta_dot: float = 0.0
    v: float | None = None
    v_dot: float | None = None
    zero: float = 0.0
    delay: float = 0.0
    free: Sequence[str] = ()
    bounds: _Pairs = field(default_factory=dict)
    prior: _Pairs = field(default_factory=dict)

    # No class of tests for pytest.
    __test__ = False

    def of_engine(self, g: float) -> dict[str, Any]:
        """Returns the test in the engine's form."""
        columns = {name: np.array(getattr(self, name), dtype=np.float64) for name in ("t", "values")}
        for name, column in columns.items():
            if column.ndim != 1:
                raise ValueError(f"{name} has shape {column.shape}; expected one dimension, of measured values")
        beginning = {name: getattr(self, name) for name in ("theta", "theta_dot", "v", "v_dot")}
        return columns | {
            "output": str(self.output),
            "noise": None if self.noise is None else number("noise", self.noise),
            "record": None if self.record is None else as_record("record", self.record, g),
            "vertical": None if self.vertical is None else as_record("vertical", self.vertical, g),
            "scale": number("scale", self.scale),
            "pulse": as_pulse(self.pulse),
            "beginning": {name: None if value is None else number(name, value) for name, value in beginning.items()},
            "zero": number("zero", self.zero),
            "delay": number("delay", self.delay),
            "free": _free(self.free, self.bounds, self.prior),
        }


@dataclass(frozen=True)
class Estimate:
    """An estimated parameter."""

    name: str
    """Its name; "test_2.zero" for a test's own parameter."""
    unit: str
    """Its unit; "1" for none."""
    value: float
    """The estimate."""
    standard_error: float
    """Its standard error, to first order."""
    interval: tuple[float | None, float | None] | None
    """Interval of the profile likelihood; None for an end where the data admit the bound, for a test's own parameter,
    and where the search for intervals kept finding better fits."""
    quadratic_interval: tuple[float, float]
    """Interval of the quadratic approximation, symmetric in the logarithm of a positive parameter."""
    bounds: tuple[float, float]
    """Its bounds."""
    at_bound: float | None
    """The bound at which the estimate lies, if it does."""


@dataclass(frozen=True, eq=False)
class TestFit:
    """A test and its fit; arrays have shape (n,)."""

    output: str
    """The measured quantity."""
    unit: str
    """Its unit."""
    t: Floats
    """Times [s]."""
    measured: Floats
    """Measured values."""
    fitted: Floats
    """Fitted values, with the zero and the delay of the test."""
    residuals: Floats
    """Measured less fitted values."""
    rms: float
    """Root mean square of the residuals."""
    durbin_watson: float
    """Durbin's and Watson's statistic of the residuals [1]: 2 for white noise, less for correlated ones."""
    autocorrelation: float
    """Correlation of each residual with the next [1]."""
    grazing: float | None
    """Time from which on the fitted run has no derivatives, because an event grazes [s]."""
    overturned: float | None
    """Time at which the fitted block has overturned [s]."""

    __test__ = False


@dataclass(frozen=True)
class Combination:
    """A direction of the parameters: a right singular vector of the Jacobian over the noise.

    Coordinates are the logarithms of positive parameters; others are divided by half of their range.
    """

    standard_deviation: float
    """Standard deviation along the direction, by the data alone: the reciprocal of the singular value."""
    weights: tuple[float, ...]
    """Components of the unit vector, in the order of the estimates."""
    is_determined: bool
    """Whether the data determine it."""
    meaning: str
    """Its determination by the data, in words."""


@dataclass(frozen=True, eq=False, repr=False)
class Fit:
    """Parameters of a block, estimated from tests; made by `fit`. `fit["alpha"]` gives an estimate by its name."""

    block: Block
    """The block with the estimates."""
    estimates: tuple[Estimate, ...]
    """The estimates: of the block, then of each test."""
    covariance: Floats
    """Covariance of the estimates, to first order, shape (k, k)."""
    combinations: tuple[Combination, ...]
    """Combinations of the parameters, the best determined first."""
    tests: tuple[TestFit, ...]
    """The tests with their fits."""
    reduced_chi_squared: float | None
    """Weighted sum of squares over its degrees of freedom [1], if the noise is given: about 1 if model and noise are right."""
    noise: float | None
    """Standard deviation of the errors by the residuals, if the noise is not given."""
    level: float
    """Confidence level of the intervals."""
    other_minima: tuple[tuple[float, ...], ...]
    """Values of the parameters at other minima that the level admits; the intervals cover them."""
    is_converged: bool
    """Whether the search has ended at a minimum."""
    notes: tuple[str, ...]
    """Weaknesses of the fit, in sentences; read them before the estimates."""
    runs: tuple[int, int]
    """Numbers of runs without and with derivatives."""

    def __getitem__(self, name: str) -> Estimate:
        for estimate in self.estimates:
            if estimate.name == name:
                return estimate
        raise KeyError(f"{name}; expected one of {', '.join(estimate.name for estimate in self.estimates)}")

    def to_frame(self) -> pandas.DataFrame:
        """Returns the estimates as a pandas DataFrame, a row each."""
        with optional("to_frame", "pandas"):
            import pandas

        rows = [
            {"unit": estimate.unit, "value": estimate.value, "standard_error": estimate.standard_error}
            | dict(zip(("low", "high"), estimate.interval or (None, None), strict=True))
            | dict(zip(("quadratic_low", "quadratic_high"), estimate.quadratic_interval, strict=True))
            for estimate in self.estimates
        ]
        return pandas.DataFrame(rows, index=pandas.Index([estimate.name for estimate in self.estimates], name="parameter"))

    def plot(self, axes: Any = None) -> npt.NDArray[Any]:
        """Draws measured and fitted values of each test over time, and the residuals under them, with Matplotlib.

        Parameters
        ----------
        axes : sequence of Axes, optional
            Two axes for each test; by default those of a new figure.

        Returns
        -------
        array of Axes
            The axes drawn on.
        """
        from rocking_block import _plot

        return _plot.fit(self.tests, axes)

    def __repr__(self) -> str:
        shown = ", ".join(f"{x.name} = {x.value:.5g} ± {x.standard_error:.2g}" for x in self.estimates)
        return f"<Fit of {len(self.tests)} tests: {shown}; {len(self.notes)} notes>"

    def _repr_html_(self) -> str:
        rows = [(x.name, f"{x.value:.5g} ± {x.standard_error:.2g} {x.unit.replace('1', '')}") for x in self.estimates]
        return html_table(f"fit of {len(self.tests)} tests", (), rows + [("note", note) for note in self.notes])


def fit(
    block: Block,
    tests: Test | Sequence[Test],
    free: Sequence[str],
    *,
    bounds: _Pairs | None = None,
    prior: _Pairs | None = None,
    starts: int = 16,
    seed: int = 1,
    level: float = 0.95,
    tolerance: float = 1e-8,
    threads: int | None = None,
    progress: bool | None = None,
) -> Fit:
    """Fits parameters of a block to measured tests, by least squares with exact derivatives through all impacts.

    Several tests share the parameters of the block; each may have free parameters of its own. The search begins at the
    block's values and at points of a Latin hypercube within the bounds. The numbers are those of `rocking fit`.

    Parameters
    ----------
    block : Block
        The block, with first values of its free parameters.
    tests : Test or sequence of Test
        The tests.
    free : sequence of str
        Free parameters of the block, by the names of `Block.run(gradients=...)`: "alpha", "p", "restitution_factor", ...
    bounds : mapping of str to (float, float), optional
        Bounds of free parameters; by default a range about their values (docs/studies/fit.md).
    prior : mapping of str to (float, float), optional
        Mean and standard deviation from other knowledge; needs the noise of each test.
    starts : int
        Number of starts.
    seed : int
        Seed of the Latin hypercube.
    level : float
        Confidence level of the intervals.
    tolerance : float
        Relative tolerance of the integration, 1e-14 to 1e-1.
    threads : int, optional
        Number of threads; by default one per core. It changes no bit.
    progress : bool, optional
        Whether to show a tqdm progress bar.

    Raises
    ------
    ValueError
        An unknown parameter or quantity, a test or an option that is not valid.

    Examples
    --------
    A block is released with a tilt of 0.15 rad; here a run takes the index of the test:

    >>> import rocking_block as rb
    >>> truth = rb.Block(alpha=0.2, p=2.5, foundation="rigid", restitution_factor=0.95)
    >>> test = truth.run(theta=0.15, duration=4.0, step=0.02)
    >>> guess = truth.replace(p=2.2, restitution_factor=1.0)
    >>> fit = rb.fit(guess, rb.Test(test.t, test.theta, theta=0.15, noise=1e-3), free=["p", "restitution_factor"])
    >>> round(fit["p"].value, 6), round(fit["restitution_factor"].value, 6)
    (2.5, 0.95)
    """
    listed = [tests] if isinstance(tests, Test) else list(tests)
    for test in listed:
        if not isinstance(test, Test):
            raise TypeError(f"tests has a {type(test).__name__}; expected a Test, as in Test(t, theta, theta=0.1)")
    options = {"starts": starts, "seed": seed, "level": number("level", level), "tolerance": number("tolerance", tolerance)}
    shared = _free(free, bounds or {}, prior or {})
    with ticking(progress) as tick:
        text, columns = _engine.fit(block, [test.of_engine(block.g) for test in listed], shared, options, threads, tick)
    found = json.loads(text)
    estimates = tuple(Estimate(**_tuples(fields)) for fields in found["estimates"])
    changes = {estimate.name: estimate.value for estimate in estimates[: len(shared)]}
    fits = tuple(
        TestFit(t=np.array(test.t, dtype=np.float64), measured=measured, fitted=fitted, residuals=residuals, **fields)
        for test, (measured, fitted, residuals), fields in zip(listed, columns, found["tests"], strict=True)
    )
    return Fit(
        block=_changed(block, changes),
        estimates=estimates,
        covariance=np.array(found["covariance"]),
        combinations=tuple(Combination(**_tuples(fields)) for fields in found["combinations"]),
        tests=fits,
        **{name: found[name] for name in ("reduced_chi_squared", "noise", "level", "is_converged")},
        other_minima=tuple(map(tuple, found["other_minima"])),
        notes=tuple(found["notes"]),
        runs=(found["runs"][0], found["runs"][1]),
    )


def _free(free: Sequence[str], bounds: _Pairs, prior: _Pairs) -> list[tuple[str, Any, Any]]:
    """Returns names, bounds and priors of free parameters in the engine's form."""
    names = [free] if isinstance(free, str) else [str(name) for name in free]
    for option, pairs in (("bounds", bounds), ("prior", prior)):
        for name, pair in pairs.items():
            if name not in names:
                raise ValueError(f"{option} of {name}, which is not free; expected one of {', '.join(names)}")
            if np.shape(pair) != (2,):
                raise ValueError(f"{option} of {name} = {pair!r}; expected two numbers")

    def pair_of(pairs: _Pairs, name: str) -> list[float] | None:
        return [number(name, value) for value in pairs[name]] if name in pairs else None

    return [(name, pair_of(bounds, name), pair_of(prior, name)) for name in names]


def _changed(block: Block, values: Mapping[str, float]) -> Block:
    """Returns the block with these values, by the names of the FMU."""
    changed = links(block)
    changes: dict[str, Any] = {}
    for name, value in values.items():
        link, _, parameter = name.partition(".")
        if parameter:
            found: Any = changed[link]
            changed[link] = dataclasses.replace(found, **{parameter: value})
            changes["ties"] = [tie for tie in changed.values() if isinstance(tie, Tie)]
            changes["dampers"] = [damper for damper in changed.values() if isinstance(damper, Damper)]
        else:
            changes[name] = value
    return block.replace(**changes)


def _tuples(fields: dict[str, Any]) -> dict[str, Any]:
    """Returns a dictionary with tuples in index of lists."""
    return {name: tuple(value) if isinstance(value, list) else value for name, value in fields.items()}
