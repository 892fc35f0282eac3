"""Results of many runs: columns of equal length."""

from __future__ import annotations

import json
import math
import os
import tempfile
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, NamedTuple, NoReturn, overload

import numpy as np
import numpy.typing as npt

from rocking_block import _engine
from rocking_block._arrow import arrow_values
from rocking_block._html import html_table
from rocking_block._words import is_url, optional

if TYPE_CHECKING:
    import pandas
    import pyarrow
    from matplotlib.axes import Axes


class Table(dict[str, npt.NDArray[Any]]):
    """Named columns, each an array of shape (n,), with one row per run. The names are those of the program's tables.

    A table is an immutable dictionary, so `pandas.DataFrame(table)` works. `table["p"]` is a column, and
    `table[table["outcome"] == "completed"]` is a table of the rows selected by a mask; row numbers and slices work as well.

    Parameters
    ----------
    columns : mapping of str to array_like
        The columns, all of equal length.
    units : mapping of str to str
        Units of the columns that have one.
    shape : tuple of int, optional
        Shape of the study: `table["outcome"].reshape(table.shape)` has one axis per array argument.

    Examples
    --------
    >>> import rocking_block as rb
    >>> table = rb.Table({"p": [1.0, 2.0], "outcome": ["completed", "overturned"]}, {"p": "rad/s"})
    >>> table["p"], table.units["p"]
    (array([1., 2.]), 'rad/s')
    >>> table
    <Table of 2 rows, shape (2,): 1 completed, 1 overturned; p [rad/s], outcome>
    >>> table[table["p"] > 1.5]["outcome"].tolist()
    ['overturned']
    """

    def __init__(
        self,
        columns: Mapping[str, npt.ArrayLike],
        units: Mapping[str, str] | None = None,
        shape: tuple[int, ...] | None = None,
    ) -> None:
        # Views keep the caller's arrays writable.
        super().__init__({name: np.asarray(column).view() for name, column in columns.items()})
        for name, column in self.items():
            if column.ndim != 1:
                raise ValueError(f"column {name!r} has shape {column.shape}; expected one dimension")
            column.setflags(write=False)
        rows = {len(column) for column in self.values()}
        if len(rows) > 1:
            raise ValueError(f"columns have {sorted(rows)} rows; expected one length")
        self._units = dict(units or {})
        self._shape = shape if shape is not None else (max(rows, default=0),)
        if math.prod(self._shape) != max(rows, default=0):
            raise ValueError(f"shape = {shape} with {max(rows, default=0)} rows; expected an equal number of elements")

    @property
    def units(self) -> dict[str, str]:
        """Units of the columns that have one; "1" for pure numbers."""
        return dict(self._units)

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the study."""
        return self._shape

    @property
    def rows(self) -> int:
        """Number of rows."""
        return len(next(iter(self.values()), ()))

    @overload
    def __getitem__(self, key: str) -> npt.NDArray[Any]: ...
    @overload
    def __getitem__(self, key: slice | npt.NDArray[Any] | Sequence[int] | Sequence[bool]) -> Table: ...
    def __getitem__(self, key: Any) -> npt.NDArray[Any] | Table:
        if isinstance(key, slice):
            return Table({name: column[key] for name, column in self.items()}, self._units)
        if not isinstance(key, str):
            chosen = np.asarray(key)
            if chosen.ndim != 1:
                raise TypeError(f"table[{key!r}]; expected a column's name, or a mask or numbers of rows in one dimension")
            chosen = chosen if chosen.size else chosen.astype(np.intp)
            return Table({name: column[chosen] for name, column in self.items()}, self._units)
        try:
            return super().__getitem__(key)
        except KeyError:
            raise KeyError(f"there is no column {key!r}; expected one of {', '.join(self)}") from None

    def _refuse_change(self, *_: Any, **__: Any) -> NoReturn:
        """Raises an error: a table is immutable."""
        raise TypeError("a Table cannot be changed; make another, as in Table({**table, ...}, table.units)")

    __setitem__ = __delitem__ = __ior__ = pop = popitem = clear = _refuse_change
    update = setdefault = _refuse_change  # pyright: ignore[reportAssignmentType]

    def __reduce__(self) -> tuple[Any, ...]:
        return (Table, (dict(self), self._units, self._shape))

    def __eq__(self, other: object) -> bool:
        """Compares all columns, units and the shape; nan equals nan."""
        if not isinstance(other, Table):
            return NotImplemented
        kept = list(self) == list(other) and self._units == other._units and self._shape == other._shape
        return kept and all(
            np.array_equal(column, other[name], equal_nan=column.dtype.kind == "f") for name, column in self.items()
        )

    def __ne__(self, other: object) -> bool:
        equal = self.__eq__(other)
        return equal if equal is NotImplemented else not equal

    __hash__ = None

    def to_frame(self) -> pandas.DataFrame:
        """Returns a pandas DataFrame, with the units in `attrs["units"]`."""
        with optional("to_frame", "pandas"):
            import pandas

        frame = pandas.DataFrame(dict(self))
        frame.attrs["units"] = self.units
        return frame

    @staticmethod
    def concat(tables: Iterable[Table]) -> Table:
        """Joins tables of the same columns, one after the other.

        Raises
        ------
        ValueError
            There is no table, or one has other columns or units.

        Examples
        --------
        >>> import rocking_block as rb
        >>> parts = [rb.Table({"p": [1.0, 2.0]}, {"p": "rad/s"}), rb.Table({"p": [3.0]}, {"p": "rad/s"})]
        >>> rb.Table.concat(parts)["p"]
        array([1., 2., 3.])
        """
        listed = list(tables)
        if not listed:
            raise ValueError("tables = []; expected at least one")
        first = listed[0]
        for number, table in enumerate(listed):
            if list(table) != list(first) or table.units != first.units:
                headings = [", ".join(map(one.heading, one)) for one in (table, first)]
                raise ValueError(f"table {number} has the columns {headings[0]}; expected those of the first, {headings[1]}")
        return Table({name: np.concatenate([table[name] for table in listed]) for name in first}, first.units)

    def to_arrow(self) -> pyarrow.Table:
        """Returns a pyarrow Table, with the unit of each column in the metadata of its field.

        Missing values, nan in columns of numbers and empty texts, are nulls, as in the program's JSON. The numbers are not copied.

        Examples
        --------
        >>> import rocking_block as rb
        >>> arrow = rb.Table({"PGV": [0.2, float("nan")], "outcome": ["completed", "overturned"]}, {"PGV": "m/s"}).to_arrow()
        >>> arrow["PGV"].to_pylist(), arrow.schema.field("PGV").metadata
        ([0.2, None], {b'unit': b'm/s'})
        """
        with optional("to_arrow", "pyarrow"):
            import pyarrow

        def field(name: str, array: Any) -> Any:
            return pyarrow.field(name, array.type, metadata={"unit": self._units[name]} if name in self._units else None)

        arrays = {
            name: pyarrow.array(column, mask=column == "" if column.dtype.kind == "U" else None, from_pandas=True)
            for name, column in self.items()
        }
        fields = [field(name, array) for name, array in arrays.items()]
        return pyarrow.table(list(arrays.values()), schema=pyarrow.schema(fields))

    def __arrow_c_stream__(self, requested_schema: object = None) -> object:
        """Returns the columns of `to_arrow` as a stream of the Arrow PyCapsule interface."""
        return self.to_arrow().__arrow_c_stream__(requested_schema)

    def to_parquet(self, path: str | os.PathLike[str]) -> None:
        """Writes the table of `to_arrow` to a Parquet file."""
        with optional("to_parquet", "pyarrow"):
            import pyarrow.parquet

        pyarrow.parquet.write_table(self.to_arrow(), os.fspath(path))

    def plot(
        self,
        x: str | None = None,
        y: str = "peak.theta/alpha",
        *,
        by: str | Sequence[str] | None = None,
        ax: Axes | None = None,
        **style: Any,
    ) -> Axes:
        """Draws one column over another with Matplotlib: curves if each x has a single row, otherwise points.

        Parameters
        ----------
        x : str, optional
            Column on the horizontal axis; by default the first that varies of 2pi/p, PGV, scale and the blocks'
            parameters.
        y : str
            Column on the vertical axis. Rotations above 1.5 |θ|/α are clipped, and the plot states the largest. Curves of rotations
            are blank for blocks that overturned, and a lane per curve shows which blocks separated or overturned.
        by : str or sequence of str, optional
            Columns that distinguish curves; by default the parameters of records and blocks that vary besides x. Points
            then have a marker per outcome.
        ax : Axes, optional
            Axes to draw on; by default pyplot's current axes, or a new figure if these show another kind of plot.
        **style
            Options of `Axes.plot`.

        Raises
        ------
        ValueError
            A column does not exist, or is not numeric.
        """
        from rocking_block import _plot_table

        return _plot_table.table(self, self.heading, x, y, by, ax, style)

    def heading(self, name: str) -> str:
        """Returns the name of a column with its unit, as in the program's tables."""
        return f"{name} [{self._units[name]}]" if name in self._units else name

    def _count(self) -> str:
        found = Counter(self["outcome"].tolist()) if "outcome" in self else {}
        return ", ".join(f"{count} {outcome}" for outcome, count in sorted(found.items()))

    def __repr__(self) -> str:
        outcomes = f"{self._count()}; " if self._count() else ""
        return f"<Table of {self.rows} rows, shape {self.shape}: {outcomes}{', '.join(map(self.heading, self))}>"

    def _repr_html_(self) -> str:
        shown = self[:10]
        caption = f"{self.rows} rows, shape {self.shape}" + (f": {self._count()}" if self._count() else "")
        if self.rows > shown.rows:
            caption += f"; the first {shown.rows} are shown"
        return html_table(caption, [self.heading(name) for name in self], zip(*shown.values(), strict=True), ("record", "vertical"))


