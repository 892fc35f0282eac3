"""PEP 517: makes the project's FMUs, puts them into the package, and leaves the rest to maturin.

With ROCKING_BLOCK_FMU and ROCKING_BLOCK_FMI3 in the environment these files, of FMI 2.0 and of FMI 3.0, are taken instead, which
may hold binaries for other platforms too.
"""

import json
import os
import shutil
import subprocess
from pathlib import Path

import maturin
from maturin import (  # noqa: F401 - hooks
    build_sdist,
    get_requires_for_build_editable,
    get_requires_for_build_sdist,
    get_requires_for_build_wheel,
    prepare_metadata_for_build_editable,
    prepare_metadata_for_build_wheel,
)

PACKAGE = Path(__file__).resolve().parents[1]
PROJECT = PACKAGE.parent
# Their names, and the variables that say where others are.
FMUS = {"RockingBlock.fmu": "ROCKING_BLOCK_FMU", "RockingBlock-fmi3.fmu": "ROCKING_BLOCK_FMI3"}


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    place_fmus()
    return maturin.build_wheel(wheel_directory, config_settings, metadata_directory)


def build_editable(wheel_directory, config_settings=None, metadata_directory=None):
    place_fmus()
    return maturin.build_editable(wheel_directory, config_settings, metadata_directory)


def place_fmus():
    given = {name: os.environ.get(variable) for name, variable in FMUS.items()}
    made = make_fmus() if None in given.values() else Path()
    for name, there in given.items():
        shutil.copyfile(there or made / name, PACKAGE / "rocking_block" / name)


def make_fmus() -> Path:
    """The folder in which they are."""
    # The build script of the project packs the FMUs beside what cargo was asked for.
    cargo = os.environ.get("CARGO", "cargo")
    subprocess.run([cargo, "build", "--release", "--locked", "--package", "rocking-block", "--lib", "--no-default-features", "--features", "fmu"], cwd=PROJECT, check=True)
    metadata = [cargo, "metadata", "--format-version=1", "--no-deps", "--locked"]
    found = json.loads(subprocess.run(metadata, cwd=PROJECT, check=True, capture_output=True).stdout)
    return Path(found["target_directory"], os.environ.get("CARGO_BUILD_TARGET", ""), "release")
