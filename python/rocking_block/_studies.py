"""Many runs: spectra, lists of blocks, and studies from files."""

import os
import warnings
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, get_args

import numpy as np
import numpy.typing as npt

from rocking_block import _engine, _toml
from rocking_block._block import Block
from rocking_block._pulse import Pulse, as_pulse
from rocking_block._record import Record, as_record
from rocking_block._table import Table, of_program
from rocking_block._words import Floats, Foundation, OnOverturning, OnSeparation, chosen, run_options, ticking

# One record or several, as objects or as files.
Records = Record | str | os.PathLike[str] | Iterable[Record | str | os.PathLike[str]]

_UNITS = {
    "scale": "1",
    "PGA.vertical": "m/s2",
    "alpha": "rad",
    "p": "rad/s",
    "eta": "1",
    "xi_v": "1",
    "epsilon": "1",
    "restitution_factor": "1",
    "2pi/p": "s",
    "omega_p/p": "1",
    "end_time": "s",
    "peak.theta/alpha": "1",
    "peak.uplift": "m",
    "peak.N": "N",
    "peak.H": "N",
    "peak.friction_demand": "1",
    "peak.slip": "m",
    **{f"peak.tie_{number}.tension": "N" for number in range(1, 9)},
    "first_separation": "s",
    "flights": "1",
    "events.impacts": "1",
    "events.liftoffs": "1",
}


def spectrum(
    *,
    p: npt.ArrayLike,
    alpha: npt.ArrayLike = 0.25,
    eta: npt.ArrayLike | None = None,
    xi_v: npt.ArrayLike | None = None,
    epsilon: npt.ArrayLike = 0.0,
    restitution_factor: npt.ArrayLike | None = None,
    foundation: Foundation = "viscoelastic",
    mass: float = 1000.0,
    gamma: float = 3.0,
    g: float = 9.81,
    friction: float = 0.0,
    records: Records | None = None,
    vertical: Records | None = None,
    scale: npt.ArrayLike = 1.0,
    periods: npt.ArrayLike = (),
    pulse: Pulse | None = None,
    tolerance: float = 1e-6,
    on_separation: OnSeparation = "fly",
    on_overturning: OnOverturning = "terminate",
    duration: float | None = None,
    step: float | None = None,
    friction_demand: float | None = None,
    threads: int | None = None,
    progress: bool | None = None,
) -> Table:
    """Computes the outcomes and peaks of blocks of all sizes on any number of foundations, on all cores.

    Results equal those of `rocking spectrum` to the last bit. `alpha`, `eta`, `xi_v`, `epsilon` and
    `restitution_factor` broadcast as in NumPy: each element is a curve, and each curve has all sizes `p`. `eta=[40,
    80]` gives two curves, as does `eta=[40, 80], xi_v=[0.1, 0.4]`; `eta=[[40], [80]], xi_v=[0.1, 0.4]` gives four.
    `outcomes` takes individual blocks.

    Parameters
    ----------
    p : array_like
        Frequency parameters that define the sizes [rad/s].
    alpha, eta, xi_v, epsilon, restitution_factor : array_like
        As in `Block`.
    foundation, mass, gamma, g, friction
        As in `Block`.
    records, vertical : Record, path, or sequence of them
        Horizontal and vertical records, of equal number if both are given. Files are read with `read_record`.
    scale : array_like, up to one dimension
        Factors on the records [1].
    periods : array_like
        Periods [s] at which Sa and Sv join the records' intensity measures in the table; see `intensity`.
    pulse : Pulse, optional
        A pulse, alone or added to each record.
    tolerance : float
        As in `Block.run`; looser by default, which is enough for outcomes and peaks.
    on_overturning
        As in `Block.run`.
    on_separation : {"fly", "terminate", "hold"}
        Blocks that leave the ground fly by default.
    duration : float, optional
        Duration of each run [s]; by default until the ground has come to rest and the block has come down.
    step : float, optional
        Longest time between two stops of a run [s]; by default a run stops only at the records' samples and the pulse's
        ends.
    friction_demand : float, optional
        Coefficient of friction [1]: adds the column `friction_demand>0.5` (for 0.5), the longest uninterrupted time [s]
        for which |H|/(N_L + N_R) exceeds it, checked every millisecond. It shows whether a block would slide, unlike
        `peak.friction_demand`, which is unbounded when the reactions vanish for an instant. To find how far it slides, run it with
        `friction`.
    threads : int, optional
        Number of threads; by default one per core. It changes no bit.
    progress : bool, optional
        Whether to show a tqdm progress bar; by default after a second, if the output is interactive.

    Returns
    -------
    Table
        One row per record × scale × curve × size, in this order; `shape` has an axis for each array argument. Unnamed
        records are numbered from 0.

    Raises
    ------
    ValueError
        An invalid parameter or option, or no ground motion.
    OSError
        A file cannot be read.

    Warns
    -----
    RuntimeWarning
        Some runs failed: their outcome is "failed".

    Examples
    --------
    >>> import rocking_block as rb
    >>> pulse = rb.Pulse("one-sine", amplitude=6.2622, period=1.2566)
    >>> table = rb.spectrum(alpha=0.25, p=[1.0, 1.5, 2.0, 3.0], eta=[40, 80], pulse=pulse)
    >>> table.shape
    (2, 4)
    >>> table["outcome"].reshape(table.shape)[0].tolist()
    ['completed', 'overturned', 'overturned', 'overturned']
    """
    rigid = chosen("foundation", foundation, get_args(Foundation)) == "rigid"
    _refuse(rigid, {"eta": eta, "xi_v": xi_v}, "on a rigid base")
    factor = {"restitution_factor": restitution_factor}
    _refuse(not rigid, factor, 'on viscoelastic supports; expected foundation="rigid"')
    curves = _broadcast(
        alpha=alpha,
        eta=40.0 if eta is None else eta,
        xi_v=0.1 if xi_v is None else xi_v,
        epsilon=epsilon,
        restitution_factor=1.0 if restitution_factor is None else restitution_factor,
    )
    sizes = _broadcast(p=p)["p"]
    each = {name: np.repeat(values.ravel(), sizes.size) for name, values in curves.items()}
    shape = curves["alpha"].shape
    count = curves["alpha"].size
    many = _engine.Blocks(
        foundation,
        each["alpha"],
        np.tile(sizes.ravel(), count),
        each["eta"],
        each["xi_v"],
        each["epsilon"],
        each["restitution_factor"],
        mass,
        gamma,
        g,
        friction,
    )
    options = run_options(tolerance, on_separation, on_overturning, duration, step)
    shape = (*shape, *sizes.shape)
    return _outcomes(many, shape, records, vertical, scale, periods, pulse, g, friction_demand, options, threads, progress)