def split_heading(heading: str) -> tuple[str, str | None]:
    """Returns the name and the unit of a heading of the program, such as "PGV [m/s]"."""
    name, bracket, unit = heading[:-1].rpartition(" [")
    return (name, unit) if bracket and heading.endswith("]") else (heading, None)


def by_name(table: Any) -> Table:
    """Returns a table, a DataFrame or a mapping as a Table; headings such as "PGV [m/s]" are names with units."""
    if isinstance(table, Table):
        return table
    columns, units = {}, dict(getattr(table, "attrs", {}).get("units", {}))
    for heading in table:
        name, unit = split_heading(str(heading))
        if name in columns:
            raise ValueError(f"found two columns {name!r}, one of them {str(heading)!r}; expected one")
        columns[name] = np.asarray(table[heading])
        if unit is not None:
            units[name] = unit
    return Table(columns, units)


def of_columns(columns: Iterable[tuple[str, str | None, npt.NDArray[Any]]], shape: tuple[int, ...] | None = None) -> Table:
    """Returns a table from names, units and values of columns."""
    listed = list(columns)
    units = {name: unit for name, unit, _ in listed if unit is not None}
    return Table({name: values for name, _, values in listed}, units, shape)


def read_table(path: str | os.PathLike[str], *, partial: bool = False) -> Table:
    """Reads a table of the program, a Parquet file of one, a folder with the parts of a study or other such files, or a pattern of them.

    Columns of numbers and empty fields are numeric, except for the names of records.

    Parameters
    ----------
    path : path
        The file, the folder, the URL of one for which fsspec is installed, or a pattern such as "runs/*.parquet". The rows of parts are in the order of the study, those of other files
        in the order of the names. Folders in it that are named as "region=north" give their rows a column of that name.
    partial : bool
        Read parts although others are missing.

    Raises
    ------
    OSError
        The file cannot be read.
    ValueError
        The file is no table, or a part is missing, damaged or that of another study; the message names it.
    """
    with _local(path) as place:
        return _read_table(place, partial)


