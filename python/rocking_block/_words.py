"""Words of options, and how long work shows how far it is."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]

Foundation = Literal["viscoelastic", "rigid"]
Shape = Literal["one-sine", "one-cosine", "C1", "C2"]
OnSeparation = Literal["terminate", "hold", "fly"]
OnOverturning = Literal["terminate", "hold"]
Outcome = Literal["completed", "overturned", "separated", "failed"]


@contextmanager
def ticking(progress: bool | None) -> Iterator[Callable[[int, int], object]]:
    """What long work calls with how much of it is done and how much there is: a bar of tqdm after a second's work, where
    tqdm is installed and somebody looks at it; with True in any case, with False in none."""
    if progress is False:
        yield lambda done, total: None
        return
    try:
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
