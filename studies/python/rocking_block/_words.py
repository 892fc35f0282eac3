"""Words of options, optional packages, and progress bars."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, Literal, get_args

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]

# Parameters of a block that every table of outcomes has.
OF_EVERY_BLOCK = ("alpha", "p", "eta", "xi_v", "epsilon", "restitution_factor")

Foundation = Literal["viscoelastic", "rigid"]
Shape = Literal[
    "one-sine", "one-cosine", "c1", "c2", "half-sine", "rectangular", "symmetric-ricker", "antisymmetric-ricker", "gabor"
]
FittedShape = Literal["gabor", "one-sine", "one-cosine", "c1", "c2", "symmetric-ricker", "antisymmetric-ricker"]
OnSeparation = Literal["terminate", "hold", "fly"]
OnOverturning = Literal["terminate", "hold"]
Polarity = Literal["as-recorded", "both"]
Outcome = Literal["completed", "overturned", "separated", "undecided", "failed"]


def chosen(name: str, found: object, words: tuple[str, ...]) -> str:
    """Returns the chosen word, ignoring case, hyphens and underscores. The error lists the words."""
    for word in words:
        if isinstance(found, str) and _normalized(found) == _normalized(word):
            return word
    shown = f'"{found}"' if isinstance(found, str) else repr(found)
    raise ValueError(f"{name} = {shown}; expected one of " + ", ".join(f'"{word}"' for word in words))


def _normalized(word: str) -> str:
    return word.lower().replace("-", "").replace("_", "")


def number(name: str, value: Any) -> float:
    """Returns a number as a float. Strings and lists are errors that name the argument."""
    try:
        if not isinstance(value, str | bytes):
            return float(value)
    except (TypeError, ValueError):
        pass
    raise TypeError(f"{name} = {value!r}; expected a number")


def run_options(
    tolerance: float,
    on_separation: OnSeparation,
    on_overturning: OnOverturning = "terminate",
    duration: float | None = None,
    step: float | None = None,
) -> dict[str, Any]:
    """Returns the run options in the engine's form."""
    return {
        "tolerance": number("tolerance", tolerance),
        "on_separation": chosen("on_separation", on_separation, get_args(OnSeparation)),
        "on_overturning": chosen("on_overturning", on_overturning, get_args(OnOverturning)),
        "duration": None if duration is None else number("duration", duration),
        "step": None if step is None else number("step", step),
    }


@contextmanager
def optional(feature: str, package: str) -> Iterator[None]:
    """Explains how to install a package that an import in the block does not find."""
    try:
        yield
    except ModuleNotFoundError as error:
        # If an installed package lacks one of its own dependencies, its message says more.
        if error.name is None or error.name.partition(".")[0] != package:
            raise
        message = f"{feature} needs {package}; python -m pip install {package}"
        raise ModuleNotFoundError(message, name=error.name, path=error.path) from None


@contextmanager
def ticking(progress: bool | None) -> Iterator[Callable[[int, int], object]]:
    """Yields a callback that takes the amount of work done and the total, and shows a tqdm bar.

    By default the bar appears after a second's work, if tqdm is installed and the output is interactive; with True it
    always appears, with False never.
    """
    if progress is False:
        yield lambda done, total: None
        return
    try:
        with warnings.catch_warnings():
            # Without ipywidgets a notebook shows text bars.
            warnings.simplefilter("ignore")
            from tqdm.auto import tqdm
    except ImportError:
        if progress:
            raise
        yield lambda done, total: None
        return
    seen = progress or "ipykernel" in sys.modules or sys.stderr.isatty()
    bar: Any = tqdm(delay=0 if progress else 1, leave=False, disable=not seen)

    def tick(done: int, total: int) -> None:
        bar.total = total
        bar.update(done - bar.n)

    try:
        yield tick
    finally:
        bar.close()


def is_url(path: str) -> bool:
    return "://" in path
