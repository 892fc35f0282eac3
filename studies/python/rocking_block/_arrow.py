"""Columns of Arrow → arrays of NumPy."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt


def arrow_values(column: Any) -> npt.NDArray[Any]:
    """Returns the values of a column of Arrow; missing numbers are nan, and missing texts empty.

    Numbers and texts come from their buffers, since pyarrow's own conversion imports pandas and its 50 MB.
    """
    from pyarrow import types

    kind = column.type.value_type if types.is_dictionary(column.type) else column.type
    if types.is_string(kind) or types.is_large_string(kind):
        encoded = column if types.is_dictionary(column.type) else column.dictionary_encode()
        chunks = [_words(chunk) for chunk in encoded.chunks] or [np.empty(0, dtype=np.str_)]
    elif (types.is_integer(kind) or types.is_floating(kind)) and kind == column.type:
        chunks = [_numbers(chunk) for chunk in column.chunks] or [np.empty(0, dtype=_dtype(kind))]
    else:
        return np.asarray(column.cast(kind).to_numpy())
    return chunks[0] if len(chunks) == 1 else np.concatenate(chunks)


def _words(chunk: Any) -> npt.NDArray[Any]:
    words: npt.NDArray[Any] = np.array([*chunk.dictionary.to_pylist(), ""], dtype=np.str_)
    positions: npt.NDArray[np.intp] = np.nan_to_num(_numbers(chunk.indices), nan=len(words) - 1).astype(np.intp)
    return words[positions]


def _numbers(chunk: Any) -> npt.NDArray[Any]:
    known, content = chunk.buffers()
    place = slice(chunk.offset, chunk.offset + len(chunk))
    values = np.frombuffer(content or b"", dtype=_dtype(chunk.type))[place]
    if chunk.null_count == 0:
        return values
    return np.where(np.unpackbits(np.frombuffer(known, dtype=np.uint8), bitorder="little")[place], values, np.nan)


def _dtype(kind: Any) -> np.dtype[Any]:
    from pyarrow import types

    letter = "f" if types.is_floating(kind) else "u" if types.is_unsigned_integer(kind) else "i"
    return np.dtype(f"{letter}{kind.bit_width // 8}")
