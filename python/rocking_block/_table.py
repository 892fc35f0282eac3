"""What many runs came to: columns of one length."""

import os
from collections import Counter
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    import pandas

# A heading of the program is the name and, in brackets, the unit.
_COUNTS = ("flights", "events.impacts", "events.liftoffs")


class Table(Mapping[str, npt.NDArray[Any]]):
    """Columns by their names, each an array of shape (n,), a row for each run. The names are those of the program's tables.

    Parameters
    ----------
    columns : mapping of str to array_like
        The columns, all of one length.
    units : mapping of str to str
        Units of the columns that have one.
    shape : tuple of int, optional
        Shape of the study: `table["outcome"].reshape(table.shape)` has an axis for each argument that was an array.

    Examples
    --------
    >>> import rocking_block as rb
    >>> table = rb.Table({"p": [1.0, 2.0], "outcome": ["completed", "overturned"]}, {"p": "rad/s"})
    >>> table["p"], table.units["p"]
    (array([1., 2.]), 'rad/s')
    >>> table
    <Table of 2 rows, shape (2,): 1 completed, 1 overturned; p [rad/s], outcome>
    """

    def __init__(
        self,
        columns: Mapping[str, npt.ArrayLike],
        units: Mapping[str, str] | None = None,
        shape: tuple[int, ...] | None = None,
    ) -> None:
        self._columns = {name: np.asarray(column) for name, column in columns.items()}
        for column in self._columns.values():
            column.setflags(write=False)
        rows = {len(column) for column in self._columns.values()}
        if len(rows) > 1:
            raise ValueError(f"columns have {sorted(rows)} rows; expected one length")
        self._units = dict(units or {})
        self._shape = shape if shape is not None else (max(rows, default=0),)

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
        return len(next(iter(self._columns.values()), ()))

    def __getitem__(self, name: str) -> npt.NDArray[Any]:
        try:
            return self._columns[name]
        except KeyError:
            raise KeyError(f"there is no column {name!r}; expected one of {', '.join(self._columns)}") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def __eq__(self, other: object) -> bool:
        """Whether all columns, units and the shape are the same; nan is the same as nan."""
        if not isinstance(other, Table):
            return NotImplemented
        kept = list(self) == list(other) and self._units == other._units and self._shape == other._shape
        return kept and all(
            np.array_equal(column, other[name], equal_nan=column.dtype.kind == "f") for name, column in self.items()
        )

    __hash__ = None  # type: ignore[assignment]

    def to_frame(self) -> "pandas.DataFrame":
        """The table as a pandas DataFrame."""
        import pandas

        return pandas.DataFrame(dict(self._columns))

    def to_parquet(self, path: str | os.PathLike[str]) -> None:
        """Writes the table as a Parquet file, by pyarrow; the fields' metadata have the units."""
        import pyarrow
        import pyarrow.parquet

        arrays = {name: pyarrow.array(column) for name, column in self._columns.items()}
        fields = [
            pyarrow.field(name, array.type, metadata={"unit": self._units[name]} if name in self._units else None)
            for name, array in arrays.items()
        ]
        table = pyarrow.table(list(arrays.values()), schema=pyarrow.schema(fields))
        pyarrow.parquet.write_table(table, os.fspath(path))

    def __repr__(self) -> str:
        found = Counter(self._columns["outcome"].tolist()) if "outcome" in self else Counter()
        outcomes = "".join(f"{count} {outcome}, " for outcome, count in sorted(found.items()))[:-2]
        names = [f"{name} [{self._units[name]}]" if name in self._units else name for name in self]
        return f"<Table of {self.rows} rows, shape {self.shape}: {outcomes}; {', '.join(names)}>"


def of_program(headings: list[str], columns: list[Any]) -> Table:
    """The table of headings as the program writes them, and their columns."""
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
