"""The Functional Mock-up Units included in the package."""

from __future__ import annotations

from pathlib import Path


# The files by version of FMI and body, which the build and the scripts for wheels read here.
FMUS = {
    (2, False): "RockingBlock.fmu",
    (3, False): "RockingBlock-fmi3.fmu",
    (2, True): "RockingBlockInSpace.fmu",
    (3, True): "RockingBlockInSpace-fmi3.fmu",
}


def fmu_path(version: int = 2, in_space: bool = False) -> Path:
    """Returns the path of the FMU for FMI 2.0 or, with `version` = 3, FMI 3.0, with the binary for this platform.

    `in_space` = True gives that of the block in space, shaken in three directions.

    >>> import rocking_block as rb
    >>> rb.fmu_path().name
    'RockingBlock.fmu'
    >>> rb.fmu_path(version=3).name
    'RockingBlock-fmi3.fmu'
    >>> rb.fmu_path(in_space=True).name
    'RockingBlockInSpace.fmu'
    """
    if version not in (2, 3):
        raise ValueError(f"version = {version!r}; expected 2 or 3, for FMI 2.0 or FMI 3.0")
    path = Path(__file__).with_name(FMUS[version, bool(in_space)])
    if not path.exists():
        raise FileNotFoundError(f"{path}: is missing; expected it in the package, where the build puts it")
    return path
