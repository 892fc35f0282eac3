"""Reports on one object, and the order of several."""

from __future__ import annotations

import json
import os
import warnings
from collections.abc import Iterable, Mapping
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
        return _save(folder, self.files) / "report.html"

    def _repr_html_(self) -> str:
        return _frame(self.html)

    def __repr__(self) -> str:
        """Shows the title and the number of runs."""
        return f"<Assessment of {self.numbers['title']}: {self.numbers['runs']} runs>"


@dataclass(frozen=True)
class Portfolio:
    """Objects of one site in the order of their annual rates; made by `portfolio`."""

    numbers: Mapping[str, Any]
    """All numbers, in SI units, with the keys of `rocking portfolio --json`: `objects` in their order, `refused` studies."""
    summary: str
    """The result in a few sentences, and a line for each object."""
    files: Mapping[str, bytes]
    """The page `portfolio.html` and its table `portfolio.csv`."""
    reports: Mapping[str, Assessment]
    """The report on each object, by the name of its study file without `.toml`."""

    @property
    def html(self) -> str:
        """The page. Its links are those of the files that `save` writes."""
        return self.files["portfolio.html"].decode()

    def save(self, folder: str | os.PathLike[str]) -> Path:
        """Writes all files into a folder, those of each object into one of its own, and returns the path of the page."""
        for name, report in self.reports.items():
            report.save(Path(folder) / name)
        return _save(folder, self.files) / "portfolio.html"

    def _repr_html_(self) -> str:
        return _frame(self.html)

    def __repr__(self) -> str:
        """Shows the number of objects, and the first one with its rate."""
        objects = self.numbers["objects"]
        first = f", first {objects[0]['title']}" if objects and objects[0]["rank"] else ""
        return f"<Portfolio of {len(objects)} objects{first}>"


def _save(folder: str | os.PathLike[str], files: Mapping[str, bytes]) -> Path:
    path = Path(folder)
    path.mkdir(parents=True, exist_ok=True)
    for name, content in files.items():
        (path / name).write_bytes(content)
    return path


def _frame(page: str) -> str:
    # A frame keeps the styles of the page to itself.
    return f'<iframe srcdoc="{escape(page)}" style="width: 100%; height: 40em; border: 0"></iframe>'


def _assessment(report: tuple[str, str, list[tuple[str, bytes]]]) -> Assessment:
    numbers, summary, files = report
    return Assessment(MappingProxyType(json.loads(numbers)), summary, MappingProxyType(dict(files)))


def _kept(keep: str | os.PathLike[str] | None) -> tuple[Path, Path] | None:
    """The folder of kept rows, and the library: another build may step otherwise, so that its rows are not used."""
    if keep is None:
        return None
    Path(keep).mkdir(parents=True, exist_ok=True)
    return Path(keep), Path(_engine.__file__)


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
    kept = _kept(keep)
    with ticking(progress) as tick:
        return _assessment(_engine.assess(path.name, text, path.parent, threads, kept, tick))


def portfolio(
    studies: str | os.PathLike[str] | Iterable[str | os.PathLike[str]],
    *,
    keep: str | os.PathLike[str] | None = None,
    threads: int | None = None,
    progress: bool | None = None,
) -> Portfolio:
    """Assesses several objects of one site and ranks them by annual rate.

    The files have the bytes of `rocking portfolio`. A study with an error is left out with a warning.

    Parameters
    ----------
    studies : path or paths
        Study files with a table `[assess]`, or folders with such files, of one object each. They have one hazard.
    keep : path, optional
        Folder that keeps the rows of all runs, as that of `assess`, in a folder for each object. That of `rocking portfolio` is the folder of
        its pages.
    threads : int, optional
        Number of threads; by default one per core. It changes no bit.
    progress : bool, optional
        Whether to show a tqdm progress bar; by default after a second, if the output is interactive.

    Raises
    ------
    ValueError
        No study without an error, two objects of one name, or hazards or years that differ.

    Examples
    --------
    >>> import rocking_block as rb
    >>> found = rb.portfolio("museum")  # doctest: +SKIP
    >>> [(object["title"], object["state"]["rate"]["rate"]) for object in found.numbers["objects"]]  # doctest: +SKIP
    >>> found.save("portfolio")  # doctest: +SKIP
    """
    paths = [studies] if isinstance(studies, str | os.PathLike) else list(studies)
    kept = _kept(keep)
    with ticking(progress) as tick:
        (numbers, summary, files), reports = _engine.portfolio([Path(path) for path in paths], threads, kept, tick)
    found = json.loads(numbers)
    for refused in found["refused"]:
        warnings.warn(f"not assessed: {refused['reason']}", stacklevel=2)
    of_objects = {name: _assessment(report) for name, report in reports}
    return Portfolio(MappingProxyType(found), summary, MappingProxyType(dict(files)), MappingProxyType(of_objects))
