"""A dictionary → the text of a study file."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from typing import Any

import numpy as np


def text(study: Mapping[str, Any]) -> str:
    """Returns the study as TOML: a heading per table, a line per value.

    >>> print(text({"study": {"design": "grid"}, "records": ["a.AT2", {"horizontal": "b.csv", "dt": 0.01}]}))
    [study]
    "design" = "grid"
    [[records]]
    "horizontal" = "a.AT2"
    [[records]]
    "horizontal" = "b.csv"
    "dt" = 0.01
    """
    lines: list[str] = []
    for name, value in study.items():
        if isinstance(value, Mapping):
            lines += [f"[{name}]", *_lines(value)]
        elif name == "records":
            for record in [value] if isinstance(value, str | os.PathLike) else value:
                table = record if isinstance(record, Mapping) else {"horizontal": record}
                lines += ["[[records]]", *_lines(table)]
        else:
            raise ValueError(f"{name} = {value!r} in the study; expected a dictionary, as in study, parameters")
    return "\n".join(lines)


def _lines(table: Mapping[str, Any]) -> list[str]:
    return [f"{_quoted(name)} = {_value(name, value)}" for name, value in table.items()]


def _value(name: str, value: Any) -> str:
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, np.ndarray):
        value = value.tolist()
    match value:
        case bool():
            return "true" if value else "false"
        case int() | float():
            return repr(value)
        case str() | os.PathLike():
            return _quoted(os.fspath(value))
        case Mapping():
            return "{ " + ", ".join(_lines(value)) + " }"
        case list() | tuple():
            return "[" + ", ".join(_value(name, item) for item in value) + "]"
        case _:
            raise ValueError(f"{name} = {value!r} in the study; expected numbers, texts, lists or dictionaries")


def _quoted(text: str) -> str:
    # JSON strings are TOML strings, except for one control character that JSON does not escape.
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
