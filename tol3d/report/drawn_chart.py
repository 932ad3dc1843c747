"""Charts drawn by matplotlib: each panel on axes, and figures of charts below and beside each other."""

import itertools
import math
from collections.abc import Mapping, Sequence
from typing import Any, Final, assert_never

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.gridspec import SubplotSpec

from tol3d.report.canvas import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    MOST_LINES,
    ORANGE,
    OUTSIDE,
    PURPLE,
    SKY,
    VERMILLION,
    WORDS_SIZE,
    label_angles,
    legend_below,
    new_figure,
    plain_axes,
    say_instead,
    title_axes,
)
from tol3d.report.chart import (
    Axis,
    Band,
    Cells,
    Chart,
    Filled,
    Lengths,
    Line,
    Mark,
    Names,
    Outline,
    Panel,
    Points,
    Range,
    Role,
)
from tol3d.report.heading import legible
from tol3d.report.label import widest, wrapped

COLOURS: Final[Mapping[Role, str]] = {
    "geometric": BLUE,
    "analytic": ORANGE,
    "closed-form": BLACK,
    "beyond": OUTSIDE,
    "soft": GREY,
    "plain": BLACK,
    "published-0": GREEN,
    "published-1": PURPLE,
    "published-2": SKY,
    "published-3": GREY,
    "series-0": BLUE,
    "series-1": ORANGE,
    "series-2": GREEN,
    "series-3": PURPLE,
    "series-4": SKY,
    "series-5": VERMILLION,
    "series-6": GREY,
    "series-7": BLACK,
}
FILL_OPACITY, OUTSIDE_OPACITY, BAND_OPACITY = 0.55, 0.85, 0.25
BAR_EDGE: Final = 0.5  # points; the white between two bars
WORDS_ROOM: Final = 0.16  # of the axes' height, for the words above lines
BESIDE_ROOM: Final = 0.12  # of the axes' width, for numbers behind bars
ROOM_OF_TEXT: Final = 0.115  # of the axes' width, for the words at the mean or at an end of 3 sigma
LEAST_ROOM: Final = 0.06  # less, and they stand together
STROKES: Final[Mapping[str, Any]] = {"solid": "-", "dashed": (0, (5, 3)), "dotted": (0, (1, 1)), "thin": "-"}
SIGNS: Final = {"circle": "o", "square": "s", "diamond": "D", "left": "<", "right": ">", "speck": "."}

SPECK: Final = {"markersize": 3.5, "markeredgewidth": 0, "alpha": 0.5}
POINT: Final = {"markersize": 7, "markeredgecolor": "white", "clip_on": False, "zorder": 5}
NUMBERS: Final = 2.9  # inch; height of a panel of numbers
ROW, BAR, LINE, BETWEEN = 0.24, 0.115, 0.155, 0.1  # inch; a row, a bar of it that bears its number, a line of its name
FEWEST_ROWS: Final = 4  # fewer bars are no thicker than these
NAME_WIDTH, NAME_SIZE, NAME_LINES = 2.05, 9.0, 4  # inch, points; the longest possible names fit
ALONE: Final = 4.6  # inch; least height of a chart by itself
FOOT, HEAD, LEGEND_LINE = 0.65, 0.3, 0.2  # inch; axis and its label, the title's first line, a line of the legend
BESIDE, BETWEEN_CHARTS = 1.3, 0.55  # inch; of the axes' numbers and margins, and of those of further charts
LEGEND_MARK: Final = 0.6  # inch, in front of a legend's words
LEGEND_WIDTH, LEGEND_SIZE = 3.0, 8.5  # inch, points
HEAD_SIZE: Final = 12.0  # points
NARROW: Final = 5.0  # inch; charts as narrow have few ticks
WIDE: Final = 11.0  # inch; charts as wide have their legends beside them


# a panel ------------------------------------------------------------------------------------------


