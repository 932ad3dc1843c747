"""Tables as a command prints them, for notebooks and scripts: text, HTML, CSV and frames of pandas."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final

from tol3d import report
from tol3d.errors import unwritable
from tol3d.report.page import Page, Table
from tol3d.report.sheet import as_text
from tol3d.study.runs.frame import frame_of_rows

if TYPE_CHECKING:
    from tol3d.study.runs.frame import DataFrame

TEXT_WIDTH: Final = 120  # columns of a table as text, as wide as a notebook's cell
WHOLE_NUMBER: Final = re.compile(r"\d{1,15}")
MEASURE: Final = "measure"
LABEL: Final = "name"
REMARK: Final = "remark"
"""Headings of frames where a table has none."""


@dataclass(frozen=True, repr=False)
class Report:
    """Tables as a command shows them; `str()` is their text.

    Args:
        page: its lines and tables, as plain data.
    """

    page: Page

    def __str__(self) -> str:
        return as_text(self.page, TEXT_WIDTH)

    def __repr__(self) -> str:
        return str(self)

    def _repr_html_(self) -> str:
        """Its lines and tables, for notebooks."""
        return report.page_html(self.page)

    def csv(self) -> str:
        """Its tables as comma-separated values."""
        return self.page.csv()

    def to_csv(self, path: Path | str | None = None) -> str | None:
        """Its tables as comma-separated values, written to a file, or returned if none is named.

        Raises:
            InputError: the file cannot be written.
        """
        if path is None:
            return self.csv()
        try:
            Path(path).write_text(self.csv(), encoding="utf-8")
        except OSError as error:
            raise unwritable(Path(path), error, "choose another file") from None
        return None

    @property
    def frames(self) -> "Mapping[str, DataFrame]":
        """Its tables as frames of pandas, by their titles; of equal titles the later ones are numbered.

        Raises:
            MissingPackageError: pandas is not installed.
        """
        found: dict[str, DataFrame] = {}
        for title, table in self.page.titled():
            number = sum(title == name.rpartition(" #")[0] for name in found) + 2
            found[f"{title} #{number}" if title in found else title] = stacked({"": table})
        return found

    def __rich__(self) -> Page:
        return self.page


@dataclass(frozen=True, repr=False)
class Picture:
    """A picture that was drawn, shown inline by notebooks.

    Args:
        path: its place; None for a window that was closed again.
        notes: remarks for the user, such as the magnification in use.
    """

    path: Path | None
    notes: tuple[str, ...] = ()

    def __repr__(self) -> str:
        return "\n".join((f"<Picture {str(self.path)!r}>", *self.notes))

    def _repr_png_(self) -> bytes | None:
        """Its bytes, for notebooks."""
        return self.path.read_bytes() if self.path and self.path.suffix.lower() == ".png" else None


def stacked(tables: Mapping[str, Table]) -> "DataFrame":
    """Tables below each other as a DataFrame.

    Args:
        tables: by the measure that stands in the first column of their rows; "" for no such column.

    Raises:
        MissingPackageError: pandas is not installed.
    """
    headings, rows = list[str](), list[dict[str, str | float | None]]()
    for title, table in tables.items():
        (corner, *heads), *lines = table.cells()
        named = [str(corner) or LABEL, *(str(head) or REMARK for head in heads)]
        first: dict[str, str | float | None] = {MEASURE: title} if title else {}
        headings += [own for own in (*first, *named) if own not in headings]
        rows += [first | {own: _cell(cell) for own, cell in zip(named, line, strict=True)} for line in lines]
    return frame_of_rows(headings, [[row.get(heading) for heading in headings] for row in rows])


def _cell(cell: str | float) -> str | float | None:
    if isinstance(cell, str):
        return None if cell in ("", "–") else int(cell) if WHOLE_NUMBER.fullmatch(cell) else cell
    return cell
