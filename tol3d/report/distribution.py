"""Distribution of a measure: histograms of both methods, limits, and the range of every column."""

import math
from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np
from matplotlib.axes import Axes

from tol3d.report.bars import Bars, bars_of
from tol3d.report.canvas import (
    BLACK,
    METHOD_COLOURS,
    OUTSIDE,
    PUBLISHED_COLOURS,
    say_instead,
)
from tol3d.report.column import Column, columns_of
from tol3d.report.drawn_sample import LINE_TOP, DrawnSample, draw_ends, draw_samples, name_ends
from tol3d.report.ends import Ends, is_bounded
from tol3d.report.label import legible, wrapped
from tol3d.report.number import UNIT_SIGNS, limit_text, share_text
from tol3d.runs.summary.measure import MeasureSummary
from tol3d.runs.summary.values import Section

SIGMAS_SHOWN: Final = 3.6  # of the mean; a little more than the +-3 sigma that are marked
LIMIT_REACH: Final = 0.6  # of the shown span; a limit further off is named at the edge, not drawn to scale
NO_VALUES: Final = "no trial gave a value"
AXIS_UNITS: Final = {"arcmin": "′, ″ of arc"}  # where an axis has other words than a number
RANGE_LABEL, RANGE_SIZE = 1.9, 8.5  # inch, points
RANGE_HEIGHT, RANGE_LINE = 0.24, 0.155  # inch; of a range, and of a line of its label


def values_label(name: str, unit: str, longest: int = 80) -> str:
    """Label of an axis of a measure's values."""
    return f"{legible(name, longest)} [{AXIS_UNITS.get(unit, UNIT_SIGNS[unit])}]"


def density_label(unit: str) -> str:
    """Label of an axis of a histogram's densities."""
    return f"% of trials per {UNIT_SIGNS[unit]}"


def _passed(limit: float | None, farthest: float | None, sense: float) -> float | None:
    """A limit, if any trial is beyond it: a bar across one that none is beyond is not out."""
    kept = limit is None or (farthest is not None and sense * (farthest - limit) <= 0.0)
    return None if kept else limit


def samples_of(measure: MeasureSummary) -> list[DrawnSample]:
    """Both methods' samples of a measure: the leading one filled, with its ends and limits, a stack-up's as outline."""
    bars, leading = bars_of(measure), measure.best_method
    if not bars:
        return []
    own, (lower, upper) = leading_column(measure), measure.limits
    filled = DrawnSample(
        label=None,
        colour=METHOD_COLOURS[leading],
        bars=bars[leading],
        mean=own.value("mean"),
        ends=Ends.of(own, bounded=is_bounded(measure)),
        limits=(_passed(lower, own.value("sample_min"), -1.0), _passed(upper, own.value("sample_max"), 1.0)),
    )
    beside = [DrawnSample(None, METHOD_COLOURS["analytic"], bars["analytic"], line="solid")]
    return [filled, *(beside if leading != "analytic" else [])]


def leading_column(measure: MeasureSummary) -> Column:
    """The column of the method by which a measure is shown."""
    return next(column for column in columns_of(measure) if column.method == measure.best_method)


def draw_distribution(axes: Axes, measure: MeasureSummary) -> None:
    """Both methods' histograms over each other, the closed form's normal curve, limits, mean and ends of the trials."""
    samples = samples_of(measure)
    if not samples:
        say_instead(axes, NO_VALUES, OUTSIDE)
        return
    colours = column_colours(columns_of(measure))
    histograms = {
        name: _published_bars(own["histogram"], own.value("trials"))
        for name, own in measure.published.items()
        if "histogram" in own
    }
    span = shown_span(measure, [*(sample.bars for sample in samples), *histograms.values()])
    draw_samples(axes, samples)
    form = measure.analytic_closed_form
    if form and form.sigma:
        x = np.linspace(*span, 400)
        normal = 100 * np.exp(-(((x - form.mean) / form.sigma) ** 2) / 2) / (form.sigma * math.sqrt(2 * math.pi))
        axes.plot(x, normal, color=BLACK, linewidth=1.2, linestyle=(0, (5, 3)))
    peaks = [float(sample.bars.density.max()) for sample in samples]
    peaks += [_draw_published(axes, own, colours[name]) for name, own in histograms.items()]
    axes.set_ylim(0, 1.25 * max(peaks))
    axes.set_xlim(*span)
    draw_ends(axes, samples[0], LINE_TOP)
    name_ends(axes, samples[0], measure.unit, span)
    _mark_limits(axes, measure, span)
    axes.ticklabel_format(axis="y", style="plain")  # a power of ten would stand in the words above
    axes.set_ylabel(density_label(measure.unit), fontsize=10)


def _published_bars(own: Section, trials: float | None) -> Bars:
    """A published histogram, with its number of trials if stated."""
    counts = np.asarray(own["counts"], dtype=np.float64)
    edges = own["lower_edge"] + own["bin_width"] * np.arange(len(counts) + 1, dtype=np.float64)
    return Bars(edges, counts, max(float(counts.sum()), trials or 0.0))


def _draw_published(axes: Axes, bars: Bars, colour: str) -> float:
    """A published histogram as an outline; returns its highest density."""
    axes.stairs(bars.density, bars.edges, color=colour, linewidth=1.4)
    return float(bars.density.max())


