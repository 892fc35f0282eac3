"""The compiled part of the package."""

from collections.abc import Callable, Sequence
from os import PathLike
from typing import Any, final

import numpy as np
import numpy.typing as npt
from typing_extensions import Self, disjoint_base

from rocking_block._tie import Tie

__version__: str

_Floats = npt.NDArray[np.float64]
_Tick = Callable[[int, int], object]
_Pair = tuple[Record | None, Record | None]
_Answer = tuple[float | None, str, list[tuple[float, float, str]], float]

@disjoint_base
class Block:
    def __new__(
        cls,
        *,
        alpha: float | None = None,
        p: float | None = None,
        eta: float | None = None,
        xi_v: float | None = None,
        width: float | None = None,
        height: float | None = None,
        K: float | None = None,
        C: float | None = None,
        mass: float | None = None,
        gamma: float = 3.0,
        epsilon: float = 0.0,
        g: float = 9.81,
        foundation: str = "viscoelastic",
        restitution_factor: float | None = None,
        center_height: float | None = None,
        inertia: float | None = None,
        eccentricity: float = 0.0,
        friction: float = 0.0,
        ties: Sequence[Tie] | Tie | None = ...,
    ) -> Self: ...
    def parameters(self) -> dict[str, Any]: ...
    @property
    def foundation(self) -> str: ...
    @property
    def alpha(self) -> float: ...
    @property
    def p(self) -> float: ...
    @property
    def eta(self) -> float: ...
    @property
    def xi_v(self) -> float: ...
    @property
    def omega_v(self) -> float: ...
    @property
    def K(self) -> float: ...
    @property
    def C(self) -> float: ...
    @property
    def delta_s(self) -> float: ...
    @property
    def theta_separation(self) -> float: ...
    @property
    def width(self) -> float: ...
    @property
    def height(self) -> float: ...
    @property
    def R0(self) -> float: ...
    @property
    def I0(self) -> float: ...
    @property
    def mass(self) -> float: ...
    @property
    def gamma(self) -> float: ...
    @property
    def epsilon(self) -> float: ...
    @property
    def g(self) -> float: ...
    @property
    def e(self) -> float: ...
    @property
    def e_max(self) -> float: ...
    @property
    def restitution_factor(self) -> float: ...
    @property
    def eccentricity(self) -> float: ...
    @property
    def alpha_L(self) -> float: ...
    @property
    def alpha_R(self) -> float: ...
    @property
    def friction(self) -> float: ...
    @property
    def ties(self) -> tuple[Tie, ...]: ...

@final
class Blocks:
    def __new__(
        cls,
        foundation: str,
        alpha: _Floats,
        p: _Floats,
        eta: _Floats,
        xi_v: _Floats,
        epsilon: _Floats,
        restitution_factor: _Floats,
        mass: float,
        gamma: float,
        g: float,
        friction: float,
    ) -> Self: ...
    @staticmethod
    def of(blocks: Sequence[Block]) -> Blocks: ...
    def __len__(self) -> int: ...
    def column(self, name: str) -> _Floats: ...
    def foundations(self) -> list[str]: ...

@disjoint_base
class Building:
    def __new__(
        cls,
        *,
        floor_masses: Sequence[float] | None = None,
        storey_stiffnesses: Sequence[float] | None = None,
        frequencies: Sequence[float] | None = None,
        participation: Sequence[float] | None = None,
        shapes: Sequence[Sequence[float]] | None = None,
        damping: float | Sequence[float] | None = None,
        rayleigh: tuple[float, tuple[int, int]] | None = None,
    ) -> Self: ...
    @property
    def floors(self) -> int: ...
    @property
    def frequencies(self) -> _Floats: ...
    @property
    def damping(self) -> _Floats: ...
    @property
    def participation(self) -> _Floats: ...
    @property
    def shapes(self) -> list[list[float]]: ...
    def motions(self, record: Record) -> list[tuple[int, _Floats, float, float]]: ...

@disjoint_base
class Record:
    def __new__(cls, acceleration: _Floats, dt: float, name: str = "", start: float = 0.0) -> Self: ...
    def __len__(self) -> int: ...
    @property
    def acceleration(self) -> _Floats: ...
    @property
    def dt(self) -> float: ...
    @property
    def name(self) -> str: ...
    @property
    def start(self) -> float: ...
    @property
    def duration(self) -> float: ...
    @property
    def pga(self) -> float: ...
    @property
    def pgv(self) -> float: ...
    def _processed(
        self, baseline: bool, band_pass: tuple[float, float] | None, resample: float | None
    ) -> tuple[_Floats, float, str]: ...

@disjoint_base
class Fragility:
    def __new__(
        cls,
        measures: _Floats,
        fractions: _Floats,
        peaks: _Floats,
        motions: npt.NDArray[np.int64],
        link: str,
        ci: float,
        samples: int | None,
        seed: int,
        tick: _Tick,
    ) -> Self: ...
    @property
    def median(self) -> float: ...
    @property
    def beta(self) -> float: ...
    @property
    def median_ci(self) -> tuple[float, float]: ...
    @property
    def beta_ci(self) -> tuple[float, float]: ...
    @property
    def log_likelihood(self) -> float: ...
    @property
    def coefficients(self) -> tuple[float, float]: ...
    @property
    def standard_errors(self) -> tuple[float, float]: ...
    @property
    def efficiency(self) -> float: ...
    @property
    def rocking(self) -> int: ...
    @property
    def independence(self) -> str: ...
    @property
    def auc(self) -> float: ...
    @property
    def brier(self) -> float: ...
    def warnings(self, heading: str) -> list[str]: ...
    def probabilities(self, measures: _Floats) -> _Floats: ...
    def intervals(self, measures: _Floats) -> list[_Floats]: ...

