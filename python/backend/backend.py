"""PEP 517: makes the project's FMU, puts it into the package, and leaves the rest to maturin.

With ROCKING_BLOCK_FMU in the environment that file is taken instead, which may hold binaries for other platforms too.
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


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    place_fmu()
    return maturin.build_wheel(wheel_directory, config_settings, metadata_directory)


def build_editable(wheel_directory, config_settings=None, metadata_directory=None):
    place_fmu()
    return maturin.build_editable(wheel_directory, config_settings, metadata_directory)


def place_fmu():
    given = os.environ.get("ROCKING_BLOCK_FMU")
    shutil.copyfile(given or make_fmu(), PACKAGE / "rocking_block/RockingBlock.fmu")


def make_fmu() -> Path:
    # The build script of the project packs the FMU beside what cargo was asked for.
    cargo = os.environ.get("CARGO", "cargo")
    subprocess.run([cargo, "build", "--release", "--locked", "--lib", "--no-default-features", "--features", "fmu"], cwd=PROJECT, check=True)
    metadata = [cargo, "metadata", "--format-version=1", "--no-deps", "--locked"]
    found = json.loads(subprocess.run(metadata, cwd=PROJECT, check=True, capture_output=True).stdout)
    return Path(found["target_directory"], os.environ.get("CARGO_BUILD_TARGET", ""), "release/RockingBlock.fmu")