def shown_span(measure: MeasureSummary, bars: Sequence[Bars]) -> tuple[float, float]:
    """Range of the axis: every bar, the ends of every column, and limits that are not far off."""
    lows = [float(b.edges[0]) for b in bars]
    highs = [float(b.edges[-1]) for b in bars]
    bounded = is_bounded(measure)
    for column in columns_of(measure):
        found = Ends.of(column, bounded=bounded)
        mean, sigma = column.value("mean"), column.value("sigma")
        spread = () if mean is None or not sigma else (mean - SIGMAS_SHOWN * sigma, mean + SIGMAS_SHOWN * sigma)
        ends = [end for end in (*(() if bounded else spread), found.low, mean, found.high) if end is not None]
        lows += ends
        highs += ends
    low, high = min(lows), max(highs)
    reach = LIMIT_REACH * (high - low)
    limits = [limit for limit in measure.limits if limit is not None]
    near = [limit for limit in limits if low - reach <= limit <= high + reach]
    low, high = min([low, *near]), max([high, *near])
    margin = 0.03 * (high - low) or max(1e-3 * abs(low), 1e-3)
    return low - margin, high + margin


# what is marked -----------------------------------------------------------------------------------


def out_text(ppm: float | None, side: str) -> str:
    """Fraction of all trials on the wrong side of a limit.

    >>> out_text(0.0, "below"), out_text(27_000.0, "above")
    ('none below', '2.7 % above')
    """
    return f"{share_text(ppm) if ppm != 0 else 'none'} {side}"


def _mark_limits(axes: Axes, measure: MeasureSummary, span: tuple[float, float]) -> None:
    unit, shares = measure.unit, measure.shares
    sides = (("LSL", "below", shares.below_limit_ppm), ("USL", "above", shares.above_limit_ppm))
    for limit, (word, side, ppm) in zip(measure.limits, sides, strict=True):
        if limit is None:
            continue
        lower = side == "below"
        text = f"{word} {limit_text(limit, unit)}\n{out_text(ppm, side)}"
        inside = span[0] <= limit <= span[1]
        if inside:
            axes.axvline(limit, ymax=LINE_TOP, color=OUTSIDE, linewidth=2.0)
        else:
            text = f"◄ {text}" if lower else f"{text} ►"
        axes.annotate(
            text,
            (min(max(limit, span[0]), span[1]), 0.72),
            xycoords=("data", "axes fraction"),
            xytext=(5 if lower else -5, 0),
            textcoords="offset points",
            ha="left" if lower else "right",
            fontsize=9,
            color=OUTSIDE,
            bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.75, "pad": 1.5},
        )


# the ranges of all columns ------------------------------------------------------------------------


def column_colours(columns: Sequence[Column]) -> dict[str, str]:
    """A colour for each column by its heading: the methods have their own, published ones get the others in turn."""
    published = dict.fromkeys(column.heading for column in columns if column.method == "published")
    colours = {name: PUBLISHED_COLOURS[k % len(PUBLISHED_COLOURS)] for k, name in enumerate(published)}
    return colours | {c.heading: METHOD_COLOURS[c.method] for c in columns if c.method != "published"}


def range_labels(columns: Sequence[Column]) -> list[str]:
    """The columns' headings in lines, whole."""
    return [wrapped(column.heading, RANGE_LABEL, RANGE_SIZE, 4) for column in columns]


def ranged(measure: MeasureSummary) -> list[Column]:
    """The columns that have something to draw; others publish what a table alone can show."""
    bounded = is_bounded(measure)
    return [column for column in columns_of(measure) if _is_drawn(measure, column, Ends.of(column, bounded=bounded))]


def _is_drawn(measure: MeasureSummary, column: Column, ends: Ends) -> bool:
    known = (ends.low, ends.high, column.value("mean"))
    return known != (None, None, None) or "histogram" in measure.published.get(column.heading, {})


def height_of_ranges(measure: MeasureSummary) -> float:
    """Height that the ranges of a measure need with their headings [inch]."""
    labels = range_labels(ranged(measure))
    lines = max((label.count("\n") + 1 for label in labels), default=1)
    return max(RANGE_HEIGHT, RANGE_LINE * lines) * len(labels)


def draw_ranges(axes: Axes, measure: MeasureSummary, colours: Mapping[str, str]) -> None:
    """One line a column below the histogram: from end to end, one known end alone, the mean as a dot."""
    columns, bounded = ranged(measure), is_bounded(measure)
    for row, column in enumerate(columns):
        colour, ends, mean = colours[column.heading], Ends.of(column, bounded=bounded), column.value("mean")
        if ends.low is not None and ends.high is not None:
            axes.plot([ends.low, ends.high], [row, row], color=colour, linewidth=5, solid_capstyle="butt", alpha=0.75)
        else:
            alone = [end for end in (ends.low, ends.high) if end is not None]
            axes.plot(alone, [row] * len(alone), marker="|", markersize=9, markeredgewidth=3, color=colour)
        if mean is not None:
            axes.plot(mean, row, marker="o", markersize=6, color=colour, markeredgecolor="white")
    axes.set_yticks(range(len(columns)), range_labels(columns), fontsize=RANGE_SIZE)
    axes.set_ylim(len(columns) - 0.4, -0.6)
    axes.tick_params(axis="y", length=0)
    axes.tick_params(axis="x", labelsize=9, color="#999999")
    axes.grid(axis="x", color="#E6E6E6", linewidth=0.7)
    axes.set_axisbelow(True)
    for side in ("top", "right", "left"):
        axes.spines[side].set_visible(False)