def export_fragility(
    program: str, components: Sequence[tuple[str, str, float, Sequence[tuple[str, Fragility]], str]], g: float
) -> tuple[list[str], list[str]]: ...

_Hazard = tuple[_Floats, _Floats, str | None, str | None, list[str]]

@disjoint_base
class AnnualRate:
    def __new__(
        cls,
        levels: _Floats,
        rates: _Floats,
        fit: Fragility | None,
        lognormal: tuple[float, float] | None,
        table: tuple[_Floats, _Floats] | None,
    ) -> Self: ...
    @property
    def rate(self) -> float: ...
    @property
    def rate_ci(self) -> tuple[float, float] | None: ...
    @property
    def below_hazard(self) -> float: ...
    @property
    def above_hazard(self) -> float: ...
    def between(self, low: float, high: float) -> float: ...
    def quantile(self, share: float) -> float: ...
    def parts(self) -> list[_Floats]: ...
    def probability(self, years: float) -> float: ...

def read_hazard(
    path: str | PathLike[str],
    *,
    im: str | None,
    unit: str | None,
    site: str | None,
    investigation_time: float | None,
    g: float,
) -> _Hazard: ...
def check_hazard(levels: _Floats, rates: _Floats, unit: str | None, g: float) -> _Hazard: ...
def measure_scale(im: str, alpha: float | None, p: float | None, g: float) -> tuple[str, float]: ...
def intensity(record: Record, periods: Sequence[float], g: float) -> list[tuple[str, float]]: ...
def read_record(
    path: str | PathLike[str],
    *,
    unit: str | None,
    dt: float | None,
    format: str | None,
    channel: int | None,
    time_column: int | str | None,
    acceleration_column: int | str | None,
    g: float,
) -> tuple[_Floats, float, str, float]: ...
def rotate(record: Record, transverse: Record, angle: float) -> tuple[_Floats, str]: ...
def rot_d(
    record: Record, transverse: Record, percentile: float, periods: Sequence[float], g: float
) -> list[tuple[str, float]]: ...
def unit_factor(unit: str, g: float) -> float: ...
def fit_pulse(record: Record, shape: str) -> list[float] | None: ...
def check_pulse(pulse: object) -> None: ...
def pulse_acceleration(pulse: object, times: _Floats) -> list[float]: ...
def pulse_duration(pulse: object) -> float: ...
def history(
    block: Block,
    horizontal: Record | None,
    vertical: Record | None,
    scale: float,
    pulse: object | None,
    beginning: dict[str, float | None],
    options: dict[str, Any],
    gradients: Sequence[str],
    tick: _Tick,
) -> dict[str, Any]: ...
def frame_block(
    columns: int, column: Block, beam_mass: float
) -> tuple[float, float, float, float, float, float]: ...
def frame_response(columns: int, column: Block, beam_mass: float, motion: list[_Floats]) -> dict[str, _Floats]: ...
def outcomes(
    blocks: Blocks,
    pairs: Sequence[_Pair],
    scales: Sequence[float],
    periods: Sequence[float],
    g: float,
    pulse: object | None,
    friction_demand: float | None,
    options: dict[str, Any],
    threads: int | None,
    tick: _Tick,
) -> tuple[dict[str, Any], list[tuple[str, str]], str | None]: ...
def sweep(
    name: str | None,
    text: str,
    folder: str | PathLike[str],
    on_separation: str | None,
    threads: int | None,
    tick: _Tick,
) -> tuple[list[str], list[Any], str | None]: ...
def search_overturning(
    block: Block,
    pulse: object | None,
    horizontal: Record | None,
    vertical: Record | None,
    scan: dict[str, Any],
    options: dict[str, Any],
    tick: _Tick,
) -> _Answer: ...
def search_damping(
    block: Block, rate: float, scan: dict[str, Any], options: dict[str, Any], tick: _Tick
) -> _Answer: ...
def assess(
    name: str, study: str, folder: str | PathLike[str], threads: int | None, tick: _Tick
) -> tuple[str, str, list[tuple[str, bytes]]]: ...
def fit(
    block: Block,
    tests: list[dict[str, Any]],
    shared: list[tuple[str, Any, Any]],
    options: dict[str, Any],
    threads: int | None,
    tick: _Tick,
) -> tuple[str, list[tuple[_Floats, _Floats, _Floats]]]: ...
def foundation_pairs() -> list[dict[str, Any]]: ...
def pad_support(
    diameter: float, shape_factor: float, shear_modulus: float, bulk_modulus: float | None
) -> tuple[float, float, float]: ...
def soil_support(
    width: float, length: float, shear_wave_velocity: float, density: float, poisson: float
) -> tuple[float, float, float]: ...
