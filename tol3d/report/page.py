"""Output of a command as plain data: lines of text and tables. `sheet.py` lays it out for a terminal."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from importlib import import_module
from typing import TYPE_CHECKING

from tol3d.study.runs.csv_text import csv_text

if TYPE_CHECKING:
    from rich.console import RenderableType

MOST_TEXTS = 20  # warnings below each other

TITLE = "bold cyan"  # style of titles

Style = str
"""Terminal style: "bold", "dim", "red" ..., "" for none."""


class Shown(str):
    """The text of a cell that shows a number, and that number in the unit of its row."""

    value: float | None

    def __new__(cls, text: str, value: float | None) -> "Shown":
        """A text with the number that it shows."""
        shown = super().__new__(cls, text)
        shown.value = value
        return shown


@dataclass(frozen=True)
class Heading:
    """Head of a column; words stand left and wrap, numbers right and whole.

    In a narrow terminal a column that may stand `below` becomes a line below the table for each row that has a cell
    there, and an optional one is left out. Numbers below a plain one have no unit, whatever their rows have. Pages show
    its meaning, a sentence, where the pointer rests on it.
    """

    text: str
    style: Style = ""
    words: bool = False
    optional: bool = False
    plain: bool = False
    below: bool = False
    meaning: str = ""


@dataclass(frozen=True)
class Row:
    """A line of a table: its label, a cell for each heading, and the unit of the numbers that cells show."""

    label: str
    cells: Sequence[str]
    style: Style = ""
    unit: str = ""


@dataclass(frozen=True)
class Further:
    """Rows that are left out where a table is shown: the row that stands for them, and what makes them for files."""

    row: Row
    rows: Callable[[], Sequence[Row]]


@dataclass(frozen=True)
class Table:
    """A column of labels and one for each heading.

    Args:
        corner: head of the labels.
        headings, rows: as they are.
        repeated: so many columns stand beside the labels in every part of a table that finds no room.
        further: what is left out behind the rows; None for nothing.
    """

    corner: str
    headings: Sequence[Heading]
    rows: Sequence[Row]
    repeated: int = 0
    further: Further | None = None

    @property
    def shown(self) -> "Table":
        """The table as it is shown, with one row for those that are left out."""
        return self if self.further is None else replace(self, rows=[*self.rows, self.further.row], further=None)

    def shortened(self, most: int) -> "Table":
        """The table with its first rows alone, where there are more than `most` and none is left out yet."""
        left = len(self.rows) - most
        if left <= 0 or self.further is not None:
            return self
        row = Row(f"and {left} more", [""] * len(self.headings), "dim")
        return replace(self, rows=self.rows[:most], further=Further(row, lambda: self.rows[most:]))

    def cells(self) -> list[list[str | float]]:
        """The headings, then all rows: texts as they are shown, numbers with all their digits; "" for one not known."""
        rows = self.rows if self.further is None else [*self.rows, *self.further.rows()]
        units = [[row.unit] for row in rows] if any(row.unit for row in rows) else [[]] * len(rows)
        head: list[str | float] = [
            self.corner,
            *(["unit"] if any(units) else []),
            *(heading.text for heading in self.headings),
        ]
        cells = ([row.label.strip(), *unit, *map(_csv_cell, row.cells)] for row, unit in zip(rows, units, strict=True))
        return [head, *cells]

    def csv(self) -> str:
        """Its cells as comma-separated values."""
        return csv_text(self.cells())

    def __rich__(self) -> "RenderableType":
        return _rendered(self)


@dataclass(frozen=True)
class Line:
    """Text in pieces, each with its style; `note` sets it in by a blank, wrapped lines too.

    It may stand for lines and tables that are left out, which `stands_for` makes for files.
    """

    pieces: tuple[tuple[str, Style], ...]
    note: bool = False
    stands_for: "Callable[[], Sequence[PageItem]] | None" = None

    def __str__(self) -> str:
        return "".join(text for text, _ in self.pieces)

    @property
    def title(self) -> str:
        """Its words as a title of a section, without those beside it; "" where it is none."""
        return "".join(text for text, style in self.pieces if style == TITLE).strip()

    def __rich__(self) -> "RenderableType":
        return _rendered(self)


@dataclass(frozen=True)
class Branch:
    """A node of a tree: its text, and what hangs on it."""

    text: str
    branches: "tuple[Branch, ...]" = ()

    def __rich__(self) -> "RenderableType":
        return _rendered(self)


PageItem = Line | Table | Branch


@dataclass(frozen=True)
class Page:
    """Lines and tables below each other."""

    blocks: tuple[PageItem, ...]

    @property
    def tables(self) -> tuple[Table, ...]:
        """Its tables."""
        return tuple(block for block in self.blocks if isinstance(block, Table))

    def csv(self) -> str:
        """Its tables as comma-separated values, each below its title, with an empty line between them."""
        return "\n".join(f"{title}\n{table.csv()}" if title else table.csv() for title, table in self.titled())

    @property
    def is_whole(self) -> bool:
        """True if nothing is left out where it is shown."""
        return not any(
            block.further if isinstance(block, Table) else isinstance(block, Line) and block.stands_for
            for block in self.blocks
        )

    def titled(self) -> Iterator[tuple[str, Table]]:
        """Its tables, also those that are left out where it is shown, each with the title above it; "" for none."""
        title = ""
        for block in self.whole_blocks():
            if isinstance(block, Table):
                yield title, block
                title = ""
            elif isinstance(block, Line) and any("bold" in style for _, style in block.pieces):
                title = str(block).strip()

    def whole_blocks(self) -> "Iterator[PageItem]":
        """Its blocks, and those that are left out where it is shown."""
        for block in self.blocks:
            yield block
            if isinstance(block, Line) and block.stands_for is not None:
                yield from block.stands_for()

    def __rich__(self) -> "RenderableType":
        return _rendered(self)


def page(*blocks: PageItem) -> Page:
    """Blocks as a page."""
    return Page(blocks)


def line(text: str, style: Style = "") -> Line:
    """A line in one style."""
    return Line(((text, style),))


BLANK = line("")


def title(text: str, more: str = "") -> Line:
    """The title of a section, and words beside it; a blank line stands above it."""
    return Line((("\n", ""), (text, TITLE), (more, "dim")) if more else (("\n", ""), (text, TITLE)))


def note(text: str) -> Line:
    """A line below a table."""
    return Line(((text, "dim"),), note=True)


def warning(text: str) -> Line:
    """Line that warns of something that may spoil a result."""
    return line(f"warning: {text}", "yellow")


def some(texts: Sequence[str], where: str = "") -> list[str]:
    """Texts that are shown: all, or the first of many and how many more there are."""
    left = len(texts) - MOST_TEXTS
    return [*texts] if left <= 0 else [*texts[:MOST_TEXTS], f"and {left} more{where}"]


def titled(text: str, table: Table) -> list[PageItem]:
    """A table below its title."""
    return [title(text), table]


def _rendered(shown: Page | PageItem) -> "RenderableType":
    """For rich's console; what is never printed there loads no rich."""
    rendered: RenderableType = import_module("tol3d.report.sheet").rendered(shown)
    return rendered


def _csv_cell(cell: str) -> str | float:
    if not isinstance(cell, Shown):
        return cell.strip()
    return "" if cell.value is None else cell.value