def blocks(**parameters: npt.ArrayLike) -> list[Block]:
    """Returns blocks from parameters that broadcast as in NumPy, in the order of the elements.

    Parameters
    ----------
    **parameters : array_like
        Those of `Block`; `foundation` may be an array of words. All blocks have the same `ties`.

    Examples
    --------
    >>> import rocking_block as rb
    >>> [block.p for block in rb.blocks(alpha=[0.1, 0.2], p=[1.0, 2.0], eta=60)]
    [1.0, 2.0]
    """
    ties: dict[str, Any] = {name: parameters.pop(name) for name in ("ties",) if name in parameters}
    names = list(parameters)
    arrays = _same_shape({name: np.asarray(value) for name, value in parameters.items()})
    rows = zip(*(array.ravel().tolist() for array in arrays.values()), strict=True)
    return [Block(**dict(zip(names, row, strict=True)), **ties) for row in rows]


def outcomes(
    blocks: Block | Sequence[Block],
    records: Records | None = None,
    *,
    vertical: Records | None = None,
    scale: npt.ArrayLike = 1.0,
    periods: npt.ArrayLike = (),
    pulse: Pulse | None = None,
    tolerance: float = 1e-6,
    on_separation: OnSeparation = "fly",
    on_overturning: OnOverturning = "terminate",
    duration: float | None = None,
    step: float | None = None,
    friction_demand: float | None = None,
    threads: int | None = None,
    progress: bool | None = None,
) -> Table:
    """Computes the outcome and peaks of each block under each record, on all cores.

    Parameters
    ----------
    blocks : Block or sequence of Block
        The blocks.
    records, vertical, scale, periods, pulse, tolerance, on_separation, on_overturning, duration, step,
    friction_demand, threads, progress
        As in `spectrum`; files in g are converted with 9.81 m/s².

    Returns
    -------
    Table
        One row per record × scale × block, in this order.

    Raises
    ------
    ValueError, OSError
        As `spectrum`.

    Examples
    --------
    >>> import rocking_block as rb
    >>> pulse = rb.Pulse("one-sine", amplitude=6.2622, period=1.2566)
    >>> rb.outcomes(rb.blocks(p=[1.0, 1.5, 3.0]), pulse=pulse)["outcome"].tolist()
    ['completed', 'overturned', 'overturned']
    """
    single = isinstance(blocks, _engine.Block)
    listed = [blocks] if isinstance(blocks, _engine.Block) else list(blocks)
    if not listed:
        raise ValueError("blocks = []; expected at least one")
    for block in listed:
        if not isinstance(block, _engine.Block):
            raise TypeError(f"blocks has {block!r}; expected Blocks")
    many = _engine.Blocks.of(listed)
    shape = () if single else (len(many),)
    options = run_options(tolerance, on_separation, on_overturning, duration, step)
    return _outcomes(many, shape, records, vertical, scale, periods, pulse, 9.81, friction_demand, options, threads, progress)


