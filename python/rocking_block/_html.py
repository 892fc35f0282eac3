"""HTML tables of results for notebooks."""

from collections.abc import Iterable, Sequence
from html import escape
from typing import Any

import numpy as np


def html_table(caption: str, headings: Sequence[str], rows: Iterable[Sequence[Any]]) -> str:
    """Returns a table with a caption; numbers have six digits."""
    head = "".join(f"<th>{escape(heading)}</th>" for heading in headings)
    body = "".join("<tr>" + "".join(f"<td>{escape(_text(value))}</td>" for value in row) + "</tr>" for row in rows)
    header = f"<thead><tr>{head}</tr></thead>" if headings else ""
    return f"<div>{escape(caption)}<table>{header}<tbody>{body}</tbody></table></div>"


def _text(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float | np.floating) else str(value)
