"""Comma-separated values: the one writer of all such files.

Names come from scenes, which a stranger may have written, and a spreadsheet runs a cell that begins like a formula, in
files of a run as in those of a report.
"""

import csv
import io
import re
from collections.abc import Iterable, Sequence
from typing import Any, Final

BEGINS_FORMULA: Final = ("=", "+", "-", "@", "\t", "\r")
"""A cell that begins so is run by some spreadsheets."""
HARMLESS: Final = re.compile(r"[-+]?[\d.,]+([eE][-+]?\d+)?( ?[%°′″µa-zA-Z]+)?")
"""A signed number, with its unit or without."""


def csv_text(rows: Iterable[Sequence[Any]]) -> str:
    r"""Rows of texts as they are, and of numbers with all their digits; None, not known, is an empty cell.

    A text that begins like a formula gets an apostrophe before it, as spreadsheets mark a text.

    >>> csv_text([["=1+1", "-x"], ["-0.5 µm", -1e-05], ["-2e-7", None]])
    "'=1+1,'-x\n-0.5 µm,-1e-05\n-2e-7,\n"
    """
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerows([_unformulated(cell) for cell in row] for row in rows)
    return stream.getvalue()


def _unformulated(cell: Any) -> Any:
    if isinstance(cell, str) and cell.startswith(BEGINS_FORMULA) and not HARMLESS.fullmatch(cell):
        return f"'{cell}"
    return cell