def draw_panel(axes: Axes, chart: Chart, panel: Panel) -> None:
    """Draw a panel on axes, without the chart's title and legend."""
    plain_axes(axes)
    _span_axes(axes, chart.x, panel)
    alone = sum(isinstance(own, Filled) for own in panel.series) == 1
    lengths = [own for own in panel.series if isinstance(own, Lengths)]
    for own in panel.series:
        if isinstance(own, Lengths):
            _draw_lengths(axes, own, lengths.index(own), len(lengths))
        else:
            _draw(axes, own, alone=alone)
    if isinstance(chart.x, Axis):
        _draw_marks(axes, panel.marks, (chart.x.low, chart.x.high))


def _span_axes(axes: Axes, x: Axis | Names, panel: Panel) -> None:
    if isinstance(x, Axis):
        room = BESIDE_ROOM if any(isinstance(own, Lengths) for own in panel.series) else 0.0
        axes.set_xscale("log") if x.log else None
        axes.set_xlim(x.low, x.high + room * (x.high - x.low))
        axes.set_xlabel(_escaped(x.words(80)), fontsize=10)
        label_angles(axes.xaxis, x.unit)
        axes.set_xticks([]) if not x.ticks else None
    if isinstance(panel.y, Names):
        labels = names_of(panel)
        bars = any(isinstance(own, Lengths) for own in panel.series)
        rows = max(len(labels), FEWEST_ROWS) if bars else len(labels)
        axes.set_yticks(range(len(labels)), labels, fontsize=NAME_SIZE)
        axes.set_ylim(rows - 0.5, -0.5)
        axes.tick_params(axis="y", length=0)
        axes.grid(axis="y", visible=False)
        axes.spines["left"].set_visible(bars)
        return
    low, high = panel.y.low, panel.y.high
    axes.set_yscale("log") if panel.y.log else None
    axes.set_ylim(low, high + _room_above(panel) * (high - low))
    axes.set_ylabel(_escaped(panel.y.words(int(12 * _height(panel)))), fontsize=10)
    label_angles(axes.yaxis, panel.y.unit)
    axes.set_yticks([]) if not panel.y.ticks else None


def _escaped(text: str) -> str:
    return legible(text, len(text))


def _room_above(panel: Panel) -> float:
    """Part of the span that stays free for words above lines."""
    worded = any(mark.upright and mark.words and mark.kind == "end" for mark in panel.marks)
    return WORDS_ROOM / (1 - WORDS_ROOM) if worded else 0.0


def _draw(axes: Axes, own: Filled | Outline | Line | Band | Points | Range | Cells, *, alone: bool) -> None:
    colour, label = ("", None) if isinstance(own, Cells) else (COLOURS[own.role], own.label or None)
    match own:
        case Filled():
            (_draw_bars if alone else _draw_area)(axes, own, colour, label)
        case Outline():
            style = "--" if own.dashed else "-"
            axes.stairs(own.heights, own.edges, color=colour, linestyle=style, linewidth=1.8, label=label)
        case Line():
            width = 1.2 if own.role == "closed-form" or own.stroke in ("dotted", "thin") else 1.8
            marker = "." if own.dots else None
            axes.plot(
                own.x, own.y, color=colour, linewidth=width, linestyle=STROKES[own.stroke], marker=marker, label=label
            )
        case Band():
            axes.fill_between(own.x, own.low, own.high, color=colour, alpha=BAND_OPACITY, linewidth=0, label=label)
        case Points():
            look: Any = SPECK if own.sign == "speck" else POINT
            axes.plot(own.x, own.y, color=colour, linestyle="", marker=SIGNS[own.sign], label=label, **look)
        case Range():
            _draw_range(axes, own, colour, label)
        case Cells():
            _draw_cells(axes, own)
        case _:
            assert_never(own)