def sweep(
    study: str | os.PathLike[str] | Mapping[str, Any],
    *,
    on_separation: OnSeparation | None = None,
    threads: int | None = None,
    progress: bool | None = None,
) -> Table:
    """Runs a study over any parameters of the FMU, records and scale factors, on grids or Latin hypercubes.

    The table equals that of `rocking sweep` to the last bit.

    Parameters
    ----------
    study : path or mapping
        A study file (TOML), or its content as a dictionary. Paths in it are relative to the file's folder, or to the
        working directory.
    on_separation : {"fly", "terminate"}, optional
        Action at complete separation if the study does not name it; by default the block flies.
    threads, progress
        As in `spectrum`.

    Returns
    -------
    Table
        One row per combination × record × scale. Parameters have their names in the FMU without the group: `alpha` for
        `dimensionless.alpha`.

    Raises
    ------
    OSError
        The study cannot be read.
    ValueError
        The study has a mistake; the message has its line, the value found and the one expected.

    Warns
    -----
    RuntimeWarning
        Some runs failed: their outcome is "failed".

    Examples
    --------
    >>> import rocking_block as rb
    >>> table = rb.sweep({
    ...     "study": {"design": "grid"},
    ...     "parameters": {
    ...         "p": {"from": 1.0, "to": 3.0, "count": 3},
    ...         "pulse": {"shape": "one-sine", "amplitude": 6.2622, "period": 1.2566},
    ...     },
    ... })
    >>> table["p"]
    array([1., 2., 3.])
    """
    if isinstance(study, Mapping):
        name, text, folder = None, _toml.text(study), Path()
    else:
        path = Path(study)
        name, text, folder = str(path), path.read_text(encoding="utf-8"), path.parent
    with ticking(progress) as tick:
        headings, columns, failure = _engine.sweep(name, text, folder, on_separation, threads, tick)
    table = of_program(headings, columns)
    _warn(table["outcome"], failure)
    return table


def _refuse(unread: bool, arguments: Mapping[str, object], why: str) -> None:
    """Raises the engine's error for arguments without effect."""
    for name, value in arguments.items():
        if unread and value is not None:
            raise ValueError(f"{name} has no effect {why}")


def _broadcast(**values: npt.ArrayLike) -> dict[str, Floats]:
    arrays = {name: np.asarray(value, dtype=np.float64) for name, value in values.items()}
    for name, array in arrays.items():
        if array.size == 0:
            raise ValueError(f"{name} = []; expected at least one")
    return _same_shape(arrays)


def _same_shape(arrays: dict[str, npt.NDArray[Any]]) -> dict[str, npt.NDArray[Any]]:
    try:
        shape = np.broadcast_shapes(*(array.shape for array in arrays.values()))
    except ValueError:
        shapes = ", ".join(f"{name} {array.shape}" for name, array in arrays.items() if array.shape)
        raise ValueError(f"shapes do not broadcast: {shapes}") from None
    return {name: np.broadcast_to(array, shape) for name, array in arrays.items()}


