"""The Functional Mock-up Units included in the package."""

from __future__ import annotations

from pathlib import Path


NAMES = {2: "RockingBlock.fmu", 3: "RockingBlock-fmi3.fmu"}


def fmu_path(version: int = 2) -> Path:
    """Returns the path of the FMU for FMI 2.0 or, with `version` = 3, FMI 3.0, with the binary for this platform.

    >>> import rocking_block as rb
    >>> rb.fmu_path().name
    'RockingBlock.fmu'
    >>> rb.fmu_path(version=3).name
    'RockingBlock-fmi3.fmu'
    """
    if version not in NAMES:
        raise ValueError(f"version = {version!r}; expected 2 or 3, for FMI 2.0 or FMI 3.0")
    path = Path(__file__).with_name(NAMES[version])
    if not path.exists():
        raise FileNotFoundError(f"{path}: is missing; expected it in the package, where the build puts it")
    return path