def _draw_bars(axes: Axes, own: Filled, colour: str, label: str | None) -> None:
    """Bars as two collections: a hundred rectangles by themselves take five times as long."""
    lefts, rights, none = own.edges[:-1], own.edges[1:], np.zeros_like(own.heights)
    beyond = none > 0 if own.beyond is None else own.beyond
    corners = np.array([[lefts, none], [lefts, own.heights], [rights, own.heights], [rights, none]]).transpose(2, 0, 1)
    for chosen, fill, opacity in ((~beyond, colour, FILL_OPACITY), (beyond, OUTSIDE, OUTSIDE_OPACITY)):
        named = None if fill == OUTSIDE else label
        bars = PolyCollection(
            list(corners[chosen]), facecolor=fill, alpha=opacity, edgecolor="white", linewidth=BAR_EDGE, label=named
        )
        axes.add_collection(bars, autolim=False)


def _draw_area(axes: Axes, own: Filled, colour: str, label: str | None) -> None:
    beyond = np.zeros_like(own.heights) if own.beyond is None else np.where(own.beyond, own.heights, 0.0)
    axes.stairs(own.heights - beyond, own.edges, fill=True, color=colour, alpha=FILL_OPACITY, label=label)
    if beyond.any():
        axes.stairs(beyond, own.edges, fill=True, color=OUTSIDE, alpha=OUTSIDE_OPACITY)
    axes.stairs(own.heights, own.edges, color=colour, linewidth=1.0)


def _draw_range(axes: Axes, own: Range, colour: str, label: str | None) -> None:
    """A line from end to end, one known end alone, the mean as a dot."""
    rows = [own.row, own.row]
    if own.low is not None and own.high is not None:
        ends = [own.low, own.high]
        axes.plot(ends, rows, color=colour, linewidth=5, solid_capstyle="butt", alpha=0.75, label=label)
    else:
        alone = [end for end in (own.low, own.high) if end is not None]
        axes.plot(alone, rows[: len(alone)], marker="|", markersize=9, markeredgewidth=3, color=colour)
    if own.middle is not None:
        axes.plot(own.middle, own.row, marker="o", markersize=6, color=colour, markeredgecolor="white")
    if own.after:
        place = ("axes fraction", "data")
        axes.annotate(_escaped(own.after), (1.01, own.row), xycoords=place, va="center", fontsize=8)


def _draw_lengths(axes: Axes, own: Lengths, index: int, count: int) -> None:
    height = 0.8 / count
    places = np.arange(len(own.values)) - 0.4 + (index + 0.5) * height
    colours = [COLOURS[role] for role in own.roles] or COLOURS[own.role]
    values = [value or 0.0 for value in own.values]
    drawn = axes.barh(places, values, height=0.9 * height, color=colours, alpha=0.8, label=own.label or None)
    axes.bar_label(drawn, labels=list(own.texts), fontsize=7, padding=2, color=BLACK)


# marks --------------------------------------------------------------------------------------------


def _draw_marks(axes: Axes, marks: Sequence[Mark], span: tuple[float, float]) -> None:
    ends = [mark for mark in marks if mark.kind == "end"]
    top = 1.0 - WORDS_ROOM if any(mark.words for mark in ends) else 1.0
    for mark in marks:
        label = mark.label or None
        limit = mark.kind == "limit"
        colour = COLOURS[mark.role] if mark.role else OUTSIDE if limit else GREY
        style: Any = {
            "color": colour,
            "linewidth": 2.0 if limit else 1.0,
            "linestyle": "-" if limit or mark.role else ":",
        }
        if not mark.upright:
            axes.axhline(mark.value, label=label, **style)
        elif span[0] <= mark.value <= span[1]:
            axes.axvline(mark.value, ymax=top, label=label, **style)
        if limit and mark.upright and mark.words:
            _name_limit(axes, mark, span, colour)
    if top < 1.0:
        _name_ends(axes, ends, span)


