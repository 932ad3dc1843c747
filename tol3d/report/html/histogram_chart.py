"""Histograms of a measure as SVG: both methods, the closed form, limits with what is beyond, mean and ends."""

import math
from collections.abc import Iterator
from typing import Final

import numpy as np

from tol3d.report.bars import METHOD_WORDS, Bars
from tol3d.report.column import columns_of
from tol3d.report.distribution import (
    NO_VALUES,
    column_colours,
    density_label,
    out_text,
    ranged,
    samples_of,
    shown_span,
    values_label,
)
from tol3d.report.drawn_sample import DrawnSample
from tol3d.report.ends import Ends, is_bounded
from tol3d.report.html.axis import LEFT, RIGHT, WIDTH, Axis, below, beside, chart
from tol3d.report.html.tags import Markup, tag
from tol3d.report.number import limit_text, short_text
from tol3d.runs.summary.measure import MeasureSummary

TOP, BOTTOM = 44.0, 290.0
"""Ends of the bars; words of mean, ends and limits stand above."""
RANGE: Final = 22.0
"""Height of the line of a column below."""
CURVE_POINTS: Final = 121
FOOT: Final = 44.0


def histogram_chart(name: str, measure: MeasureSummary) -> Markup:
    """A measure of one number a trial."""
    samples = samples_of(measure)
    if not samples:
        return tag("p", NO_VALUES, class_="warning")
    span = shown_span(measure, [sample.bars for sample in samples])
    x = Axis(*span, unit=measure.unit)
    form = measure.analytic_closed_form
    peak = max(float(sample.bars.density.max()) for sample in samples)
    y = Axis(0.0, 1.05 * peak or 1.0, start=BOTTOM, end=TOP)
    columns = ranged(measure)
    bottom = BOTTOM + 14 + RANGE * len(columns)
    inside = [
        *below(x, TOP, bottom, values_label(name, measure.unit)),
        *beside(y, LEFT, WIDTH - RIGHT, density_label(measure.unit)),
        *_bars(samples[0], x, y, measure),
        *(_outline(own, x, y) for own in samples[1:]),
    ]
    if form and form.sigma:
        inside.append(_normal(form.mean, form.sigma, x, y))
    inside += [*_ends(samples[0], x, measure.unit), *_limits(measure, x), *_ranges(measure, x)]
    return chart(f"histogram of {name}", bottom + FOOT, *inside)


def _bars(sample: DrawnSample, x: Axis, y: Axis, measure: MeasureSummary) -> Iterator[Markup]:
    """Each bar with its values and number of trials in a tooltip."""
    bars = sample.bars
    for k, (density, count) in enumerate(zip(bars.density, bars.counts, strict=True)):
        if not count:
            continue
        low, high = float(bars.edges[k]), float(bars.edges[k + 1])
        words = f"{short_text(low, measure.unit)} to {short_text(high, measure.unit)}: {count:.0f} trials"
        left, right, top = x(low), x(high), y(float(density))
        yield tag(
            "rect",
            tag("title", words),
            x=left + 0.4,
            y=top,
            width=max(right - left - 0.8, 0.3),
            height=BOTTOM - top,
            class_="beyond" if sample.outside[k] else measure.best_method,
            data_bar=k,
        )


def _outline(sample: DrawnSample, x: Axis, y: Axis) -> Markup:
    return tag("path", d=steps(sample.bars, x, y), class_="line analytic")


def steps(bars: Bars, x: Axis, y: Axis) -> str:
    """The outline of bars as a path."""
    path = [f"M{x(float(bars.edges[0])):.1f} {y(0.0):.1f}"]
    path += [f"V{y(float(d)):.1f}H{x(float(edge)):.1f}" for d, edge in zip(bars.density, bars.edges[1:], strict=True)]
    return "".join([*path, f"V{y(0.0):.1f}"])


def _normal(mean: float, sigma: float, x: Axis, y: Axis) -> Markup:
    values = np.linspace(x.low, x.high, CURVE_POINTS)
    density = 100 * np.exp(-(((values - mean) / sigma) ** 2) / 2) / (sigma * math.sqrt(2 * math.pi))
    points = "L".join(f"{x(float(v)):.1f} {max(y(float(d)), 2.0):.1f}" for v, d in zip(values, density, strict=True))
    return tag("path", tag("title", "closed form"), d=f"M{points}", class_="line closed")


def _ends(sample: DrawnSample, x: Axis, unit: str) -> Iterator[Markup]:
    """Dotted lines at mean and ends, with words above where there is room."""
    free = -math.inf
    for word, value in sample.known_ends:
        place = x(value)
        yield tag("path", d=f"M{place:.1f} {TOP:.1f}V{BOTTOM:.1f}", class_="dotted")
        text = f"{word} {short_text(value, unit)}"
        half = 3.2 * len(text)
        if place - half > free:
            yield tag("text", text, x=place, y=TOP - 6, text_anchor="middle", class_="tick")
            free = place + half


def _limits(measure: MeasureSummary, x: Axis) -> Iterator[Markup]:
    shares = measure.shares
    sides = (("LSL", "below", shares.below_limit_ppm), ("USL", "above", shares.above_limit_ppm))
    for limit, (word, side, ppm) in zip(measure.limits, sides, strict=True):
        if limit is None:
            continue
        lower, inside = side == "below", x.low <= limit <= x.high
        place = x(min(max(limit, x.low), x.high))
        words = f"{word} {limit_text(limit, measure.unit)}, {out_text(ppm, side)}"
        if inside:
            yield tag("path", tag("title", words), d=f"M{place:.1f} {TOP - 22:.1f}V{BOTTOM:.1f}", class_="limit")
        else:
            words = f"◄ {words}" if lower else f"{words} ►"
        starts = place < WIDTH / 2
        yield tag(
            "text",
            words,
            x=place + (5 if starts else -5),
            y=TOP - 24,
            text_anchor="start" if starts else "end",
            class_="tick limit-words",
        )


def _ranges(measure: MeasureSummary, x: Axis) -> Iterator[Markup]:
    """A line for each column, ours and published, from end to end, its mean as a dot."""
    bounded, colours = is_bounded(measure), column_colours(columns_of(measure))
    for row, column in enumerate(ranged(measure)):
        y = BOTTOM + 24 + RANGE * row
        ends, mean = Ends.of(column, bounded=bounded), column.value("mean")
        known = [own for own in (ends.low, mean, ends.high) if own is not None]
        words = f"{column.heading}: " + " … ".join(short_text(own, measure.unit) for own in known)
        kind = column.method.replace(" ", "-")
        colour = colours[column.heading] if column.method == "published" else None
        if ends.low is not None and ends.high is not None:
            path = f"M{x(ends.low):.1f} {y:.1f}H{x(ends.high):.1f}"
            yield tag("path", tag("title", words), d=path, class_=f"range {kind}", stroke=colour)
        if mean is not None:
            yield tag("circle", tag("title", words), cx=x(mean), cy=y, r=4.0, class_=f"dot {kind}", fill=colour)
        yield tag("text", METHOD_WORDS.get(column.method, column.heading), x=LEFT - 60, y=y - 4, class_="tick")
