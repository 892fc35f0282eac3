"""Frames, files and pictures of results, examples in docstrings, and types."""

import doctest
import importlib
import inspect
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import rocking_block as rb

PACKAGE = Path(__file__).resolve().parents[1]


def test_a_run_becomes_a_frame(record):
    run = rb.Block(alpha=0.15, p=2.5).run(record)
    frame = run.to_frame()
    assert frame.index.name == "t" and np.array_equal(frame.index, run.t)
    assert np.array_equal(frame["energy.total"], run.energy.total)
    assert np.array_equal(frame["regime"], run["regime"]) and run.regime.dtype == np.int8
    with pytest.raises(ValueError, match="read-only"):
        run.theta[0] = 1.0


def test_each_column_has_an_attribute_that_says_what_it_is():
    run = rb.Block().run(theta=0.1, duration=0.1)
    for name in run.columns:
        value = getattr(run.energy, name.removeprefix("energy.")) if name.startswith("energy.") else getattr(run, name)
        assert np.array_equal(value, run[name]), name


def test_a_table_becomes_a_frame_and_a_file(tmp_path):
    import pyarrow.parquet

    table = rb.spectrum(p=[1.0, 2.0], pulse=rb.Pulse("one-sine", 6.0, 1.25))
    assert table.to_frame()["outcome"].tolist() == table["outcome"].tolist()
    file = tmp_path / "table.parquet"
    table.to_parquet(file)
    read = pyarrow.parquet.read_table(file)
    assert read.column_names == list(table)
    assert np.array_equal(read["p"].to_numpy(), table["p"])
    assert read.schema.field("p").metadata[b"unit"] == b"rad/s"
    with pytest.raises(KeyError, match="there is no column 'q'; expected one of foundation, alpha"):
        table["q"]


def test_a_run_becomes_a_picture(record, tmp_path):
    figure = rb.Block(alpha=0.15, p=2.5).run(record, vertical=record, scale=2).plot()
    assert [len(axes.lines) for axes in figure.axes] == [2, 2, 2]
    figure.savefig(tmp_path / "run.png")


def public():
    for name in rb.__all__:
        value = getattr(rb, name)
        yield name, value
        if inspect.isclass(value):
            yield from ((f"{name}.{member}", getattr(value, member)) for member in vars(value) if member[0] != "_")


@pytest.mark.parametrize("name", [name for name, _ in public()])
def test_everything_public_is_documented(name):
    value = dict(public())[name]
    if callable(value) or isinstance(value, property):
        assert inspect.getdoc(value)


def test_the_examples_in_docstrings_hold():
    found = doctest.DocTestFinder()
    modules = ["_block", "_fmu", "_fragility", "_pulse", "_record", "_run", "_search", "_studies", "_table", "_toml"]
    runner = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE)
    for name in modules:
        for test in found.find(importlib.import_module(f"rocking_block.{name}")):
            runner.run(test)
    assert runner.failures == 0 and runner.tries > 30


def check(*command, cwd=PACKAGE):
    result = subprocess.run([sys.executable, "-m", *command], capture_output=True, text=True, cwd=cwd)
    assert result.returncode == 0, result.stdout + result.stderr


def test_mypy_finds_the_package_and_its_use_well_typed():
    pytest.importorskip("mypy")
    check("mypy", "--strict", "rocking_block", "tests/usage.py")


def test_pyright_finds_the_package_and_its_use_well_typed():
    pytest.importorskip("pyright")
    check("pyright", "--pythonpath", sys.executable, "rocking_block", "tests/usage.py")


def test_the_compiled_part_is_as_its_types_say(tmp_path):
    pytest.importorskip("mypy")
    check("mypy.stubtest", "--ignore-missing-stub", "rocking_block._engine", cwd=tmp_path)
