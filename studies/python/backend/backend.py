"""PEP 517 backend: builds the project's FMUs, copies them into the package, and leaves the rest to maturin.

The environment variables ROCKING_BLOCK_FMU and ROCKING_BLOCK_FMI3 name existing FMUs of FMI 2.0 and 3.0 to copy instead, which
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
PROJECT = PACKAGE.parents[1]
# Names of the FMUs, and the variables that name existing ones.
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
    """Builds the FMUs; returns their folder."""
    # The project's build script packs the FMUs into the folder of the build's results.
    cargo = os.environ.get("CARGO", "cargo")
    subprocess.run([cargo, "build", "--release", "--locked", "--package", "rocking-block", "--lib", "--no-default-features", "--features", "fmu"], cwd=PROJECT, check=True)
    metadata = [cargo, "metadata", "--format-version=1", "--no-deps", "--locked"]
    found = json.loads(subprocess.run(metadata, cwd=PROJECT, check=True, capture_output=True).stdout)
    return Path(found["target_directory"], os.environ.get("CARGO_BUILD_TARGET", ""), "release")
