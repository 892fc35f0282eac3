"""The documentation of the package, its examples, and its types."""

import doctest
import importlib
import inspect
import pkgutil
import subprocess
import sys
from pathlib import Path

import pytest

import rocking_block as rb

PACKAGE = Path(__file__).resolve().parents[1]


def public():
    for name in rb.__all__:
        value = getattr(rb, name)
        yield name, value
        if inspect.isclass(value):
            yield from ((f"{name}.{member}", getattr(value, member)) for member in vars(value) if member[0] != "_")


def test_signatures_in_help_are_short():
    """`Union[numpy._typing…]` of expanded aliases filled screens."""
    for name, value in public():
        if callable(value):
            text = str(inspect.signature(value))
            assert len(text) < 1000 and "numpy._typing" not in text and "Union[" not in text, (name, text)
    assert "p: 'npt.ArrayLike'" in str(inspect.signature(rb.spectrum))


@pytest.mark.parametrize("name", [name for name, _ in public()])
def test_everything_public_is_documented(name):
    value = dict(public())[name]
    if callable(value) or isinstance(value, property):
        assert inspect.getdoc(value)


def test_the_examples_in_docstrings_hold():
    found = doctest.DocTestFinder()
    modules = [module.name for module in pkgutil.iter_modules(rb.__path__) if module.name != "_engine"]
    runner = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE)
    for name in modules:
        for test in found.find(importlib.import_module(f"rocking_block.{name}")):
            runner.run(test)
    assert runner.failures == 0 and runner.tries > 30


def check(*command, cwd=PACKAGE):
    result = subprocess.run([sys.executable, "-m", *command], capture_output=True, text=True, cwd=cwd)
    assert result.returncode == 0, result.stdout + result.stderr


@pytest.mark.check
def test_mypy_finds_the_package_and_its_use_well_typed():
    pytest.importorskip("mypy")
    check("mypy", "--strict", "rocking_block", "tests/usage.py")


@pytest.mark.check
def test_pyright_finds_the_package_and_its_use_well_typed():
    pytest.importorskip("pyright")
    check("pyright", "--pythonpath", sys.executable, "rocking_block", "tests/usage.py")


@pytest.mark.check
def test_the_compiled_part_is_as_its_types_say(tmp_path):
    pytest.importorskip("mypy")
    check("mypy.stubtest", "--ignore-missing-stub", "rocking_block._engine", cwd=tmp_path)
