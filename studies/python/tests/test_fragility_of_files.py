"""Fragility curves of files, of parts, and of tables with many rows."""

import pickle
import subprocess
import sys
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from test_fragility import planted

import rocking_block as rb


@pytest.mark.parametrize("rows", [300, 150_000])
@pytest.mark.parametrize("ending", ["parquet", "csv"])
def test_files_have_the_curve_of_one_table(tmp_path, rows, ending):
    """Few rows are kept in the order of the table, many are sorted on disk: both have the same bits in one file and in several."""
    table = planted(rows)
    whole = rb.fragility(table, "PGV", 0.4)
    for number, piece in enumerate(np.array_split(np.arange(rows), 3)):
        if ending == "parquet":
            table[piece].to_parquet(tmp_path / f"{number}.parquet")
        else:
            table[piece].to_frame().to_csv(tmp_path / f"{number}.csv", index=False)
    for path in (tmp_path, f"{tmp_path}/*.{ending}"):
        fit = rb.fragility(path, "PGV", 0.4)
        assert repr(fit) == repr(whole).replace(" m/s", " m/s" if ending == "parquet" else "")
        for name in ("median", "beta", "median_ci", "beta_ci", "coefficients", "standard_errors", "auc", "brier", "goodness", "range"):
            assert getattr(fit, name) == getattr(whole, name), name
        assert np.isclose(fit.efficiency, whole.efficiency, rtol=1e-10) and fit.rocking == whole.rocking
        np.testing.assert_array_equal(fit.measures, whole.measures)
        np.testing.assert_array_equal(fit.fractions, whole.fractions)
        assert pickle.loads(pickle.dumps(fit)).median == fit.median
        assert len(fit.marks()[0]) == (rows if rows == 300 else 10_001)
    np.testing.assert_array_equal(rb.read_table(tmp_path)["PGV"], table["PGV"])
    with pytest.raises(ValueError, match="partial has no effect without a folder of parts"):
        rb.fragility(tmp_path / f"0.{ending}", "PGV", partial=True)
    with pytest.raises(ValueError, match="has no parts of a study"):
        rb.fragility(f"{tmp_path}/*.txt", "PGV")


def test_parts_in_another_order_have_the_same_intervals(tmp_path):
    """Motions are numbered by their first rows in the study, whatever the order of the parts."""
    table = rb.Table({"row": np.arange(300), **planted()}, {"PGV": "m/s"})
    whole = rb.fragility(table, "PGV", intervals="bootstrap", samples=20)
    from rocking_block import _engine
    from rocking_block._cases import Question, columns

    cases = Question("PGV", None).begin()
    for piece in reversed(np.array_split(np.arange(300), 7)):
        cases.take("table", list(columns(table[piece])), list(table), True)
    fit = _engine.Fragility(*cases.stored(), "probit", 0.95, 20, 1, lambda done, total: None)
    assert (fit.median_ci, fit.beta_ci) == (whole.median_ci, whole.beta_ci)


@pytest.mark.parametrize("is_frame", [False, True])
def test_a_fit_of_a_table_copies_no_column_of_texts(is_frame):
    """Beside the table are five numbers a row, their places, and the texts of a batch."""
    random = np.random.default_rng(1)
    rows = 200_000
    records = np.array([f"{'name of a record ' * 4}{number}" for number in range(40)])[random.integers(0, 40, rows)]
    measure = np.exp(random.normal(-0.4, 0.6, rows))
    outcome = np.where(random.random(rows) < measure / (1.0 + measure), "overturned", "completed")
    table = {"PGV": measure, "record": records, "outcome": outcome}
    if is_frame:
        table = pytest.importorskip("pandas").DataFrame(table)
    tracemalloc.start()
    try:
        fit = rb.fragility(table, "PGV", progress=False)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert fit.rows == rows and fit.independence == "clustered by 40 motions"
    assert peak < 8 * 8 * rows + 20e6 < records.nbytes, f"{peak / 1e6:.1f} MB"
    # Rows of later batches have their numbers in the whole table.
    outcome[-3] = "fallen"
    with pytest.raises(ValueError, match=f"table: row {rows - 3} has outcome = fallen; expected one of completed"):
        rb.fragility({"PGV": measure, "outcome": outcome}, "PGV", progress=False)


def test_a_fit_of_a_file_keeps_neither_its_groups_nor_pandas_in_memory(tmp_path):
    """pyarrow keeps all groups that were read by default, and imports pandas for its own conversion."""
    pytest.importorskip("pyarrow")
    import pyarrow.parquet

    random = np.random.default_rng(1)
    rows, groups = 100_000, 15
    with pyarrow.parquet.ParquetWriter(tmp_path / "table.parquet", pyarrow.schema({"PGV": "double", "outcome": "string"})) as writer:
        for _ in range(groups):
            measure = np.exp(random.normal(-0.4, 0.6, rows))
            falls = random.random(rows) < measure / (1.0 + measure)
            writer.write_table(pyarrow.table({"PGV": measure, "outcome": np.where(falls, "overturned", "completed")}))
    code = f"""
import sys
import pyarrow
import rocking_block as rb
assert rb.fragility({str(tmp_path / "table.parquet")!r}, "PGV").rows == {rows * groups}
print("pandas" in sys.modules, pyarrow.default_memory_pool().max_memory())
"""
    imported, most = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout.split()
    assert imported == "False"
    # A batch has some 2 MB, and the measures of all groups 12 MB.
    assert int(most) < 8e6


def test_conditions_choose_rows(tmp_path):
    """As tables of the chosen rows, and as `rocking fragility --where`; of a table in memory, a DataFrame and a file."""
    sources = {"levels": {"im": "PGV", "values": [0.2, 0.4, 0.6, 0.8, 1.0, 1.4]}}
    study = {"study": {"design": "grid"} | sources, "parameters": {"foundation": ["rigid", "viscoelastic"], "alpha": [0.12, 0.15, 0.18], "p": [2.0, 2.4]},
             "records": [{"horizontal": str(Path(__file__).resolve().parents[3] / "examples/records/*.smc")}]}
    table = rb.sweep(study, progress=False)
    chosen = table[(table["foundation"] == "rigid") & (table["p"] == 2.0)]
    expected = rb.fragility(chosen, "PGV")
    where = {"foundation": "rigid", "p": 2.0}
    path = tmp_path / "runs.csv"
    rb.sweep(study, out=path, progress=False)
    for source in (table, table.to_pandas() if hasattr(table, "to_pandas") else table, path):
        found = rb.fragility(source, "PGV", where=where)
        assert (found.rows, found.coefficients) == (36, expected.coefficients)
    assert pickle.loads(pickle.dumps(rb.fragility(path, "PGV", where=where))).rows == 36
    for source in (table, path):
        with pytest.raises(ValueError, match="found no row with foundation = sand; expected a value of that column"):
            rb.fragility(source, "PGV", where={"foundation": "sand"})
        with pytest.raises(ValueError, match="soil"):
            rb.fragility(source, "PGV", where={"soil": 1})
