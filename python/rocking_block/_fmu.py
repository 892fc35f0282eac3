"""The Functional Mock-up Unit that comes with the package."""

from pathlib import Path


def fmu_path() -> Path:
    """The path of `RockingBlock.fmu` (FMI 2.0), with the binary for this platform.

    >>> import rocking_block as rb
    >>> rb.fmu_path().name
    'RockingBlock.fmu'
    """
    path = Path(__file__).with_name("RockingBlock.fmu")
    if not path.exists():
        raise FileNotFoundError(f"{path}: is missing; expected it in the package, where its build puts it")
    return path
