"""PEP 517 backend: builds the project's FMUs, copies them into the package, and leaves the rest to maturin.

The environment variable ROCKING_BLOCK_FMUS names a folder with existing FMUs to copy instead, which may hold binaries for other
platforms too.
"""

import json
import os
import runpy
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
# The names of the FMUs, from the module that finds them in the package.
FMUS = runpy.run_path(str(PACKAGE / "rocking_block/_fmu.py"))["FMUS"].values()


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    place_fmus()
    return maturin.build_wheel(wheel_directory, config_settings, metadata_directory)


def build_editable(wheel_directory, config_settings=None, metadata_directory=None):
    place_fmus()
    return maturin.build_editable(wheel_directory, config_settings, metadata_directory)


def place_fmus():
    given = os.environ.get("ROCKING_BLOCK_FMUS")
    folder = Path(given) if given else make_fmus()
    for name in FMUS:
        shutil.copyfile(folder / name, PACKAGE / "rocking_block" / name)


def make_fmus() -> Path:
    """Builds the FMUs; returns their folder."""
    # The project's build script packs the FMUs into the folder of the build's results.
    cargo = os.environ.get("CARGO", "cargo")
    subprocess.run([cargo, "build", "--release", "--locked", "--package", "rocking-block", "--lib", "--no-default-features", "--features", "fmu"], cwd=PROJECT, check=True)
    metadata = [cargo, "metadata", "--format-version=1", "--no-deps", "--locked"]
    found = json.loads(subprocess.run(metadata, cwd=PROJECT, check=True, capture_output=True).stdout)
    return Path(found["target_directory"], os.environ.get("CARGO_BUILD_TARGET", ""), "release")
