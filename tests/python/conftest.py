"""Paths of the FMU, the reference trajectories and the records."""

import os
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


def pytest_configure(config):
    config.addinivalue_line("markers", "check: left to scripts/dev/check: other masters, experiments, examples, type checkers")


@pytest.fixture(scope="session")
def fmu():
    path = Path(os.environ.get("ROCKING_BLOCK_FMU", ROOT / "target/release/RockingBlock.fmu"))
    assert path.exists(), f"{path} is missing: cargo build --release makes it"
    return str(path)


@pytest.fixture(scope="session")
def program():
    path = Path(os.environ.get("ROCKING_BLOCK_PROGRAM", ROOT / "target/release/rocking"))
    assert path.exists(), f"{path} is missing: cargo build --release makes it"
    return str(path)


@pytest.fixture(scope="session")
def fmu3():
    path = Path(os.environ.get("ROCKING_BLOCK_FMI3", ROOT / "target/release/RockingBlock-fmi3.fmu"))
    assert path.exists(), f"{path} is missing: cargo build --release makes it"
    return str(path)


@pytest.fixture(scope="session")
def reference():
    return ROOT / "tests/reference"


@pytest.fixture(scope="session")
def rinaldi():
    """Rinaldi 228 in m/s2 every 0.01 s; the record may not be redistributed."""
    path = ROOT.parent / "shared/records/paper/NGA_no_1063_RRS228.AT2"
    if not path.exists():
        pytest.skip(f"the record {path.name} may not be redistributed and is not at hand")
    words = path.read_text().split("\n", 4)[4].split()
    return [9.81 * float(word) for word in words]


def pytest_runtest_logreport(report):
    """Records skipped tests for the end of scripts/test and scripts/dev/check, once where several processes run them."""
    path = os.environ.get("ROCKING_BLOCK_SKIPPED") if "PYTEST_XDIST_WORKER" not in os.environ else None
    if report.skipped and path:
        with open(path, "a") as file:
            reason = report.longrepr[2] if isinstance(report.longrepr, tuple) else report.longrepr
            file.write(f"{report.nodeid}: {reason.removeprefix('Skipped: ')}\n")
