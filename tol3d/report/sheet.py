"""Tables for the terminal in which no number is ever cut: columns that find no room go on in a table below."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from rich import box
from rich.cells import cell_len
from rich.console import Console, ConsoleOptions, Group, RenderResult
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

GAP = 2  # blanks between two columns
TIGHT_LABELS = 14  # characters; what labels keep before they wrap, where that saves a table below
LABELS_SHARE = 3  # else they keep a third of the width


@dataclass(frozen=True)
class Heading:
    """Head of a column; words stand left and wrap, numbers right and whole; an optional one goes where room lacks."""

    text: str
    style: str = ""
    words: bool = False
    optional: bool = False


@dataclass(frozen=True)
class Row:
    """A line of a sheet: its label and a cell for each heading."""

    label: str
    cells: Sequence[str]
    style: str = ""


def note(text: str) -> Padding:
    """A line below a table."""
    return Padding(Text(text, style="dim"), (0, 0, 0, 1))


def titled(title: str, sheet: "Sheet") -> Group:
    """A table under its title."""
    return Group(Text(f"\n{title}", style="bold cyan"), sheet)


@dataclass(frozen=True)
class Sheet:
    """A table: a column of labels and one for each heading.

    In a narrow terminal labels, headings and words wrap; where that is not enough, optional columns are left out, and
    then the columns that are left stand in a table below, beside the labels and the first `repeated` columns.
    """

    corner: str
    headings: Sequence[Heading]
    rows: Sequence[Row]
    repeated: int = 0

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        width = options.max_width
        sheet = self if len(self._tables(width)) == 1 else self._needed()
        for number, widths in enumerate(sheet._tables(width)):
            if number:
                yield Text()
            yield sheet._table(widths)

    def _needed(self) -> "Sheet":
        """It without its optional columns."""
        kept = [index for index, heading in enumerate(self.headings) if not heading.optional]
        rows = [replace(row, cells=[row.cells[index] for index in kept]) for row in self.rows]
        return replace(self, headings=[self.headings[index] for index in kept], rows=rows)

    def _column(self, index: int) -> list[str]:
        """Everything in a column, its head first; column 0 is that of the labels."""
        if index == 0:
            return [self.corner, *(row.label for row in self.rows)]
        return [self.headings[index - 1].text, *(row.cells[index - 1] for row in self.rows)]

    def _whole(self, index: int) -> int:
        """How wide a column is that wraps nothing."""
        return max(map(cell_len, self._column(index)))

    def _least(self, index: int, most: int) -> int:
        """The narrowest that a column but the labels' may be; over `most` even words and numbers are folded."""
        head, *cells = self._column(index)
        needed = _longest_word if self.headings[index - 1].words else cell_len
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
        least = {index + 1: self._least(index + 1, width - labels - GAP) for index in range(len(self.headings))}
        first = {0: labels, **{index: least[index] for index in range(1, self.repeated + 1)}}
        groups = [dict(first)]
        for index in range(self.repeated + 1, len(self.headings) + 1):
            taken = sum(groups[-1].values()) + GAP * len(groups[-1])
            if taken + least[index] > width and len(groups[-1]) > len(first):
                groups.append(dict(first))
            groups[-1][index] = least[index]
        return groups

    def _widened(self, least: dict[int, int], width: int) -> dict[int, int]:
        """The widths when the room that is left goes to the column that lacks most."""
        widths = dict(least)
        for _ in range(width - sum(widths.values()) - GAP * (len(widths) - 1)):
            neediest = max(widths, key=lambda index: self._whole(index) - widths[index])
            widths[neediest] += self._whole(neediest) > widths[neediest]
        return widths

    def _table(self, widths: dict[int, int]) -> Table:
        table = Table(box=box.SIMPLE_HEAD, show_edge=False, pad_edge=False, padding=(0, 1), header_style="bold")
        table.collapse_padding = True
        for index, width in widths.items():
            heading = self.headings[index - 1] if index else Heading(self.corner, words=True)
            table.add_column(
                Text(heading.text),
                justify="left" if heading.words else "right",
                style=heading.style,
                width=width,
                overflow="fold",
            )
        for row in self.rows:
            cells = [row.cells[index - 1] if index else row.label for index in widths]
            table.add_row(*map(Text, cells), style=row.style)
        return table


def _longest_word(text: str) -> int:
    return max(map(cell_len, text.split()), default=0)
