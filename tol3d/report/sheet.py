"""Pages for the terminal in which no number is ever cut: columns that find no room go on in a table below."""

from collections.abc import Collection, Iterator
from dataclasses import dataclass, replace
from io import StringIO

from rich import box
from rich.cells import cell_len
from rich.console import Console, ConsoleOptions, Group, RenderableType, RenderResult
from rich.padding import Padding
from rich.table import Table as RichTable
from rich.text import Text
from rich.tree import Tree

from tol3d.report.number import NOTHING
from tol3d.report.page import Branch, Heading, Page, PageItem, Row, Table

GAP = 2  # blanks between two columns
TIGHT_LABELS = 14  # characters kept by labels before they wrap, if that saves a table below
LABELS_SHARE = 3  # else they keep a third of the width


def rendered(shown: Page | PageItem) -> RenderableType:
    """Renderable of a page or item, for rich's console."""
    if isinstance(shown, Page):
        return Group(*map(rendered, shown.blocks))
    if isinstance(shown, Table):
        return Sheet(shown.shown)
    if isinstance(shown, Branch):
        return _tree(shown)
    text = Text.assemble(*shown.pieces)
    return Padding(text, (0, 0, 0, 1)) if shown.note else text


def _tree(branch: Branch) -> Tree:
    tree = Tree(Text(branch.text))
    for own in branch.branches:
        tree.children.append(_tree(own))
    return tree


def as_text(shown: Page | PageItem, width: int) -> str:
    """Text of a page or item, in so many columns, without colours."""
    console = Console(file=StringIO(), width=width, highlight=False, markup=False, color_system=None)
    with console.capture() as captured:
        console.print(rendered(shown))
    return captured.get()


@dataclass(frozen=True)
class Sheet:
    """A table as it fits a terminal.

    In a narrow one, cells of columns that may stand below become lines there; then labels, headings and words wrap;
    where that is not enough, optional columns are left out, and then the columns that are left stand in a table below,
    beside the labels and the first `repeated` columns.
    """

    table: Table

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        width, sheet = options.max_width, self
        below = [index for index, heading in enumerate(self.table.headings) if heading.below]
        if below and not self._is_whole(width):
            sheet = sheet._without(below)
        else:
            below = []
        if len(sheet._tables(width)) > 1:
            sheet = sheet._without([index for index, heading in enumerate(sheet.table.headings) if heading.optional])
        for number, widths in enumerate(sheet._tables(width)):
            if number:
                yield Text()
            yield sheet._part(widths)
        for index in below:
            yield from self._told_below(index)

    def _told_below(self, index: int) -> Iterator[RenderableType]:
        """A line for each cell of a column, rows with the same cell together."""
        alike: dict[str, list[Row]] = {}
        for row in self.table.rows:
            if row.cells[index] != NOTHING:
                alike.setdefault(row.cells[index], []).append(row)
        for cell, rows in alike.items():
            told = f"{', '.join(row.label for row in rows)}: {self.table.headings[index].text} · {cell}"
            yield Padding(Text(told, rows[0].style), (0, 0, 0, 1))

    def _is_whole(self, width: int) -> bool:
        """True if everything stands in one table, and nothing that may stand below it wraps."""
        (first, *more) = self._tables(width)
        headings = enumerate(self.table.headings, 1)
        return not more and all(first[index] >= self._whole(index) for index, heading in headings if heading.below)

    def _without(self, left: Collection[int]) -> "Sheet":
        """It without some columns."""
        table = self.table
        kept = [index for index in range(len(table.headings)) if index not in left]
        rows = [replace(row, cells=[row.cells[index] for index in kept]) for row in table.rows]
        return Sheet(replace(table, headings=[table.headings[index] for index in kept], rows=rows))

    def _column(self, index: int) -> list[str]:
        """Everything in a column, its head first; column 0 is that of the labels."""
        if index == 0:
            return [self.table.corner, *(row.label for row in self.table.rows)]
        return [self.table.headings[index - 1].text, *(row.cells[index - 1] for row in self.table.rows)]

    def _whole(self, index: int) -> int:
        """Width of a column that wraps nothing."""
        return max(map(cell_len, self._column(index)))

    def _least(self, index: int, most: int) -> int:
        """The narrowest that a column but the labels' may be; over `most` even words and numbers are folded."""
        head, *cells = self._column(index)
        needed = _longest_word if self.table.headings[index - 1].words else cell_len
        return min(most, max([_longest_word(head), *map(needed, cells)]))

    def _tables(self, width: int) -> list[dict[int, int]]:
        """The columns of each table with their widths."""
        longest = max(map(_longest_word, self._column(0)))
        roomy = min(self._whole(0), width // LABELS_SHARE)
        tight = min(roomy, max(longest, TIGHT_LABELS))
        tables = self._grouped(roomy, width)
        fewer = self._grouped(tight, width)
        return [self._widened(each, width) for each in (tables if len(tables) == len(fewer) else fewer)]

    def _grouped(self, labels: int, width: int) -> list[dict[int, int]]:
        """Least widths of the columns that stand together, as many as there is room for beside labels that wide."""
        least = {index + 1: self._least(index + 1, width - labels - GAP) for index in range(len(self.table.headings))}
        first = {0: labels, **{index: least[index] for index in range(1, self.table.repeated + 1)}}
        groups = [dict(first)]
        for index in range(self.table.repeated + 1, len(self.table.headings) + 1):
            taken = sum(groups[-1].values()) + GAP * len(groups[-1])
            if taken + least[index] > width and len(groups[-1]) > len(first):
                groups.append(dict(first))
            groups[-1][index] = least[index]
        return groups

    def _widened(self, least: dict[int, int], width: int) -> dict[int, int]:
        """The widths when the room that is left goes to the column that lacks most."""
        widths, whole = dict(least), {index: self._whole(index) for index in least}
        for _ in range(width - sum(widths.values()) - GAP * (len(widths) - 1)):
            neediest = max(widths, key=lambda index: whole[index] - widths[index])
            widths[neediest] += whole[neediest] > widths[neediest]
        return widths

    def _part(self, widths: dict[int, int]) -> RichTable:
        table = RichTable(box=box.SIMPLE_HEAD, show_edge=False, pad_edge=False, padding=(0, 1), header_style="bold")
        table.collapse_padding = True
        for index, width in widths.items():
            heading = self.table.headings[index - 1] if index else Heading(self.table.corner, words=True)
            table.add_column(
                Text(heading.text),
                justify="left" if heading.words else "right",
                style=heading.style,
                width=width,
                overflow="fold",
            )
        for row in self.table.rows:
            cells = [row.cells[index - 1] if index else row.label for index in widths]
            table.add_row(*map(Text, cells), style=row.style)
        return table


def _longest_word(text: str) -> int:
    return max(map(cell_len, text.split()), default=0)
