"""Figures of charts by matplotlib: below and beside each other with titles, words and legends; and the matrix."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.gridspec import SubplotSpec

from tol3d.report.canvas import (
    BLACK,
    MOST_LINES,
    OUTSIDE,
    WORDS_SIZE,
    legend_below,
    new_figure,
    plain_axes,
    save_figure,
    say_instead,
    title_axes,
    widest,
    wrapped,
)
from tol3d.report.chart import (
    Axis,
    Cells,
    Chart,
    Charts,
    Names,
)
from tol3d.report.drawn_chart import (
    LINE,
    NAME_LINES,
    NAME_SIZE,
    NUMBERS,
    draw_cells,
    draw_panel,
    names_of,
    panel_height,
)

ALONE: Final = 4.6  # inch; least height of a chart by itself
FOOT, HEAD, LEGEND_LINE = 0.65, 0.3, 0.2  # inch; axis and its label, the title's first line, a line of the legend
BESIDE, BETWEEN_CHARTS = 1.3, 0.55  # inch; of the axes' numbers and margins, and of those of further charts
LEGEND_MARK: Final = 0.6  # inch, in front of a legend's words
LEGEND_WIDTH, LEGEND_SIZE = 3.0, 8.5  # inch, points
HEAD_SIZE: Final = 12.0  # points
NARROW: Final = 5.0  # inch; charts as narrow have few ticks
WIDE: Final = 11.0  # inch; charts as wide have their legends beside them


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
        + (sum(map(panel_height, chart.panels)) or NUMBERS)
        + LEGEND_LINE * (legend + bool(legend))
    )


def _words_widths(row: Sequence[Chart], width: float, shares: Sequence[float]) -> list[float]:
    """Widths of the words above charts in a row [inch]: those of their axes, which labels beside all of them lessen."""
    labels = [names_of(panel) for chart in row for panel in chart.panels]
    alone = [chart for chart in row if len(row) == 1 and _legend_beside(chart, width)]
    legend = [[*_legend(chart, 0.0).values()] for chart in alone]
    taken = BESIDE + BETWEEN_CHARTS * (len(row) - 1) + sum(widest(label, NAME_SIZE) for label in labels)
    taken += sum(widest(own, LEGEND_SIZE) + LEGEND_MARK for own in legend)
    return [max((width - taken) * share / sum(shares), 2.0) for share in shares]


def _legend(chart: Chart, room: float) -> dict[str, str]:
    """Words of the legend in lines, by labels; none where rows below name the colours."""
    kinds = {isinstance(panel.y, Names) for panel in chart.panels}
    labels = [label for label, _ in chart.labelled()] if len(kinds) == 1 else []
    return {label: wrapped(label, max(LEGEND_WIDTH, room - LEGEND_MARK), LEGEND_SIZE, NAME_LINES) for label in labels}


def _legend_beside(chart: Chart, width: float) -> bool:
    return width >= WIDE and not chart.has_rows and bool(_legend(chart, 0.0))


def _named(axes: Sequence[Axes]) -> dict[str, Artist]:
    """Artists of a legend by their labels, the first of each."""
    named: dict[str, Artist] = {}
    for axis in axes:
        for handle, label in zip(*axis.get_legend_handles_labels(), strict=True):
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
    heights = [panel_height(panel) for panel in chart.panels]
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
    widths = [[width * own / sum(share) for own in share] for share in shares]
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


def figure_of(charts: Charts) -> Figure:
    """Several charts as a figure, not yet written; a matrix stands alone."""
    first = charts.rows[0][0]
    if isinstance(first.x, Names):
        return matrix_figure(first)
    return charts_figure(charts.rows, charts.head, charts.width, charts.ratios)


def save_charts(charts: Charts, path: Path) -> None:
    """Draw several charts: `path` ends in .png, .svg or .pdf.

    Raises:
        InputError: the picture cannot be written there.
    """
    save_figure(figure_of(charts), path)


# the matrix ----------------------------------------------------------------------------------------

CELL: Final = (0.32, 0.22)  # inch
TITLE_SIZE, MATRIX_SIZE = 11.0, 8.0  # points
MATRIX_NAME: Final = 2.6  # inch; longer names are cut
GAP: Final = 0.1  # inch
SCALE: Final = 0.9  # inch; of the scale of colours, with its numbers
LEAST_WIDTH: Final = 7.0  # inch; of a picture, for its head


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
    image: Any = draw_cells(axes, next(own for own in panel.series if isinstance(own, Cells)))
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