def _name_limit(axes: Axes, mark: Mark, span: tuple[float, float], colour: str) -> None:
    """Words beside a limit's line, at the edge with an arrow where it lies further off."""
    text = _escaped("\n".join(mark.words))
    if not span[0] <= mark.value <= span[1]:
        text = f"◄ {text}" if mark.value < span[0] else f"{text} ►"
    axes.annotate(
        text,
        (min(max(mark.value, span[0]), span[1]), 0.72),
        xycoords=("data", "axes fraction"),
        xytext=(-5 if mark.upper else 5, 0),
        textcoords="offset points",
        ha="right" if mark.upper else "left",
        fontsize=9,
        color=colour,
        bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.75, "pad": 1.5},
    )


def _name_ends(axes: Axes, ends: Sequence[Mark], span: tuple[float, float]) -> None:
    """Words at the lines of mean and ends, side by side; in one where there is no room for that."""
    room = min((b.value - a.value for a, b in itertools.pairwise(ends)), default=math.inf) / (span[1] - span[0])
    texts = [("\n".join(mark.words), mark.value, "center") for mark in ends]
    if room < LEAST_ROOM:
        words, values = (" … ".join(each) for each in zip(*(mark.words for mark in ends), strict=True))
        texts = [(f"{words}\n{values}", ends[len(ends) // 2].value, "center")]
    elif room < ROOM_OF_TEXT:
        sides = ("right", *["center"] * (len(texts) - 2), "left")
        texts = [(text, value, side) for (text, value, _), side in zip(texts, sides, strict=True)]
    for text, value, side in texts:
        axes.annotate(
            text, (value, 1.0), xycoords=("data", "axes fraction"), ha=side, va="top", fontsize=8.5, color=BLACK
        )


# charts and figures -------------------------------------------------------------------------------


def names_of(panel: Panel) -> list[str]:
    """Labels of a panel's rows in lines, whole."""
    names = panel.y.names if isinstance(panel.y, Names) else ()
    return [wrapped(name, NAME_WIDTH, NAME_SIZE, NAME_LINES) for name in names]


def _height(panel: Panel) -> float:
    """Height of a panel [inch]."""
    if not isinstance(panel.y, Names):
        return NUMBERS * panel.height
    labels = names_of(panel)
    lines = max((label.count("\n") + 1 for label in labels), default=1)
    bars = sum(isinstance(own, Lengths) for own in panel.series)
    if not bars:
        return max(ROW, LINE * lines) * len(labels) + 0.1
    return (max(LINE * lines, BAR * bars) + BETWEEN) * max(len(labels), FEWEST_ROWS)


def chart_height(chart: Chart, width: float, room: float) -> float:
    """Height of a chart with its title, axis and legend [inch].

    Args:
        chart: the chart.
        width: of it [inch].
        room: width of the words above it.
    """
    legend = 0 if _legend_beside(chart, width) else sum(own.count("\n") + 1 for own in _legend(chart, room).values())
    words = wrapped(chart.words, room, WORDS_SIZE, MOST_LINES).count("\n") + bool(chart.words)
    return (
        HEAD
        + LINE * words
        + FOOT
        + (sum(map(_height, chart.panels)) or NUMBERS)
        + LEGEND_LINE * (legend + bool(legend))
    )


def _words_widths(row: Sequence[Chart], width: float, shares: Sequence[float]) -> list[float]:
    """Widths of the words above charts in a row [inch]: those of their axes, which labels beside all of them lessen."""
    labels = [names_of(panel) for chart in row for panel in chart.panels]
    alone = [chart for chart in row if len(row) == 1 and _legend_beside(chart, width)]
    legend = [[*_legend(chart, 0.0).values()] for chart in alone]
    taken = BESIDE + BETWEEN_CHARTS * (len(row) - 1) + sum(widest(own, NAME_SIZE) for own in labels)
    taken += sum(widest(own, LEGEND_SIZE) + LEGEND_MARK for own in legend)
    return [max((width - taken) * share / sum(shares), 2.0) for share in shares]


def _legend(chart: Chart, room: float) -> dict[str, str]:
    """Words of the legend in lines, by labels; none where rows below name the colours."""
    kinds = {isinstance(panel.y, Names) for panel in chart.panels}
    labels = [label for label, _ in chart.labelled()] if len(kinds) == 1 else []
    return {own: wrapped(own, max(LEGEND_WIDTH, room - LEGEND_MARK), LEGEND_SIZE, NAME_LINES) for own in labels}


def _legend_beside(chart: Chart, width: float) -> bool:
    return width >= WIDE and not chart.has_rows and bool(_legend(chart, 0.0))


def _named(axes: Sequence[Axes]) -> dict[str, Artist]:
    """Artists of a legend by their labels, the first of each."""
    named: dict[str, Artist] = {}
    for own in axes:
        for handle, label in zip(*own.get_legend_handles_labels(), strict=True):
            named.setdefault(label, handle)
    return named


def draw_chart(
    figure: Figure, place: SubplotSpec, chart: Chart, width: float, room: float, *, legend: bool = True
) -> None:
    """Draw a chart with its title, words and legend in a place of a figure; see `chart_height`."""
    if chart.instead:
        axes = plain_axes(figure.add_subplot(place))
        title_axes(axes, chart.title, chart.words, room)
        axes.set_axis_off()
        say_instead(axes, chart.instead, OUTSIDE)
        return
    heights = [_height(panel) for panel in chart.panels]
    several = place.subgridspec(len(heights), 1, height_ratios=heights, hspace=0.02) if len(heights) > 1 else None
    every: list[Axes] = []
    for row, panel in enumerate(chart.panels):
        own = several[row, 0] if several else place
        axes = figure.add_subplot(own, sharex=every[0] if every else None)
        draw_panel(axes, chart, panel)
        every.append(axes)
    for axes in every[:-1]:
        axes.tick_params(labelbottom=False)
        axes.set_xlabel("")
    title_axes(every[0], chart.title, chart.words, room)
    if width < NARROW and isinstance(chart.x, Axis) and chart.x.unit != "arcmin" and not chart.x.log:
        every[0].locator_params(axis="x", nbins=5)
    words = _legend(chart, 0.0 if _legend_beside(chart, width) else room)
    artists = _named(every)
    named = {text: artists[label] for label, text in words.items() if label in artists}
    if not legend or not named:
        return
    if _legend_beside(chart, width):
        where: Any = {"loc": "center left", "bbox_to_anchor": (1.0, 0.5)}
        every[0].legend([*named.values()], [*named], fontsize=LEGEND_SIZE, frameon=False, **where)
    else:
        legend_below(every[-1], named)


def charts_figure(
    rows: Sequence[Sequence[Chart]],
    head: str = "",
    width: float = 9.0,
    ratios: Sequence[float] = (),
    *,
    shared: bool = False,
) -> Figure:
    """Rows of charts beside each other, not yet written.

    Args:
        rows: from the top; a shorter one has wider charts.
        head: words above all.
        width: of the figure [inch].
        ratios: of the charts' widths in a full row.
        shared: True for one legend of all beside the head, and places of a last row as wide as those above.
    """
    most = len(ratios) if shared else max(map(len, rows))
    columns = ratios if len(ratios) == most else [1.0] * most
    shares = [columns if len(row) == most or shared else [1.0] * len(row) for row in rows]
    widths = [[width * own / sum(each) for own in each] for each in shares]
    rooms = [_words_widths(row, width, own) for row, own in zip(rows, shares, strict=True)]
    heights = [max(map(chart_height, *own)) for own in zip(rows, widths, rooms, strict=True)]
    if len(rows) == 1 == len(rows[0]) and not rows[0][0].has_rows:
        heights = [max(heights[0], ALONE)]
    text = wrapped(head, width - 0.4, HEAD_SIZE, 4)
    figure = new_figure(width, sum(heights) + HEAD * (1 + text.count("\n") if head else 0) + 0.1)
    if head:
        figure.suptitle(text, fontsize=HEAD_SIZE, color=BLACK, x=0.01, ha="left")
    grid = figure.add_gridspec(len(rows), most, height_ratios=heights, width_ratios=columns, hspace=0.08)
    for number, (row, own) in enumerate(zip(rows, widths, strict=True)):
        for k, chart in enumerate(row):
            place = grid[number, :] if len(own) == 1 else grid[number, k]
            draw_chart(figure, place, chart, own[k], rooms[number][k], legend=not shared)
    if shared:
        named = _named(figure.axes)
        figure.legend(
            [*named.values()],
            [*named],
            loc="upper right",
            ncols=len(named),
            fontsize=LEGEND_SIZE,
            frameon=False,
        )
    return figure


# the matrix ---------------------------------------------------------------------------------------

CELL: Final = (0.32, 0.22)  # inch
CELL_SIZE, TITLE_SIZE, MATRIX_SIZE = 6.5, 11.0, 8.0  # points
MATRIX_NAME: Final = 2.6  # inch; longer names are cut
GAP: Final = 0.1  # inch
SCALE: Final = 0.9  # inch; of the scale of colours, with its numbers
LEAST_WIDTH: Final = 7.0  # inch; of a picture, for its head
LEAST_WRITTEN: Final = 0.95  # %; smaller shares have no number
DARK: Final = 0.62  # of the largest share; numbers are white above it


def _draw_cells(axes: Axes, own: Cells) -> Artist:
    colours = np.where(np.arange(len(own.values))[:, None] < own.coloured, own.values, 0.0)
    most = max(float(np.nanmax(colours, initial=0.0)), LEAST_WRITTEN)
    image = axes.imshow(colours, aspect="auto", cmap="Blues", vmin=0.0, vmax=most)
    for (row, column), share in np.ndenumerate(own.values):
        if share >= LEAST_WRITTEN:
            colour = "white" if colours[row, column] > DARK * most else BLACK
            axes.text(column, row, f"{share:.0f}", ha="center", va="center", fontsize=CELL_SIZE, color=colour)
    return image


def matrix_figure(chart: Chart) -> Figure:
    """A chart of cells with its names and a scale of colours, not yet written."""
    (panel,) = chart.panels
    assert isinstance(chart.x, Names)
    assert isinstance(panel.y, Names)
    labels = [wrapped(name, MATRIX_NAME, MATRIX_SIZE, 1) for name in panel.y.names]
    across = [wrapped(name, MATRIX_NAME, MATRIX_SIZE, 1) for name in chart.x.names]
    head = [chart.title, *filter(None, chart.words.split("\n"))]
    left = GAP + widest(labels, MATRIX_SIZE) + GAP
    above = GAP + LEGEND_LINE * len(head) + GAP + widest(across, MATRIX_SIZE) + GAP
    wide, high = CELL[0] * len(across), CELL[1] * len(labels)
    width, height = max(left + wide + SCALE, LEAST_WIDTH), above + high + 2 * GAP
    figure = new_figure(width, height)
    figure.set_layout_engine("none")
    axes = figure.add_axes((left / width, 2 * GAP / height, wide / width, high / height))
    image: Any = _draw_cells(axes, next(own for own in panel.series if isinstance(own, Cells)))
    axes.set_yticks(range(len(labels)), labels, fontsize=MATRIX_SIZE)
    axes.set_xticks(range(len(across)), across, fontsize=MATRIX_SIZE, rotation=90)
    axes.tick_params(length=0, labeltop=True, labelbottom=False)
    bar = figure.add_axes(((left + wide + 2 * GAP) / width, 2 * GAP / height, GAP / width, min(high, 3.0) / height))
    figure.colorbar(image, cax=bar).ax.tick_params(labelsize=MATRIX_SIZE)
    for number, words in enumerate(head):
        size, weight = (TITLE_SIZE, "bold") if number == 0 else (MATRIX_SIZE, "normal")
        text = wrapped(words, width - 2 * GAP, size, 1, weight)
        place = (GAP / width, 1 - (GAP + LEGEND_LINE * number) / height)
        figure.text(*place, text, fontsize=size, fontweight=weight, color=BLACK, va="top")
    return figure
