"""Paths of the program and the records, and a reader of the program's tables."""

import json
import os
import subprocess
import sys
from csv import reader
from pathlib import Path

import numpy as np
import pytest

import rocking_block as rb

ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tests/python"))
RECORDS = {name: ROOT / "examples/records" / name for name in ("np01002p_4225a_a.smc", "0111a.smc")}


def pytest_configure(config):
    config.addinivalue_line("markers", "check: left to scripts/dev/check: other masters, experiments, examples, type checkers")


@pytest.fixture(scope="session")
def rocking(tmp_path_factory):
    """Runs the program with some options; returns the columns of its table as text."""
    program = Path(os.environ.get("ROCKING", ROOT / "target/release/rocking"))
    assert program.exists(), f"{program} is missing: cargo build --release makes it"

    def run(*options, csv=None):
        path = csv or tmp_path_factory.mktemp("rocking") / "table.csv"
        subprocess.run([program, *map(str, options), "--csv", path], check=True, capture_output=True, text=True)
        rows = list(reader(line for line in path.read_text().splitlines() if not line.startswith("#")))
        return {name: list(column) for name, column in zip(rows[0], zip(*rows[1:]))}

    def json_of(*options):
        command = [program, *map(str, options), "--json"]
        return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)

    run.json = json_of
    run.program = program
    return run


@pytest.fixture(autouse=True)
def no_figures():
    """Pictures of the same kind share axes, but not those of other tests."""
    yield
    if "matplotlib.pyplot" in sys.modules:
        sys.modules["matplotlib.pyplot"].close("all")


@pytest.fixture(scope="session")
def path():
    """An embedded record of the Loma Prieta earthquake of 1989."""
    return RECORDS["np01002p_4225a_a.smc"]


@pytest.fixture(scope="session")
def record(path):
    return rb.read_record(path)


def numbers(column):
    """Returns numbers of the program's table; an empty field is nan."""
    return np.array([float(field) if field else np.nan for field in column])


def same(values, column):
    """Returns true if two columns have the same bits, except for the sign of nan."""
    return np.array_equal(np.asarray(values, dtype=float), numbers(column), equal_nan=True)


def pytest_runtest_logreport(report):
    """Records skipped tests for the end of scripts/test and scripts/dev/check."""
    path = os.environ.get("ROCKING_BLOCK_SKIPPED")
    if report.skipped and path:
        with open(path, "a") as file:
            reason = report.longrepr[2] if isinstance(report.longrepr, tuple) else report.longrepr
            file.write(f"{report.nodeid}: {reason.removeprefix('Skipped: ')}\n")
