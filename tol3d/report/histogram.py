"""The pictures of a run: each measure's histogram with limits and published ranges, its contributors beside."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.gridspec import SubplotSpec
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from tol3d.report.bars import bars_of
from tol3d.report.canvas import (
    BLACK,
    GREY,
    OUTSIDE,
    ROAD_COLOURS,
    label_angles,
    new_figure,
    plain_axes,
    save_figure,
    title_axes,
)
from tol3d.report.column import best_road, columns_of, seated_text, shares_of
from tol3d.report.contributor_bars import NAME_SIZE, ROAD_WORDS, draw_contributors, height_of_contributors, labels_of
from tol3d.report.curve import Stepped, draw_curve, position_label
from tol3d.report.distribution import (
    AXIS_UNITS,
    NO_VALUES,
    RANGE_SIZE,
    column_colours,
    draw_bars,
    draw_distribution,
    draw_ranges,
    height_of_ranges,
    out_text,
    range_labels,
    shown_span,
    values_label,
)
from tol3d.report.ends import QUANTILES_MEAN, Ends, is_bounded
from tol3d.report.heading import heading
from tol3d.report.label import widest, wrapped
from tol3d.report.number import UNIT_SIGNS, share_text, short_text
from tol3d.report.picture import measure_files

Summary = Any  # typed, read by text

WIDTH, CURVE_WORDS = 13.0, 9.5  # inch; of a picture, and of the words above a curve
HISTOGRAM_SHARE: Final = 2.2  # widths of the contributors' bars
BESIDE: Final = 1.3  # inch; of a histogram's numbers and margins
HEAD_SIZE: Final = 12.0  # points
CURVE_HEIGHT: Final = 3.7  # inch
SCALAR_HEIGHT: Final = 4.3
OVERVIEW_COLUMNS: Final = 3
OVERVIEW_HEIGHT: Final = 2.9  # inch, a row
OVERVIEW_WORDS: Final = 3.6


def draw_histogram(summary: Summary, path: Path) -> None:
    """Draw the measures of a run, an overview of them where each has a picture of its own (see `measure_files`).

    Args:
        summary: of the run.
        path: ends in .png, .svg or .pdf.

    Raises:
        InputError: the picture cannot be written there.
    """
    draw = overview_figure if measure_files(summary) else histogram_figure
    save_figure(draw(summary), path)


def draw_measure(summary: Summary, name: str, path: Path) -> None:
    """Draw one measure of a run.

    Raises:
        InputError: the picture cannot be written there.
    """
    save_figure(histogram_figure({**summary, "measures": {name: summary["measures"][name]}}), path)


def histogram_figure(summary: Summary) -> Figure:
    """All measures of a summary one below the other, not yet written."""
    measures = summary["measures"]
    heights = [_height(measure) for measure in measures.values()]
    figure = _headed(summary, sum(heights) + 0.5)
    scalars = [measure for measure in measures.values() if measure["take"] != "curve"]
    colours = column_colours([column for measure in scalars for column in columns_of(measure)])
    rows = figure.add_gridspec(len(measures), 1, height_ratios=heights, hspace=0.08)
    for row, (name, measure) in enumerate(measures.items()):
        if measure["take"] == "curve":
            axes = plain_axes(figure.add_subplot(rows[row, 0]))
            title_axes(axes, name, _words(measure), CURVE_WORDS)
            draw_curve(axes, name, measure)
        else:
            _draw_scalar(figure, rows[row, 0], name, measure, colours)
    return figure


def _headed(summary: Summary, height: float) -> Figure:
    figure = new_figure(WIDTH, height)
    failed = sum(count for status, count in summary["status"].items() if status != "ok")
    words = f"{summary['scene']}   ·   {summary['trials']} trials, seed {summary['seed']}"
    words += f", {failed} failed" if failed else ""
    figure.suptitle(wrapped(words, WIDTH - 0.4, HEAD_SIZE, 2), fontsize=HEAD_SIZE, color=BLACK, x=0.01, ha="left")
    return figure


def _words(measure: Summary) -> str:
    """What a measure is, and of how many trials its picture is where some of them failed."""
    seated = seated_text(measure)
    if not seated:
        return heading(measure)
    out = measure["curve"]["geometric"] if measure["take"] == "curve" else measure["geometric"]
    return f"{heading(measure)}; 3D simulation {seated}, out in all {share_text(out.get('out_ppm'))}"


def _height(measure: Summary) -> float:
    """Height of a measure's row [inch]."""
    if measure["take"] == "curve":
        return CURVE_HEIGHT
    return max(SCALAR_HEIGHT + height_of_ranges(measure), height_of_contributors(measure))


def _words_width(measure: Summary) -> float:
    """Width that words above a histogram have [inch]: its own, which long labels of ranges and contributors lessen."""
    ranges = widest(range_labels(columns_of(measure)), RANGE_SIZE)
    names = widest(labels_of(measure), NAME_SIZE)
    return (WIDTH - BESIDE - ranges - names) * HISTOGRAM_SHARE / (HISTOGRAM_SHARE + 1)


