"""The pictures of a run: each measure's histogram with limits and published ranges, its contributors beside."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final, assert_never

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.gridspec import SubplotSpec
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from tol3d.report.bars import METHOD_WORDS, NAME_SIZE, draw_contributors, height_of_contributors, labels_of
from tol3d.report.canvas import (
    BLACK,
    METHOD_COLOURS,
    OUTSIDE,
    label_angles,
    new_figure,
    plain_axes,
    save_figure,
    title_axes,
)
from tol3d.report.column import columns_of, seated_text, shares_of
from tol3d.report.curve import Stepped, draw_curve, position_label
from tol3d.report.distribution import (
    AXIS_UNITS,
    NO_VALUES,
    RANGE_SIZE,
    column_colours,
    draw_distribution,
    draw_ranges,
    height_of_ranges,
    out_text,
    range_labels,
    ranged,
    samples_of,
    shown_span,
    values_label,
)
from tol3d.report.drawn_sample import FILL_OPACITY, DrawnSample, draw_ends, draw_samples
from tol3d.report.ends import QUANTILES_MEAN, is_bounded
from tol3d.report.heading import heading, shown_measures
from tol3d.report.label import widest, wrapped
from tol3d.report.number import UNIT_SIGNS, share_text, short_text
from tol3d.report.picture import MOST_TOGETHER, Pictures
from tol3d.report.shown_unit import shown_run
from tol3d.runs.summary.measure import MeasureSummary
from tol3d.runs.summary.run import RunSummary

WIDTH, CURVE_WORDS = 13.0, 9.5  # inch; of a picture, and of the words above a curve
HISTOGRAM_SHARE: Final = 2.2  # widths of the contributors' bars
BESIDE: Final = 1.3  # inch; of a histogram's numbers and margins
HEAD_SIZE: Final = 12.0  # points
CURVE_HEIGHT: Final = 3.7  # inch
SCALAR_HEIGHT: Final = 4.3
OVERVIEW_COLUMNS: Final = 3
OVERVIEW_HEIGHT: Final = 2.9  # inch, a row
OVERVIEW_WORDS: Final = 3.9


def draw_histogram(summary: RunSummary, path: Path, pictures: Pictures = Pictures.WORST) -> None:
    """Draw the measures of a run: of more than MOST_TOGETHER the worst, or an overview of all.

    Args:
        summary: of the run.
        path: ends in .png, .svg or .pdf.
        pictures: which of many measures are drawn; with all of them each has a picture of its own (`measure_files`).

    Raises:
        InputError: the picture cannot be written there.
    """
    few = len(summary.measures) <= MOST_TOGETHER
    match pictures:
        case Pictures.ALL if not few:
            figure = overview_figure(summary)
        case Pictures.ALL | Pictures.WORST:
            figure = histogram_figure(summary)
        case _:
            assert_never(pictures)
    save_figure(figure, path)


def draw_measure(summary: RunSummary, name: str, path: Path) -> None:
    """Draw one measure of a run.

    Raises:
        InputError: the picture cannot be written there.
    """
    save_figure(histogram_figure(of_measures(summary, [name])), path)


def of_measures(summary: RunSummary, names: Sequence[str]) -> RunSummary:
    """A summary with some of its measures alone."""
    return summary.model_copy(update={"measures": {name: summary.measures[name] for name in names}})


def histogram_figure(summary: RunSummary) -> Figure:
    """Measures of a summary one below the other, of many the worst, not yet written."""
    names, count = shown_measures(summary.measures, MOST_TOGETHER), len(summary.measures)
    measures = shown_run(of_measures(summary, names)).measures
    heights = [_height(measure) for measure in measures.values()]
    worst = f"   ·   the {len(names)} worst of {count} measures" if len(names) < count else ""
    figure = _headed(summary, sum(heights) + 0.5, worst)
    scalars = [measure for measure in measures.values() if measure.take != "curve"]
    colours = column_colours([column for measure in scalars for column in columns_of(measure)])
    rows = figure.add_gridspec(len(measures), 1, height_ratios=heights, hspace=0.08)
    for row, (name, measure) in enumerate(measures.items()):
        if measure.take == "curve":
            axes = plain_axes(figure.add_subplot(rows[row, 0]))
            title_axes(axes, name, _words(measure), CURVE_WORDS)
            draw_curve(axes, name, measure)
        else:
            _draw_scalar(figure, rows[row, 0], name, measure, colours)
    return figure


def _headed(summary: RunSummary, height: float, more: str = "") -> Figure:
    figure = new_figure(WIDTH, height)
    failed = sum(count for status, count in summary.status.items() if status != "ok")
    words = f"{summary.scene}   ·   {summary.trials} trials, seed {summary.seed}"
    words += (f", {failed} failed" if failed else "") + more
    figure.suptitle(wrapped(words, WIDTH - 0.4, HEAD_SIZE, 2), fontsize=HEAD_SIZE, color=BLACK, x=0.01, ha="left")
    return figure


def _words(measure: MeasureSummary) -> str:
    """Description of a measure, with the number of trials in its picture if some of them failed."""
    seated = seated_text(measure)
    if not seated:
        return heading(measure)
    return f"{heading(measure)}; 3D simulation {seated}, out in all {share_text(measure.shares.out_ppm)}"


def _height(measure: MeasureSummary) -> float:
    """Height of a measure's row [inch]."""
    if measure.take == "curve":
        return CURVE_HEIGHT
    return max(SCALAR_HEIGHT + height_of_ranges(measure), height_of_contributors(measure))


