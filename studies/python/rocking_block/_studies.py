"""Many runs: spectra, lists of blocks, and studies from files."""

from __future__ import annotations

import os
import warnings
from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from pathlib import Path
from typing import Any, Literal, get_args, overload

import numpy as np
import numpy.typing as npt

from rocking_block import _engine, _parts, _toml
from rocking_block._block import Block
from rocking_block._outcomes import Records, table_of_outcomes, varying, warn_of_failures
from rocking_block._pulse import Pulse
from rocking_block._table import Table, of_columns
from rocking_block._words import Floats, Foundation, OnOverturning, OnSeparation, Polarity, chosen, is_url, run_options, ticking

def spectrum(
    *,
    p: npt.ArrayLike,
    alpha: npt.ArrayLike | None = None,
    eta: npt.ArrayLike | None = None,
    xi_v: npt.ArrayLike | None = None,
    epsilon: npt.ArrayLike = 0.0,
    restitution_factor: npt.ArrayLike | None = None,
    foundation: Foundation = "viscoelastic",
    mass: float = 1000.0,
    gamma: float = 3.0,
    g: float = 9.81,
    friction: float | None = None,
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
        One row per record × scale × curve × size, in this order; `shape` has an axis for each array argument. An unnamed
        record is named by a checksum of its samples, so that tables of several calls can be joined.

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
    given = {"alpha": Block().alpha if alpha is None else alpha, "eta": eta, "xi_v": xi_v, "epsilon": epsilon, "restitution_factor": restitution_factor}
    curves = _broadcast(**{name: values for name, values in given.items() if values is not None})
    sizes = _broadcast(p=p)["p"]
    each = {name: np.repeat(values.ravel(), sizes.size) for name, values in curves.items()}
    each["p"] = np.tile(sizes.ravel(), curves["alpha"].size)
    common = {"foundation": chosen("foundation", foundation, get_args(Foundation)), "mass": mass, "gamma": gamma, "g": g}
    many = _engine.Blocks(common | {"friction": friction}, each)
    options = run_options(tolerance, on_separation, on_overturning, duration, step)
    shape = (*curves["alpha"].shape, *sizes.shape)
    return table_of_outcomes(many, shape, records, vertical, scale, periods, pulse, g, friction_demand, options, threads, progress)


def blocks(**parameters: npt.ArrayLike | Sequence[float | None] | None) -> list[Block]:
    """Returns blocks from parameters that broadcast as in NumPy, in the order of the elements.

    Parameters
    ----------
    **parameters : array_like
        Those of `Block`; `foundation` may be an array of words, and `friction` may contain None. All blocks have the same `ties`
        and `dampers`.

    Examples
    --------
    >>> import rocking_block as rb
    >>> [block.p for block in rb.blocks(alpha=[0.1, 0.2], p=[1.0, 2.0], eta=60)]
    [1.0, 2.0]
    """
    ties: dict[str, Any] = {name: parameters.pop(name) for name in ("ties", "dampers") if name in parameters}
    names = list(parameters)
    arrays = _same_shape({name: np.asarray(value) for name, value in parameters.items()})
    rows = zip(*(array.ravel().tolist() for array in arrays.values()), strict=True)
    return [Block(**dict(zip(names, row, strict=True)), **ties) for row in rows]


def outcomes(
    blocks: Block | Sequence[Block],
    records: Records | None = None,
    *,
    vertical: Records | None = None,
    polarity: Polarity = "as-recorded",
    scale: npt.ArrayLike = 1.0,
    periods: npt.ArrayLike = (),
    pulse: Pulse | None = None,
    tolerance: float = 1e-6,
    on_separation: OnSeparation = "fly",
    on_overturning: OnOverturning = "terminate",
    duration: float | None = None,
    step: float | None = None,
    friction_demand: float | None = None,
    parts: int | None = None,
    executor: Executor | None = None,
    threads: int | None = None,
    progress: bool | None = None,
) -> Table:
    """Computes the outcome and peaks of each block under each record, on all cores or on the workers of an executor.

    Parameters
    ----------
    blocks : Block or sequence of Block
        The blocks.
    records, vertical, scale, periods, pulse, tolerance, on_separation, on_overturning, duration, step,
    friction_demand, progress
        As in `spectrum`; files in g are converted with 9.81 m/s².
    polarity : {"as-recorded", "both"}
        With both, each record is followed by itself with the horizontal accelerations reversed, in the same vertical ones. It matters to uneven
        blocks and to ties on one side. Both are one motion to `fragility`.
    parts, executor, threads
        As in `sweep`. A part has some of the records and some of the blocks, and the worker gets these with it.

    Returns
    -------
    Table
        One row per record × scale × block, in this order. Parameters of the blocks that vary have columns, those of ties as
        `tie_1.stiffness`.

    Raises
    ------
    ValueError, OSError
        As `spectrum`.

    Examples
    --------
    >>> import rocking_block as rb
    >>> pulse = rb.Pulse("one-sine", amplitude=6.2622, period=1.2566)
    >>> rb.outcomes(rb.blocks(alpha=0.25, p=[1.0, 1.5, 3.0]), pulse=pulse)["outcome"].tolist()
    ['completed', 'overturned', 'overturned']
    """
    single = isinstance(blocks, _engine.Block)
    listed = [blocks] if isinstance(blocks, _engine.Block) else list(blocks)
    if not listed:
        raise ValueError("blocks = []; expected at least one")
    _parts.check_executor(executor)
    if executor is None and parts is not None:
        raise ValueError("parts has no effect without an executor")
    for block in listed:
        if not isinstance(block, _engine.Block):
            raise TypeError(f"blocks has {block!r}; expected Blocks")
    many = _engine.Blocks.of(listed)
    shape = () if single else (len(many),)
    options = run_options(tolerance, on_separation, on_overturning, duration, step)
    more = varying(listed)
    return table_of_outcomes(
        many,
        shape,
        records,
        vertical,
        scale,
        periods,
        pulse,
        9.81,
        friction_demand,
        options,
        threads,
        progress,
        more,
        listed,
        parts,
        executor,
        polarity,
    )


@overload
def sweep(
    study: str | os.PathLike[str] | Mapping[str, Any],
    *,
    on_separation: OnSeparation | None = None,
    out: str | os.PathLike[str] | None = None,
    threads: int | None = None,
    progress: bool | None = None,
) -> Table: ...
@overload
def sweep(
    study: str | os.PathLike[str] | Mapping[str, Any],
    *,
    on_separation: OnSeparation | None = None,
    parts: int | None = None,
    executor: Executor,
    threads: int | None = None,
    progress: bool | None = None,
) -> Table: ...
@overload
def sweep(
    study: str | os.PathLike[str] | Mapping[str, Any],
    *,
    on_separation: OnSeparation | None = None,
    out: str | os.PathLike[str],
    parts: int | None = None,
    part_format: Literal["parquet", "csv"] | None = None,
    executor: Executor,
    threads: int | None = None,
    progress: bool | None = None,
) -> None: ...
def sweep(
    study: str | os.PathLike[str] | Mapping[str, Any],
    *,
    on_separation: OnSeparation | None = None,
    out: str | os.PathLike[str] | None = None,
    parts: int | None = None,
    part_format: Literal["parquet", "csv"] | None = None,
    executor: Executor | None = None,
    threads: int | None = None,
    progress: bool | None = None,
) -> Table | None:
    """Runs a study over any parameters of the FMU, records and scale factors, on grids or Latin hypercubes.

    The table equals that of `rocking sweep` to the last bit.

    Parameters
    ----------
    study : path or mapping
        A study file (TOML), or its content as a dictionary. Paths in it are relative to the file's folder, or to the
        working directory.
    on_separation : {"fly", "terminate"}, optional
        Action at complete separation if the study does not name it; by default the block flies.
    out : path, optional
        CSV file of the table, with the bytes of `rocking sweep`. Rows are written as they come, and Ctrl-C keeps them: the same call
        continues. A file that exists must be that of an interrupted or complete run of this study. With an executor a folder, or the URL
        of one for which fsspec is installed: each worker writes its parts there, complete parts are left alone, and the parts are
        those of `rocking sweep --part`; `read_table` and `fragility` read the folder.
    parts : int, optional
        Number of parts for the executor; by default one for 10,000 rows but at least 32, of at least 500 rows each.
    part_format : {"parquet", "csv"}, optional
        Format of the parts in `out`; by default that of the parts in the folder, or Parquet.
    executor : concurrent.futures.Executor, optional
        Runs the parts: a `ProcessPoolExecutor`, the `get_executor()` of a client of Dask, an `MPIPoolExecutor` of mpi4py, or another one.
        Workers read the records by the paths of the study.
    threads : int, optional
        As in `spectrum`; with an executor, those of each part, by default 1.
    progress : bool, optional
        As in `spectrum`.

    Returns
    -------
    Table or None
        One row per combination × record × scale; None for a folder of parts. Parameters have their names in the FMU without the group: `alpha` for
        `dimensionless.alpha`.

    Raises
    ------
    OSError
        The study cannot be read.
    RuntimeError
        A part failed on its worker; the message names the part, and complete parts are kept.
    ValueError
        The study has a mistake; the message has its line, the value found and the one expected. Or `out` is the table of another
        study, or cannot be written.

    Warns
    -----
    RuntimeWarning
        Some runs failed: their outcome is "failed".
    UserWarning
        Records are scaled by more than 20, or a block or pulse is beyond reason.

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
    _parts.check_executor(executor)
    if executor is None and parts is not None:
        raise ValueError("parts has no effect without an executor")
    if part_format is not None and (executor is None or out is None):
        raise ValueError("part_format has no effect without an executor and a folder for its parts, out")
    if executor is None:
        return swept(study, on_separation, out, threads, progress)[0]
    if out is not None and Path(os.fspath(out)).suffix:
        raise ValueError(f"out = {os.fspath(out)}; expected a folder for the parts of an executor")
    source = _source(study, on_separation)
    with ticking(progress) as tick:
        read = _engine.Study(*source, False, tick)
    _warn(read.remarks, 2)
    folder = None if out is None else os.fspath(out)
    if folder is not None and not is_url(folder):
        folder = os.path.abspath(folder)
    table, failure, scales = _parts.made(source, read, folder, parts, part_format, executor, threads, progress)
    if failure is not None:
        warnings.warn(f"some runs failed, such as: {failure}", RuntimeWarning, stacklevel=2)
    _warn(_engine.strong_scales(scales), 2)
    return table


def _warn(doubts: list[str], stacklevel: int) -> None:
    """Gives warnings; the level 1 is the caller."""
    for doubt in doubts:
        warnings.warn(doubt, stacklevel=stacklevel + 1)


def _source(study: str | os.PathLike[str] | Mapping[str, Any], on_separation: OnSeparation | None) -> _parts.Source:
    """Returns what the engine needs to read a study."""
    if isinstance(study, Mapping):
        return _parts.Source(None, _toml.text(study), os.getcwd(), on_separation)
    path = Path(study)
    return _parts.Source(str(path), path.read_text(encoding="utf-8"), str(path.parent.absolute()), on_separation)


def swept(
    study: str | os.PathLike[str] | Mapping[str, Any],
    on_separation: OnSeparation | None,
    out: str | os.PathLike[str] | None,
    threads: int | None,
    progress: bool | None,
) -> tuple[Table, str | None]:
    """Returns the table of `sweep`, and the measure whose levels the study names, if it does."""
    source = _source(study, on_separation)
    ending = None if out is None else Path(out).suffix.lower()
    if ending not in (None, ".csv", ".parquet"):
        raise ValueError(f"out = {out}; expected a name in .csv or .parquet")
    if out is not None and ending == ".parquet" and Path(out).exists():
        raise ValueError(f"{out}: exists already, and a Parquet table is written whole; expected another name")
    with ticking(progress) as tick:
        read = _engine.Study(*source, False, tick)
        _warn(read.remarks, 3)
        if out is not None and ending == ".parquet":
            content, (columns, failure, scales) = read.parquet(threads, tick)
            _parts.Folder(str(Path(out).absolute().parent)).write(Path(out).name, content)
        else:
            columns, failure, scales = read.table(threads, out, tick)
    # The numbers of the rows are those of the arrays.
    table = of_columns(columns[1:])
    warn_of_failures(table["outcome"], failure, 4)
    _warn(_engine.strong_scales(scales), 3)
    return table, read.measure


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