def _read_table(path: str | os.PathLike[str], partial: bool) -> Table:
    files, _ = _files(path, partial)
    if _is_of_engine(files[0]):
        return of_columns(_engine.read_table(path, partial))
    tables: list[Table] = []

    def read(file: File) -> None:
        with optional("a Parquet file", "pyarrow"):
            import pyarrow.parquet

        tables.append(_with_keys(_of_arrow(pyarrow.parquet.ParquetFile(file.path).read()), file.keys))

    _read_parquet_files(files, read)
    return tables[0] if len(tables) == 1 else Table.concat(tables)


def for_each_batch(
    path: str | os.PathLike[str], partial: bool, cases: _engine.Cases, each: Callable[[Table, bool], None]
) -> None:
    """Has cases take the rows of a table. Those that the engine does not read are passed on in batches, with whether they are those of parts."""
    with _local(path) as place:
        _for_each_batch(place, partial, cases, each)


@contextmanager
def _local(path: str | os.PathLike[str]) -> Iterator[str | os.PathLike[str]]:
    """Yields a path on this machine: that of a URL is one of a copy of its files."""
    url = os.fspath(path)
    if not is_url(url):
        yield path
        return
    with optional(url, "fsspec"):
        import fsspec.core
    files, at = fsspec.core.url_to_fs(url)
    with tempfile.TemporaryDirectory() as folder:
        copy = os.path.join(folder, at.rstrip("/").rsplit("/", 1)[-1])
        files.get(at, copy, recursive=True)
        try:
            yield copy
        except ValueError as error:
            raise ValueError(str(error).replace(copy, url)) from None


