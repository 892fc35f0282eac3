"""HTML tables of results for notebooks."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from html import escape
from typing import Any

import numpy as np


# Longer names of files would fill several lines of a row.
_LONGEST_NAME = 28


def html_table(caption: str, headings: Sequence[str], rows: Iterable[Sequence[Any]], files: Collection[str] = ()) -> str:
    """Returns a table with a caption; numbers have six digits. Columns of `files` show the ends of their names."""
    head = "".join(f"<th>{escape(heading)}</th>" for heading in headings)
    is_file = [heading in files for heading in headings]
    body = "".join(f"<tr>{''.join(map(_cell, row, is_file or [False] * len(row)))}</tr>" for row in rows)
    header = f"<thead><tr>{head}</tr></thead>" if headings else ""
    return f"<div>{escape(caption)}<table>{header}<tbody>{body}</tbody></table></div>"


def _cell(value: Any, is_file: bool) -> str:
    text = _text(value)
    name = text.replace("\\", "/").rpartition("/")[2] if is_file else text
    name = f"…{name[1 - _LONGEST_NAME:]}" if is_file and len(name) > _LONGEST_NAME else name
    return f"<td>{escape(text)}</td>" if name == text else f'<td title="{escape(text)}">{escape(name)}</td>'


def _text(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float | np.floating) else str(value)
