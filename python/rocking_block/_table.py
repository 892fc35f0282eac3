"""Results of many runs: columns of equal length."""

import csv
import math
import os
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NoReturn, overload

import numpy as np
import numpy.typing as npt

from rocking_block._html import html_table
from rocking_block._words import optional

if TYPE_CHECKING:
    import pandas
    from matplotlib.axes import Axes

# Columns of whole numbers.
_COUNTS = ("flights", "events.impacts", "events.liftoffs")


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
    def __getitem__(self, key: slice | npt.NDArray[Any] | Sequence[int] | Sequence[bool]) -> "Table": ...
    def __getitem__(self, key: Any) -> "npt.NDArray[Any] | Table":
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

    def to_frame(self) -> "pandas.DataFrame":
        """Returns a pandas DataFrame, with the units in `attrs["units"]`."""
        with optional("to_frame", "pandas"):
            import pandas

        frame = pandas.DataFrame(dict(self))
        frame.attrs["units"] = self.units
        return frame

    def to_parquet(self, path: str | os.PathLike[str]) -> None:
        """Writes a Parquet file with pyarrow, with the units in the fields' metadata."""
        with optional("to_parquet", "pyarrow"):
            import pyarrow
            import pyarrow.parquet

        arrays = {name: pyarrow.array(column) for name, column in self.items()}
        fields = [
            pyarrow.field(name, array.type, metadata={"unit": self._units[name]} if name in self._units else None)
            for name, array in arrays.items()
        ]
        table = pyarrow.table(list(arrays.values()), schema=pyarrow.schema(fields))
        pyarrow.parquet.write_table(table, os.fspath(path))

    def plot(
        self,
        x: str | None = None,
        y: str = "peak.theta/alpha",
        *,
        by: str | Sequence[str] | None = None,
        ax: "Axes | None" = None,
        **style: Any,
    ) -> "Axes":
        """Draws one column over another with Matplotlib: curves if each x has a single row, otherwise points.

        Parameters
        ----------
        x : str, optional
            Column on the horizontal axis; by default the first that varies of 2pi/p, PGV, scale and the blocks'
            parameters.
        y : str
            Column on the vertical axis. Rotations above 1.5 |θ|/α are clipped, and the plot states the largest.
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
        from rocking_block import _plot

        return _plot.table(self, self._heading, x, y, by, ax, style)

    def _heading(self, name: str) -> str:
        return f"{name} [{self._units[name]}]" if name in self._units else name

    def _count(self) -> str:
        found = Counter(self["outcome"].tolist()) if "outcome" in self else {}
        return ", ".join(f"{count} {outcome}" for outcome, count in sorted(found.items()))

    def __repr__(self) -> str:
        outcomes = f"{self._count()}; " if self._count() else ""
        return f"<Table of {self.rows} rows, shape {self.shape}: {outcomes}{', '.join(map(self._heading, self))}>"

    def _repr_html_(self) -> str:
        shown = self[:10]
        caption = f"{self.rows} rows, shape {self.shape}" + (f": {self._count()}" if self._count() else "")
        if self.rows > shown.rows:
            caption += f"; the first {shown.rows} are shown"
        return html_table(caption, [self._heading(name) for name in self], zip(*shown.values(), strict=True))


def of_program(headings: list[str], columns: list[Any]) -> Table:
    """Returns a table from columns and the program's headings: a name and, in brackets, a unit."""
    named, units = {}, {}
    for heading, column in zip(headings, columns, strict=True):
        name, unit = heading, None
        if heading.endswith("]"):
            name, _, unit = heading[:-1].rpartition(" [")
        values = np.asarray(column)
        if unit is None and set(column) <= {"true", "false"}:
            values = values == "true"
        named[name] = values.astype(np.int64) if name in _COUNTS else values
        if unit is not None:
            units[name] = unit
    return Table(named, units)


def read_table(path: str | os.PathLike[str]) -> Table:
    """Reads a table of the program. Columns of numbers and empty fields are numeric, except for the names of records."""
    with open(path, newline="", encoding="utf-8") as file:
        lines = [row for row in csv.reader(line for line in file if not line.startswith("#")) if row]
    if not lines:
        raise ValueError(f"{os.fspath(path)}: found no lines; expected a table of `rocking sweep`")
    headings, rows = lines[0], lines[1:]
    for number, row in enumerate(rows):
        if len(row) != len(headings):
            raise ValueError(f"{os.fspath(path)}: row {number} has {len(row)} fields; expected {len(headings)}, as in the heading")
    columns = [[row[i] for row in rows] for i in range(len(headings))]
    named = zip(headings, columns, strict=True)
    return of_program(headings, [column if name in ("record", "vertical") else _numbers(column) for name, column in named])


def _numbers(column: list[str]) -> list[Any]:
    """Returns a column as numbers, with nan for empty fields, or as it is if it has words."""
    try:
        return [float(field) if field else math.nan for field in column]
    except ValueError:
        return column
