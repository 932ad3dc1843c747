"""Charts as data: numbers, words and roles, which a renderer turns into places and colours.

Two renderers draw them: `report/drawn_chart.py` with matplotlib for PNG, PDF and notebooks, `report/html/svg.py` as SVG
for the report. A chart names no place, letter size or colour, a renderer no measure.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.arrays import Array
from tol3d.report.heading import cut
from tol3d.report.number import UNIT_SIGNS

Ours = Literal["geometric", "analytic", "closed-form", "beyond", "soft", "plain"]
Published = Literal["published-0", "published-1", "published-2", "published-3"]
Serial = Literal["series-0", "series-1", "series-2", "series-3", "series-4", "series-5", "series-6", "series-7"]
Role = Ours | Published | Serial
"""Subject of a series: a method, what is out of limits, a published column, or one of several of a kind.

A renderer has a colour for each: matplotlib a colour of Okabe and Ito, SVG a CSS class.
"""
PUBLISHED: Final[tuple[Published, ...]] = ("published-0", "published-1", "published-2", "published-3")
SERIES: Final[tuple[Serial, ...]] = (
    *("series-0", "series-1", "series-2", "series-3"),
    *("series-4", "series-5", "series-6", "series-7"),
)
MOST_WRITTEN: Final = 64
"""Cells of a field that have numbers."""
AXIS_UNITS: Final = {"arcmin": "′, ″ of arc"}  # where an axis has other words than a number


@dataclass(frozen=True)
class Axis:
    """Numbers along a direction.

    Args:
        label: name of the numbers.
        low, high: the span.
        unit: of the numbers; of "arcmin" ticks are in minutes and seconds.
        log: True for a logarithmic scale; low is above 0.
        ticks: False for an axis without numbers.
    """

    label: str
    low: float
    high: float
    unit: str = ""
    log: bool = False
    ticks: bool = True

    def words(self, longest: int) -> str:
        """Its label with the unit, of a longer name the start.

        >>> Axis("play", 0.0, 1.0, "um").words(30), Axis("left play of the pin", 0.0, 1.0, "arcmin").words(12)
        ('play [µm]', 'left play o…')
        """
        unit = f" [{AXIS_UNITS.get(self.unit) or UNIT_SIGNS.get(self.unit, self.unit)}]" if self.unit else ""
        if self.unit == "arcmin" and len(self.label) + len(unit) > longest:  # its ticks have the signs too
            return cut(self.label, longest)
        return cut(self.label, longest - len(unit)) + unit


@dataclass(frozen=True)
class Names:
    """Rows by their names, the first at the top; as an axis of columns, the first at the left."""

    names: Sequence[str]


@dataclass(frozen=True, eq=False)
class Filled:
    """Bars of a histogram, filled, each in pieces where a limit runs through it.

    Args:
        edges: (pieces + 1,) rising.
        heights: (pieces,).
        role: of pieces within the limits.
        label: in the legend; "" for none.
        beyond: (pieces,) True where a piece lies beyond a limit.
        bars: (pieces,) index of the bar that each is of.
        words: (pieces,) for tooltips.
    """

    edges: Array
    heights: Array
    role: Role
    label: str = ""
    beyond: NDArray[np.bool_] | None = None
    bars: Sequence[int] = ()
    words: Sequence[str] = ()


@dataclass(frozen=True, eq=False)
class Outline:
    """The outline of bars: edges (bars + 1,), heights (bars,)."""

    edges: Array
    heights: Array
    role: Role
    label: str = ""
    dashed: bool = False


Stroke = Literal["solid", "dashed", "dotted", "thin"]


@dataclass(frozen=True, eq=False)
class Line:
    """Values over numbers, both (n,), nan where there is none; with dots where only its points are values."""

    x: Array
    y: Array
    role: Role
    label: str = ""
    stroke: Stroke = "solid"
    dots: bool = False


@dataclass(frozen=True, eq=False)
class Band:
    """An area between two lines over numbers, all (n,)."""

    x: Array
    low: Array
    high: Array
    role: Role
    label: str = ""


Sign = Literal["circle", "square", "diamond", "left", "right", "speck"]


@dataclass(frozen=True, eq=False)
class Points:
    """Points at numbers x and y (n,), of a rows' axis y the row; specks are many and small."""

    x: Array
    y: Array
    role: Role
    label: str = ""
    sign: Sign = "circle"


@dataclass(frozen=True)
class Range:
    """An interval in a row, from end to end, its middle as a dot.

    Args:
        row: its row.
        low, high: ends; None where one is not known.
        middle: mean; None for none.
        role: the role.
        words: for a tooltip.
        after: words behind it.
        label: in the legend.
    """

    row: int
    low: float | None
    high: float | None
    middle: float | None
    role: Role
    words: str = ""
    after: str = ""
    label: str = ""


