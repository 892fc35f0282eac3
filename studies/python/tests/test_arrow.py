"""Tables in the libraries that read Arrow."""

import sys

import numpy as np
import pytest
from test_assess import RECORDS

import rocking_block as rb

STUDY = {
    "study": {"design": "grid", "levels": {"im": "PGV", "values": [0.2, 0.8]}},
    "parameters": {"foundation": "rigid", "alpha": 0.15, "p": [1.5, 2.2]},
    "records": [{"horizontal": f"{RECORDS}/*.smc"}],
}
PULSE = {"alpha": 0.25, "p": [1.0, 2.0], "pulse": {"shape": "one-sine", "amplitude": 6.2622, "period": 1.2566}}
TABLES = {
    "sweep": lambda: rb.sweep(STUDY),
    "sweep of a pulse": lambda: rb.sweep({"study": {"design": "grid"}, "parameters": PULSE}),
    "outcomes": lambda: rb.outcomes(rb.blocks(alpha=0.2, p=[1.5, 2.2]), f"{RECORDS}/0111a.smc", scale=[1.0, 3.0]),
    "ida": lambda: rb.ida(STUDY).table,
}


def of_pyarrow(table):
    pyarrow = pytest.importorskip("pyarrow")
    read = pyarrow.RecordBatchReader.from_stream(table).read_all()
    assert read.schema.equals(table.to_arrow().schema, check_metadata=True)
    return read.to_pydict()


def of_polars(table):
    polars = pytest.importorskip("polars")
    frame = polars.from_arrow(table.to_arrow())
    assert frame.equals(polars.from_arrow(table).struct.unnest())
    return frame.to_dict(as_series=False)


def of_duckdb(table):
    duckdb = pytest.importorskip("duckdb")
    runs = table.to_arrow()
    assert duckdb.sql("SELECT count(*) FROM runs").fetchall() == [(table.rows,)]
    found = duckdb.from_arrow(runs)
    return dict(zip(found.columns, zip(*found.fetchall())))


def of_pandas(table):
    pandas = pytest.importorskip("pandas", minversion="3")
    pytest.importorskip("pyarrow")
    frame = pandas.DataFrame.from_arrow(table.to_arrow())
    return {name: frame[name].astype(object).where(frame[name].notna(), None).tolist() for name in frame}


@pytest.mark.parametrize("taken", [of_pyarrow, of_polars, of_duckdb, of_pandas])
@pytest.mark.parametrize("name", TABLES)
def test_libraries_take_tables_to_the_last_bit(taken, name):
    table = TABLES[name]()
    found = taken(table)
    assert list(found) == list(table)
    for column, values in table.items():
        missing = np.isnan(values) if values.dtype.kind == "f" else values == "" if values.dtype.kind == "U" else values != values
        assert [value is None for value in found[column]] == missing.tolist(), column
        kept = [value for value in found[column] if value is not None]
        expected = values[~missing]
        if values.dtype.kind == "f":
            assert np.array_equal(np.array(kept, dtype=float).view(np.int64), expected.view(np.int64)), column
        else:
            assert kept == expected.tolist() and all(type(value) is type(like) for value, like in zip(kept, expected.tolist()))


@pytest.mark.parametrize("name", TABLES)
def test_fields_have_units(name):
    pytest.importorskip("pyarrow")
    table = TABLES[name]()
    units = {field.name: field.metadata[b"unit"].decode() for field in table.to_arrow().schema if field.metadata}
    assert units == table.units and units["peak.N"] == "N" and units["p"] == "rad/s" and "outcome" not in units


def test_numbers_are_shared_and_missing_ones_are_nulls():
    pyarrow = pytest.importorskip("pyarrow")
    columns = {"x": np.array([0.1, np.nan, -0.0, np.inf]), "n": np.arange(4), "is_whole": np.arange(4) > 1, "word": ["a", "", "b", "a"]}
    table = rb.Table(columns, {"x": "m"})
    arrow = table.to_arrow()
    assert arrow.schema.types == [pyarrow.float64(), pyarrow.int64(), pyarrow.bool_(), pyarrow.string()]
    assert arrow.to_pydict() == {"x": [0.1, None, -0.0, np.inf], "n": [0, 1, 2, 3], "is_whole": [False, False, True, True], "word": ["a", None, "b", "a"]}
    for name in ("x", "n"):
        assert arrow[name].chunk(0).buffers()[1].address == table[name].__array_interface__["data"][0]
    assert rb.Table({"word": np.array(["a", None], dtype=object)}).to_arrow()["word"].to_pylist() == ["a", None]
    assert table[:0].to_arrow().schema == arrow.schema and rb.Table({}).to_arrow().num_columns == 0


def test_a_file_of_parquet_restores_the_table(tmp_path):
    pyarrow = pytest.importorskip("pyarrow")
    import pyarrow.parquet
    from rocking_block._table import read_table

    for name in TABLES:
        table = TABLES[name]()
        table.to_parquet(tmp_path / "table.parquet")
        read = read_table(tmp_path / "table.parquet")
        assert read == table[:], name
    # The program keeps the units in the metadata of the file.
    pyarrow.parquet.write_table(pyarrow.table({"x": [0.5, None]}, metadata={"units": '{"x": "m/s"}'}), tmp_path / "of_program.parquet")
    assert read_table(tmp_path / "of_program.parquet") == rb.Table({"x": [0.5, float("nan")]}, {"x": "m/s"})


def test_a_missing_pyarrow_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    table = rb.Table({"x": [1.0]})
    for make in (table.to_arrow, table.__arrow_c_stream__):
        with pytest.raises(ModuleNotFoundError, match="to_arrow needs pyarrow; python -m pip install pyarrow"):
            make()


def test_columns_of_blocks_have_the_units_of_their_parameters():
    ties = [[rb.Tie(block_z=z, ground_x=z, stiffness=1e4 * z, strength=1e3 * z, damping=z)] * 2 for z in (1.0, 2.0)]
    blocks = [rb.Block(width=w, height=3.0 * w, K=1e7 * w, C=4e4 * w, mass=1e3 * w, ties=tie) for w, tie in zip((0.8, 1.0), ties)]
    units = rb.outcomes(blocks, pulse=rb.Pulse("one-sine", 6.0, 1.25), progress=False).units
    expected = {"alpha": "rad", "p": "rad/s", "eta": "1", "width": "m", "K": "N/m", "C": "N.s/m", "mass": "kg", "2pi/p": "s", "omega_p/p": "1"}
    of_tie = {"block_z": "m", "stiffness": "N/m", "damping": "N.s/m", "strength": "N"}
    expected |= {f"tie_{number}.{name}": unit for number in (1, 2) for name, unit in of_tie.items()}
    assert {name: units.get(name) for name in expected} == expected