def _draw_scalar(figure: Figure, place: SubplotSpec, name: str, measure: Summary, colours: Mapping[str, str]) -> None:
    shares = shares_of(measure)
    halves = place.subgridspec(1, 2, width_ratios=[HISTOGRAM_SHARE, 1])
    left = halves[0, 0] if shares else place
    below = height_of_ranges(measure) + 0.15
    parts = left.subgridspec(2, 1, height_ratios=[_height(measure) - below - 0.9, below], hspace=0.02)
    axes = plain_axes(figure.add_subplot(parts[0, 0]))
    words = _words(measure) + (QUANTILES_MEAN if is_bounded(measure) else "")
    title_axes(axes, name, words, _words_width(measure) if shares else CURVE_WORDS)
    draw_distribution(axes, measure)
    ranges = figure.add_subplot(parts[1, 0], sharex=axes)
    draw_ranges(ranges, measure, colours)
    axes.tick_params(labelbottom=False)
    label_angles(ranges.xaxis, measure["unit"])
    ranges.set_xlabel(values_label(name, measure["unit"]), fontsize=10)
    if shares:
        draw_contributors(figure.add_subplot(halves[0, 1]), measure, colours)


# overview -----------------------------------------------------------------------------------------


def overview_figure(summary: Summary) -> Figure:
    """Every measure of a run small, several in a row, not yet written."""
    measures = summary["measures"]
    rows = -(-len(measures) // OVERVIEW_COLUMNS)
    figure = _headed(summary, OVERVIEW_HEIGHT * rows + 0.5)
    roads = dict.fromkeys(best_road(measure) for measure in measures.values())
    marks: list[Artist] = [Patch(facecolor=ROAD_COLOURS[road], alpha=0.55, label=ROAD_WORDS[road]) for road in roads]
    if "geometric" in roads:
        marks.append(Line2D([], [], color=ROAD_COLOURS["analytic"], linewidth=2.0, label=ROAD_WORDS["analytic"]))
    marks.append(Line2D([], [], color=OUTSIDE, linewidth=2.0, label="limits"))
    figure.legend(handles=marks, loc="upper right", ncols=len(marks), fontsize=9, frameon=False)
    grid = figure.add_gridspec(rows, OVERVIEW_COLUMNS)
    for index, (name, measure) in enumerate(measures.items()):
        axes = plain_axes(figure.add_subplot(grid[divmod(index, OVERVIEW_COLUMNS)]))
        (_small_curve if measure["take"] == "curve" else _small_histogram)(axes, name, measure)
    return figure


def _small_histogram(axes: Axes, name: str, measure: Summary) -> None:
    unit, bars = measure["unit"], bars_of(measure)
    axes.set_yticks([])
    if not bars:
        title_axes(axes, name, NO_VALUES, OVERVIEW_WORDS)
        return
    title_axes(axes, name, _small_words(measure), OVERVIEW_WORDS)
    draw_bars(axes, bars, measure)
    axes.set_xlim(*shown_span(measure, bars))
    own = next(column for column in columns_of(measure) if column.road == best_road(measure))
    ends = Ends.of(own, bounded=is_bounded(measure))
    for value in (ends.low, own.value("mean"), ends.high):
        if value is not None:
            axes.axvline(value, color=GREY, linewidth=1.0, linestyle=":")
    low, high = axes.get_xlim()
    for limit in (measure.get("lower_limit"), measure.get("upper_limit")):
        if limit is not None and low <= limit <= high:
            axes.axvline(limit, color=OUTSIDE, linewidth=2.0)
    label_angles(axes.xaxis, unit)
    axes.locator_params(axis="x", nbins=5) if unit != "arcmin" else None
    axes.set_xlabel(f"[{AXIS_UNITS.get(unit, UNIT_SIGNS[unit])}]", fontsize=9)


def _small_words(measure: Summary) -> str:
    """Mean and ends of the leading road, and what is out of its limits."""
    unit, road = measure["unit"], best_road(measure)
    own = next(column for column in columns_of(measure) if column.road == road)
    ends, mean = Ends.of(own, bounded=is_bounded(measure)), own.value("mean")
    known = [(ends.words[0], ends.low), ("mean", mean), (ends.words[1], ends.high)]
    words = ", ".join(f"{word} {short_text(value, unit)}" for word, value in known if value is not None)
    sides = (("below", "lower_limit"), ("above", "upper_limit"))
    out = [
        out_text(measure[road].get(f"{side}_limit_ppm"), side) for side, limit in sides
        if measure.get(limit) is not None
    ]  # fmt: skip
    return "; ".join([words, *out, *([seated] if (seated := seated_text(measure)) else [])])


def _small_curve(axes: Axes, name: str, measure: Summary) -> None:
    road = best_road(measure)
    title_axes(axes, name, "mean and ±3 sigma", OVERVIEW_WORDS)
    stepped = Stepped(measure)
    mean, sigma = (stepped(measure["curve"][road][key]) for key in ("mean", "sigma"))
    axes.plot(stepped.x, mean, color=ROAD_COLOURS[road], linewidth=2)
    axes.fill_between(stepped.x, mean - 3 * sigma, mean + 3 * sigma, color=ROAD_COLOURS[road], alpha=0.28, linewidth=0)
    for limit in (measure.get("lower_limit"), measure.get("upper_limit")):
        if limit is not None:
            axes.axhline(limit, color=OUTSIDE, linewidth=2.0)
    label_angles(axes.yaxis, measure["unit"])
    axes.set_xlabel(position_label(measure), fontsize=9)
    axes.set_ylabel(f"[{AXIS_UNITS.get(measure['unit'], UNIT_SIGNS[measure['unit']])}]", fontsize=9)