@dataclass(frozen=True)
class Lengths:
    """Bars from 0, one a row; several of these share the rows.

    Args:
        values: by row; None where there is none.
        texts: numbers behind the bars.
        role: of all.
        label: in the legend.
        roles: of each, where they differ.
    """

    values: Sequence[float | None]
    texts: Sequence[str]
    role: Role
    label: str = ""
    roles: Sequence[Role] = ()


@dataclass(frozen=True, eq=False)
class Cells:
    """A matrix of values (rows, columns), nan for none; `coloured` rows have a colour, the others a number alone."""

    values: Array
    coloured: int
    unit: str = "%"


@dataclass(frozen=True, eq=False)
class Field:
    """Values over two numbers as colours, with their numbers where they are few.

    Args:
        x, y: places of columns and rows, rising (columns,), (rows,).
        values: (rows, columns), nan where there is none.
        words: name of the values, with their unit.
        log: True for a logarithmic scale of colours, values above 0.
    """

    x: Array
    y: Array
    values: Array
    words: str
    log: bool = False

    def edges(self, *, upright: bool) -> Array:
        """Edges of the columns, or upright of the rows: midway between places (places + 1,)."""
        places = self.y if upright else self.x
        if len(places) == 1:
            return np.array([places[0] - 0.5, places[0] + 0.5])
        middles = (places[1:] + places[:-1]) / 2
        return np.concatenate([[2 * places[0] - middles[0]], middles, [2 * places[-1] - middles[-1]]])

    @property
    def strength(self) -> Array:
        """Its values on their scale from 0 to 1, nan where there is none."""
        values = np.log(self.values) if self.log else self.values
        known = values[np.isfinite(values)]
        low, high = (float(known.min()), float(known.max())) if len(known) else (0.0, 1.0)
        return np.asarray((values - low) / ((high - low) or 1.0))

    @property
    def written(self) -> bool:
        """True where its cells have numbers."""
        return self.values.size <= MOST_WRITTEN


Series = Filled | Outline | Line | Band | Points | Range | Lengths | Cells | Field


@dataclass(frozen=True)
class Mark:
    """A straight line at a value.

    Args:
        value: where.
        kind: a limit, an end or mean of a sample with its words above, or a guide.
        words: at the line; the first is what it is.
        upper: True for an upper limit.
        upright: True at a value of x, False at one of y.
        label: in the legend.
        role: colour of a limit or guide, where it is no common one.
    """

    value: float
    kind: Literal["limit", "end", "guide"]
    words: Sequence[str] = ()
    upper: bool = False
    upright: bool = True
    label: str = ""
    role: Role | None = None


@dataclass(frozen=True)
class Panel:
    """Series over one axis y, with marks.

    Args:
        y: its axis, or the names of its rows.
        series: drawn in this order.
        marks: lines at values.
        height: of numbers, in that of a histogram; rows have their own.
    """

    y: Axis | Names
    series: Sequence[Series]
    marks: Sequence[Mark] = ()
    height: float = 1.0


@dataclass(frozen=True)
class Chart:
    """A chart: panels below each other over one axis x.

    Args:
        alternative: text for those who do not see it.
        title, words: above it, where nothing else says them.
        x: axis of all panels, or the names of columns.
        panels: from the top.
        table: what it shows in words, for screen readers: the mean, ends, limits.
        instead: a sentence where there is nothing to show; "" for a chart.
    """

    alternative: str
    x: Axis | Names
    panels: Sequence[Panel]
    title: str = ""
    words: str = ""
    table: Sequence[tuple[str, str]] = ()
    instead: str = ""

    @property
    def has_rows(self) -> bool:
        """True if its panels are rows by their names alone."""
        return all(isinstance(panel.y, Names) for panel in self.panels)

    def labelled(self) -> Iterator[tuple[str, Series | Mark]]:
        """Series and marks of its legend, by their words."""
        seen = set[str]()
        for panel in self.panels:
            for own in (*panel.series, *panel.marks):
                label = "" if isinstance(own, Cells | Field) else own.label
                if label and label not in seen:
                    seen.add(label)
                    yield label, own


@dataclass(frozen=True)
class Charts:
    """Several charts of one thing.

    Args:
        rows: below and beside each other, where there is room.
        head: words above all.
        width: of a figure of them [inch].
        ratios: of the charts' widths in a full row of it.
    """

    rows: Sequence[Sequence[Chart]]
    head: str = ""
    width: float = 9.0
    ratios: Sequence[float] = ()
