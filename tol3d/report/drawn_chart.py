"""Panels of charts drawn by matplotlib on axes, and the height that they need."""

import itertools
import math
from collections.abc import Mapping, Sequence
from typing import Any, Final, assert_never

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import LogNorm, Normalize
from matplotlib.ticker import LogLocator

from tol3d.report.canvas import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    OUTSIDE,
    PURPLE,
    SKY,
    VERMILLION,
    label_angles,
    plain_axes,
    wrapped,
)
from tol3d.report.chart import (
    Axis,
    Band,
    Cells,
    Chart,
    Field,
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
from tol3d.report.number import NOTHING

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

SPECK: Final[Mapping[str, Any]] = {"markersize": 3.5, "markeredgewidth": 0, "alpha": 0.5}
POINT: Final[Mapping[str, Any]] = {"markersize": 7, "markeredgecolor": "white", "clip_on": False, "zorder": 5}
NUMBERS: Final = 2.9  # inch; height of a panel of numbers
ROW, BAR, LINE, BETWEEN = 0.24, 0.115, 0.155, 0.1  # inch; a row, a bar of it that bears its number, a line of its name
FEWEST_ROWS: Final = 4  # fewer bars are no thicker than these
NAME_WIDTH, NAME_SIZE, NAME_LINES = 2.05, 9.0, 4  # inch, points; the longest possible names fit
LEAST_WRITTEN: Final = 0.95  # %; smaller shares have no number
DARK: Final = 0.62  # of the largest share; numbers are white above it
CELL_SIZE: Final = 6.5  # points
FIELD, FIELD_LOG = "viridis", "viridis_r"


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
    axes.set_ylabel(_escaped(panel.y.words(int(12 * panel_height(panel)))), fontsize=10)
    label_angles(axes.yaxis, panel.y.unit)
    axes.set_yticks([]) if not panel.y.ticks else None


def _escaped(text: str) -> str:
    return legible(text, len(text))


def _room_above(panel: Panel) -> float:
    """Part of the span that stays free for words above lines."""
    worded = any(mark.upright and mark.words and mark.kind == "end" for mark in panel.marks)
    return WORDS_ROOM / (1 - WORDS_ROOM) if worded else 0.0


def _draw(axes: Axes, own: Filled | Outline | Line | Band | Points | Range | Cells | Field, *, alone: bool) -> None:
    colour, label = ("", None) if isinstance(own, Cells | Field) else (COLOURS[own.role], own.label or None)
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
            named = None if own.sign == "speck" else label
            axes.plot(own.x, own.y, color=colour, linestyle="", marker=SIGNS[own.sign], label=named, **look)
            if named != label:  # a speck is too small for a legend
                axes.plot([], [], color=colour, linestyle="", marker="o", label=label, **POINT)
        case Range():
            _draw_range(axes, own, colour, label)
        case Cells():
            draw_cells(axes, own)
        case Field():
            _draw_field(axes, own)
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


def _draw_field(axes: Axes, field: Field) -> None:
    norm: Any = LogNorm if field.log else Normalize
    shown = np.ma.masked_invalid(field.values)
    colours = FIELD_LOG if field.log else FIELD
    image = axes.pcolormesh(field.edges(upright=False), field.edges(upright=True), shown, cmap=colours, norm=norm())
    ticks: Any = {"ticks": LogLocator(subs=(1.0, 2.0, 5.0)), "format": "%g"} if field.log else {}
    figure: Any = axes.get_figure()
    bar = figure.colorbar(image, ax=axes, **ticks)
    bar.minorticks_off()
    bar.ax.tick_params(labelsize=8)
    bar.set_label(_escaped(field.words), fontsize=9)
    if field.written:
        for (row, column), value in np.ndenumerate(field.values):
            dark = np.isnan(value) or field.strength[row, column] > 0.5
            text = NOTHING if np.isnan(value) else f"{value:.3g}"
            place = float(field.x[column]), float(field.y[row])
            axes.text(*place, text, ha="center", va="center", fontsize=7.5, color=BLACK if dark else "white")


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


def _draw_lengths(axes: Axes, lengths: Lengths, index: int, count: int) -> None:
    height = 0.8 / count
    places = np.arange(len(lengths.values)) - 0.4 + (index + 0.5) * height
    colours = [COLOURS[role] for role in lengths.roles] or COLOURS[lengths.role]
    values = [value or 0.0 for value in lengths.values]
    drawn = axes.barh(places, values, height=0.9 * height, color=colours, alpha=0.8, label=lengths.label or None)
    axes.bar_label(drawn, labels=list(lengths.texts), fontsize=7, padding=2, color=BLACK)


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


# rows and cells -----------------------------------------------------------------------------------


def names_of(panel: Panel) -> list[str]:
    """Labels of a panel's rows in lines, whole."""
    names = panel.y.names if isinstance(panel.y, Names) else ()
    return [wrapped(name, NAME_WIDTH, NAME_SIZE, NAME_LINES) for name in names]


def panel_height(panel: Panel) -> float:
    """Height of a panel [inch]."""
    if not isinstance(panel.y, Names):
        return NUMBERS * panel.height
    labels = names_of(panel)
    lines = max((label.count("\n") + 1 for label in labels), default=1)
    bars = sum(isinstance(own, Lengths) for own in panel.series)
    if not bars:
        return max(ROW, LINE * lines) * len(labels) + 0.1
    return (max(LINE * lines, BAR * bars) + BETWEEN) * max(len(labels), FEWEST_ROWS)


def draw_cells(axes: Axes, cells: Cells) -> Artist:
    """Draw a matrix as an image with its numbers; the image."""
    colours = np.where(np.arange(len(cells.values))[:, None] < cells.coloured, cells.values, 0.0)
    most = max(float(np.nanmax(colours, initial=0.0)), LEAST_WRITTEN)
    image = axes.imshow(colours, aspect="auto", cmap="Blues", vmin=0.0, vmax=most)
    for (row, column), share in np.ndenumerate(cells.values):
        if share >= LEAST_WRITTEN:
            colour = "white" if colours[row, column] > DARK * most else BLACK
            axes.text(column, row, f"{share:.0f}", ha="center", va="center", fontsize=CELL_SIZE, color=colour)
    return image