def _for_each_batch(
    path: str | os.PathLike[str], partial: bool, cases: _engine.Cases, each: Callable[[Table, bool], None]
) -> None:
    files, is_part = _files(path, partial)
    if _is_of_engine(files[0]):
        cases.read(path, partial)
        return
    with optional("a Parquet file", "pyarrow"):
        import pyarrow
        import pyarrow.parquet

    def is_wanted(heading: str) -> bool:
        return cases.needs(split_heading(heading)[0])

    def read(file: File) -> None:
        keys = {name: value for name, value in file.keys.items() if is_wanted(name)}
        # By default the columns of all groups that were read stay in memory; without a buffer, those of one.
        with pyarrow.parquet.ParquetFile(file.path, pre_buffer=False, buffer_size=1 << 16) as content:
            schema, rows = content.schema_arrow, 0
            wanted = list(filter(is_wanted, schema.names))
            for batch in content.iter_batches(BATCH, columns=wanted, use_threads=False):
                rows += batch.num_rows
                table = pyarrow.Table.from_batches([batch], batch.schema.with_metadata(schema.metadata))
                each(_with_keys(_of_arrow(table), keys), is_part)
            # An empty file has columns as well.
            if rows == 0:
                each(_with_keys(_of_arrow(schema.empty_table().select(wanted)), keys), is_part)

    _read_parquet_files(files, read)


BATCH = 1 << 14
"""Rows of a batch: of larger ones, the names of records and their copies take most of the memory of a fit."""


class File(NamedTuple):
    """A file of a table."""

    path: str
    keys: dict[str, float | str]
    """Keys in the names of its folders: columns of its rows."""
    part: str | None
    """The part, such as "3 of 10", if the file is one."""


def _files(path: str | os.PathLike[str], partial: bool) -> tuple[list[File], bool]:
    """Returns the files of a table, and whether they are the parts of one study."""
    if os.path.isdir(path) or (not os.path.exists(path) and any(mark in os.fspath(path) for mark in "*?[")):
        files, is_part = _engine.table_files(path, partial)
        values: dict[str, list[str]] = {}
        for _, keys, _ in files:
            for name, value in keys:
                values.setdefault(name, []).append(value)
        are_numbers = {name for name in values if name not in ("record", "vertical") and _are_numbers(values[name])}
        return [
            File(file, {name: float(value or "nan") if name in are_numbers else value for name, value in keys}, part)
            for file, keys, part in files
        ], is_part
    if partial:
        raise ValueError(f"partial has no effect without a folder of parts; found {os.fspath(path)}")
    return [File(os.fspath(path), {}, None)], False


def _are_numbers(texts: list[str]) -> bool:
    try:
        for text in texts:
            float(text or "nan")
    except ValueError:
        return False
    return True


def _with_keys(table: Table, keys: Mapping[str, float | str]) -> Table:
    """Returns a table with a column for each key that it lacks."""
    more = {name: np.broadcast_to(np.asarray(value), table.rows) for name, value in keys.items() if name not in table}
    return Table({**table, **more}, table.units) if more else table


def _is_of_engine(file: File) -> bool:
    """Returns whether the engine reads a file: a part, or CSV by its name and its content. Parquet of others has codecs and types that it does not know."""
    if file.part is not None:
        return True
    with open(file.path, "rb") as content:
        return not file.path.lower().endswith(".parquet") and content.read(4) != b"PAR1"


def _read_parquet_files(files: list[File], read: Callable[[File], None]) -> None:
    """Reads files with a function; says which one cannot be read."""
    with optional("a Parquet file", "pyarrow"):
        import pyarrow
        import pyarrow.parquet

    for file in files:
        try:
            read(file)
        except (pyarrow.ArrowException, OSError) as error:
            # Errors of the system have a number.
            if isinstance(error, OSError) and error.errno is not None:
                raise
            raise ValueError(f"{file.path}: cannot be read as Parquet: {error}") from None


def _of_arrow(table: Any) -> Table:
    # The program keeps all units in the metadata of the file, `to_parquet` in those of the columns.
    units = json.loads((table.schema.metadata or {}).get(b"units", "{}"))
    units |= {field.name: field.metadata[b"unit"].decode() for field in table.schema if b"unit" in (field.metadata or {})}
    named = by_name({name: arrow_values(table[name]) for name in table.column_names})
    return Table(named, {name: unit for name, unit in units.items() if name in named} | named.units)