def _words_width(measure: MeasureSummary) -> float:
    """Width that words above a histogram have [inch]: its own, which long labels of ranges and contributors lessen."""
    ranges = widest(range_labels(ranged(measure)), RANGE_SIZE)
    names = widest(labels_of(measure), NAME_SIZE)
    return (WIDTH - BESIDE - ranges - names) * HISTOGRAM_SHARE / (HISTOGRAM_SHARE + 1)


def _draw_scalar(
    figure: Figure, place: SubplotSpec, name: str, measure: MeasureSummary, colours: Mapping[str, str]
) -> None:
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
    label_angles(ranges.xaxis, measure.unit)
    ranges.set_xlabel(values_label(name, measure.unit), fontsize=10)
    if shares:
        draw_contributors(figure.add_subplot(halves[0, 1]), measure, colours)


# overview -----------------------------------------------------------------------------------------


def overview_figure(summary: RunSummary) -> Figure:
    """Every measure of a run small, several in a row, not yet written."""
    measures = shown_run(summary).measures
    rows = -(-len(measures) // OVERVIEW_COLUMNS)
    figure = _headed(summary, OVERVIEW_HEIGHT * rows + 0.5)
    methods = dict.fromkeys(measure.best_method for measure in measures.values())
    marks: list[Artist] = [
        Patch(facecolor=METHOD_COLOURS[method], alpha=FILL_OPACITY, label=METHOD_WORDS[method]) for method in methods
    ]
    if "geometric" in methods:
        marks.append(Line2D([], [], color=METHOD_COLOURS["analytic"], linewidth=2.0, label=METHOD_WORDS["analytic"]))
    marks.append(Line2D([], [], color=OUTSIDE, linewidth=2.0, label="limits"))
    figure.legend(handles=marks, loc="upper right", ncols=len(marks), fontsize=9, frameon=False)
    grid = figure.add_gridspec(rows, OVERVIEW_COLUMNS)
    for index, (name, measure) in enumerate(measures.items()):
        axes = plain_axes(figure.add_subplot(grid[divmod(index, OVERVIEW_COLUMNS)]))
        (_small_curve if measure.take == "curve" else _small_histogram)(axes, name, measure)
    return figure


def _small_histogram(axes: Axes, name: str, measure: MeasureSummary) -> None:
    unit, samples = measure.unit, samples_of(measure)
    axes.set_yticks([])
    if not samples:
        title_axes(axes, name, NO_VALUES, OVERVIEW_WORDS)
        return
    title_axes(axes, name, _small_words(measure, samples[0]), OVERVIEW_WORDS)
    draw_samples(axes, samples)
    axes.set_xlim(*shown_span(measure, [sample.bars for sample in samples]))
    draw_ends(axes, samples[0])
    low, high = axes.get_xlim()
    for limit in measure.limits:
        if limit is not None and low <= limit <= high:
            axes.axvline(limit, color=OUTSIDE, linewidth=2.0)
    label_angles(axes.xaxis, unit)
    axes.locator_params(axis="x", nbins=5) if unit != "arcmin" else None
    axes.set_xlabel(f"[{AXIS_UNITS.get(unit, UNIT_SIGNS[unit])}]", fontsize=9)


def _small_words(measure: MeasureSummary, leading: DrawnSample) -> str:
    """Mean and ends of the leading method, and what is out of its limits."""
    words = ", ".join(f"{word} {short_text(value, measure.unit)}" for word, value in leading.known_ends)
    shares = measure.shares
    sides = zip(("below", "above"), (shares.below_limit_ppm, shares.above_limit_ppm), measure.limits, strict=True)
    out = [out_text(ppm, side) for side, ppm, limit in sides if limit is not None]
    return "; ".join([words, *out, *([seated] if (seated := seated_text(measure)) else [])])


def _small_curve(axes: Axes, name: str, measure: MeasureSummary) -> None:
    colour, stepped = METHOD_COLOURS[measure.best_method], Stepped(measure)
    title_axes(axes, name, "mean and ±3 sigma", OVERVIEW_WORDS)
    if own := measure.curve_sample(measure.best_method):
        mean, sigma = stepped(own.mean), stepped(own.sigma)
        axes.plot(stepped.x, mean, color=colour, linewidth=2)
        axes.fill_between(stepped.x, mean - 3 * sigma, mean + 3 * sigma, color=colour, alpha=0.28, linewidth=0)
    for limit in measure.limits:
        if limit is not None:
            axes.axhline(limit, color=OUTSIDE, linewidth=2.0)
    label_angles(axes.yaxis, measure.unit)
    axes.set_xlabel(position_label(measure), fontsize=9)
    axes.set_ylabel(f"[{AXIS_UNITS.get(measure.unit, UNIT_SIGNS[measure.unit])}]", fontsize=9)