def _outcomes(
    many: _engine.Blocks,
    shape: tuple[int, ...],
    records: Records | None,
    vertical: Records | None,
    scale: npt.ArrayLike,
    periods: npt.ArrayLike,
    pulse: Pulse | None,
    g: float,
    friction_demand: float | None,
    options: dict[str, Any],
    threads: int | None,
    progress: bool | None,
) -> Table:
    horizontal, vertical_records = _read("records", records, g), _read("vertical", vertical, g)
    pulse = as_pulse(pulse)
    if not horizontal and not vertical_records and pulse is None:
        raise ValueError("nothing moves the ground; expected records or a pulse")
    if horizontal and vertical_records and len(horizontal) != len(vertical_records):
        raise ValueError(f"found {len(vertical_records)} vertical and {len(horizontal)} horizontal records; expected equal numbers")
    number = max(len(horizontal), len(vertical_records), 1)
    nothing: list[Record | None] = [None] * number
    pairs = list(zip(horizontal or nothing, vertical_records or nothing, strict=True))
    scales = np.asarray(scale, dtype=np.float64)
    if scales.ndim > 1:
        raise ValueError(f"scale has shape {scales.shape}; expected a factor or a list of factors")
    if scales.size == 0:
        raise ValueError("scale = []; expected at least one factor")
    if not horizontal and not vertical_records and not np.array_equal(scales, 1.0):
        raise ValueError("scale has no effect without records")
    spectral_periods = np.atleast_1d(np.asarray(periods, dtype=np.float64)).tolist()
    if not horizontal and spectral_periods:
        raise ValueError("periods has no effect without horizontal records")
    factors = scales.ravel().tolist()
    with ticking(progress) as tick:
        results, units, failure = _engine.outcomes(
            many, pairs, factors, spectral_periods, g, pulse, friction_demand, options, threads, tick
        )

    def motion_column(values: Sequence[Any], count: int) -> npt.NDArray[Any]:
        """Returns a column of values of the records, or of the scales, repeated for each record."""
        return np.tile(np.repeat(np.array(values), len(many) * count), number * len(factors) // (len(values) * count))

    columns: dict[str, npt.ArrayLike] = {}
    if horizontal:
        columns["record"] = motion_column(_names(horizontal), len(factors))
    if vertical_records:
        columns["vertical"] = motion_column(_names(vertical_records), len(factors))
    if horizontal or vertical_records:
        columns["scale"] = motion_column(factors, 1)
    if vertical_records:
        pga = motion_column([record.pga for record in vertical_records], len(factors))
        columns["PGA.vertical"] = pga * np.abs(columns["scale"])
    columns["foundation"] = np.tile(np.array(many.foundations()), number * len(factors))
    for name in ("alpha", "p", "eta", "xi_v", "epsilon", "restitution_factor"):
        columns[name] = np.tile(many.column(name), number * len(factors))
    frequencies = np.asarray(columns["p"])
    columns["2pi/p"] = 2 * np.pi / frequencies
    if pulse is not None:
        columns["omega_p/p"] = 2 * np.pi / pulse.period / frequencies
    columns.update({name: results[name] for name, _ in units})
    columns.update(results)
    _warn(results["outcome"], failure)
    single = isinstance(vertical if records is None else records, Record | str | os.PathLike | None)
    axes = (*(() if single else (number,)), *scales.shape, *shape)
    above = {name: "s" for name in columns if name.startswith("friction_demand>")}
    return Table(columns, {name: unit for name, unit in (_UNITS | dict(units) | above).items() if name in columns},
    axes)


def _read(name: str, records: Records | None, g: float) -> list[Record]:
    if records is None:
        return []
    several = [records] if isinstance(records, Record | str | os.PathLike) else records
    listed = [as_record(name, record, g) for record in several]
    if not listed:
        raise ValueError(f"{name} = []; expected at least one")
    return listed


def _names(records: Sequence[Record]) -> list[str]:
    """Returns distinct names: unnamed records get their number, and repeated names have it appended."""
    names: list[str] = []
    for number, record in enumerate(records):
        name = record.name or str(number)
        names.append(f"{name} ({number})" if name in names else name)
    return names


def _warn(found: Sequence[str] | npt.NDArray[Any], failure: str | None) -> None:
    if failure is not None:
        failed = np.flatnonzero(np.asarray(found) == "failed")
        message = f"{len(failed)} of {len(found)} runs failed, the first in row {failed[0]}: {failure}"
        warnings.warn(message, RuntimeWarning, stacklevel=3)
