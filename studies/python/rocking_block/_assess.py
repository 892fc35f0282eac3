"""Reports on one object."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from html import escape
from pathlib import Path
from types import MappingProxyType
from typing import Any

from rocking_block import _engine
from rocking_block._words import ticking


@dataclass(frozen=True)
class Assessment:
    """The report on an object; made by `assess`."""

    numbers: Mapping[str, Any]
    """All numbers, in SI units, with the keys of `rocking assess --json`."""
    summary: str
    """The result in a few sentences, a line each."""
    files: Mapping[str, bytes]
    """The page `report.html`, its pictures and its tables by their names."""

    @property
    def html(self) -> str:
        """The page, which needs no other file."""
        return self.files["report.html"].decode()

    def save(self, folder: str | os.PathLike[str]) -> Path:
        """Writes all files into a folder, which is made if it is missing, and returns the path of the page."""
        path = Path(folder)
        path.mkdir(parents=True, exist_ok=True)
        for name, content in self.files.items():
            (path / name).write_bytes(content)
        return path / "report.html"

    def _repr_html_(self) -> str:
        # A frame keeps the styles of the page to itself.
        return f'<iframe srcdoc="{escape(self.html)}" style="width: 100%; height: 40em; border: 0"></iframe>'

    def __repr__(self) -> str:
        """Shows the title and the number of runs."""
        return f"<Assessment of {self.numbers['title']}: {self.numbers['runs']} runs>"


def assess(
    study: str | os.PathLike[str],
    *,
    keep: str | os.PathLike[str] | None = None,
    threads: int | None = None,
    progress: bool | None = None,
) -> Assessment:
    """Assesses one object: fragility, annual rates, variants and sensitivity, as a page with pictures and tables.

    The files have the bytes of `rocking assess`.

    Parameters
    ----------
    study : path
        Study file with a table `[assess]`.
    keep : path, optional
        Folder that keeps the rows of all runs, which is made if it is missing: an interrupted call, or one that changes the title, does not
        repeat them. `rocking assess` keeps its rows in the folder `kept` of the report.
    threads : int, optional
        Number of threads; by default one per core. It changes no bit.
    progress : bool, optional
        Whether to show a tqdm progress bar; by default after a second, if the output is interactive.

    Raises
    ------
    ValueError
        An error in the study, with its line.
    OSError
        The file cannot be read.

    Examples
    --------
    >>> import rocking_block as rb
    >>> report = rb.assess("statue.toml")  # doctest: +SKIP
    >>> report.save("report")  # doctest: +SKIP
    """
    path = Path(study)
    text = path.read_text(encoding="utf-8")
    if keep is not None:
        Path(keep).mkdir(parents=True, exist_ok=True)
    # Another build may step otherwise, so that its rows are not used.
    kept = None if keep is None else (Path(keep), Path(_engine.__file__))
    with ticking(progress) as tick:
        numbers, summary, files = _engine.assess(path.name, text, path.parent, threads, kept, tick)
    return Assessment(MappingProxyType(json.loads(numbers)), summary, MappingProxyType(dict(files)))
