"""Measured values that scenes name: CSV files with a header row, whole in memory, each cell with its line.

Commas or semicolons stand between the cells. Numbers have decimal points, or decimal commas where these separate no
cells.
"""

import csv
import io
import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final

from tol3d.errors import Problem, SceneError
from tol3d.files import FileContent
from tol3d.units import BARE_NUMBER

if TYPE_CHECKING:
    from _csv import Reader

DECIMAL_COMMA: Final = re.compile(r"[+-]?\d*,\d+(?:[eE][+-]?\d+)?")
THOUSANDS: Final = re.compile(r"[+-]?[1-9]\d{0,2},\d{3}")
NUMBER_WORDS: Final = "a number such as 4.5"
COMMA_HINT: Final = "where numbers have decimal commas, put semicolons between the cells"
LONGEST_SHOWN: Final = 60  # characters of a cell


@dataclass(frozen=True)
class Cell:
    """A cell of a file: its line, counted from 1, and its text."""

    line: int
    text: str

    @property
    def shown(self) -> str:
        """Text of it for a message."""
        if not self.text:
            return "an empty cell"
        return repr(self.text if len(self.text) <= LONGEST_SHOWN else self.text[: LONGEST_SHOWN - 3] + "…")


@dataclass(frozen=True)
class Column:
    """A column of a file.

    Args:
        path: the file.
        name: as its header has it.
        cells: of all rows that are not blank.
        commas: whether a comma in a number may be a decimal one: not where it separates cells.
        sure: whether it can be nothing else; 1,234 alone may be a thousand.
    """

    path: Path
    name: str
    cells: Sequence[Cell]
    commas: bool
    sure: bool

    def numbers(self) -> list[float]:
        """Its numbers, with decimal points or with decimal commas.

        Raises:
            SceneError: a cell is no number; the text names file and line.
        """
        with_comma = [cell for cell in self.cells if "," in cell.text and DECIMAL_COMMA.fullmatch(cell.text)]
        if not with_comma:
            return [self._number(cell, cell.text) for cell in self.cells]
        first = with_comma[0]
        if not self.commas:
            raise self.refused(first, NUMBER_WORDS, f"; {COMMA_HINT}")
        if point := next((cell for cell in self.cells if "." in cell.text), None):
            raise self.refused(point, f"decimal commas as in line {first.line}, or none in all of the column")
        if not self.sure and all(THOUSANDS.fullmatch(cell.text) for cell in with_comma):
            raise self.refused(first, NUMBER_WORDS, ", which may be a thousand: write a decimal point, or no comma")
        return [self._number(cell, cell.text.replace(",", ".")) for cell in self.cells]

    def _number(self, cell: Cell, text: str) -> float:
        number = float(text) if BARE_NUMBER.fullmatch(text) else math.nan
        if not math.isfinite(number):
            raise self.refused(cell, NUMBER_WORDS)
        return number

    def refused(self, cell: Cell, expected: str, hint: str = "") -> SceneError:
        """The error that names a cell of it."""
        words = f"expected {expected}, got {cell.shown}{hint}"
        return SceneError(Problem.at(self.path, words, line=cell.line, path=f"column {self.name!r}"))


@dataclass(frozen=True)
class CsvTable:
    """The content of a CSV file.

    Args:
        path: the file.
        header_line: counted from 1.
        names: of its columns, as the header has them.
        rows: that are not blank, each with its line; cells beyond the header are empty.
        separator: between cells.
    """

    path: Path
    header_line: int
    names: tuple[str, ...]
    rows: Sequence[tuple[int, Sequence[str]]]
    separator: str

    def column(self, name: str) -> Column:
        """The column of a name.

        Raises:
            SceneError: none or two have it, or a row has more cells than the header; the text names file and line.
        """
        if self.names.count(name.strip()) != 1:
            raise self.refused_header(f"one column named {name!r}")
        alone, index = len(self.names) == 1, self.names.index(name.strip())
        cells: list[Cell] = []
        for line, row in self.rows:
            if alone:  # a comma in it separates nothing
                row = [self.separator.join(row)]
            elif any(cell.strip() for cell in row[len(self.names) :]):
                hint = f"; {COMMA_HINT}" if self.separator == "," else ""
                words = f"expected {len(self.names)} cells, as in the header, got {len(row)}{hint}"
                raise SceneError(Problem.at(self.path, words, line=line))
            cells.append(Cell(line, row[index].strip() if index < len(row) else ""))
        return Column(self.path, name, cells, self.separator == ";" or alone, self.separator == ";")

    def refused_header(self, expected: str) -> SceneError:
        """The error that names the header."""
        found = ", ".join(repr(name) for name in self.names) or "an empty file"
        return SceneError(
            Problem.at(self.path, f"expected {expected} in the header, got {found}", line=self.header_line)
        )


def csv_table(file: FileContent) -> CsvTable:
    """Read a CSV file.

    Raises:
        SceneError: it is none, or not in UTF-8; the text names file and line.
    """
    text = _text(file)
    separator = ";" if ";" in text.lstrip().partition("\n")[0] else ","
    rows = list(_rows(file, csv.reader(io.StringIO(text, newline=""), delimiter=separator, strict=True)))
    header_line, header = rows[0] if rows else (1, [])
    return CsvTable(file.path, header_line, tuple(name.strip() for name in header), rows[1:], separator)


def _rows(file: FileContent, reader: "Reader") -> Iterator[tuple[int, list[str]]]:
    try:
        for row in reader:
            if any(cell.strip() for cell in row):
                yield reader.line_num, row
    except csv.Error as error:
        words = f"expected comma-separated values, got {error}"
        raise SceneError(Problem.at(file.path, words, line=reader.line_num)) from None


def _text(file: FileContent) -> str:
    try:
        return file.content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = file.content[: error.start].count(b"\n") + 1
        raise SceneError(Problem.at(file.path, "expected UTF-8 text, got a byte that is none", line=line)) from None
