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
from tol3d.report.html.axis import Axis, Frame, below, beside, chart
from tol3d.report.html.tags import Markup, tag
from tol3d.report.label import legible
from tol3d.report.number import limit_text, short_text
from tol3d.runs.summary.measure import MeasureSummary

TOP, BOTTOM = 58.0, 304.0
"""Ends of the bars; words of mean and ends, and in two lines of limits, stand above."""
LETTER: Final = 6.2
"""Width of a letter, about."""
RANGE: Final = 22.0
"""Height of the line of a column below."""
CURVE_POINTS: Final = 121
FOOT: Final = 44.0


def histogram_chart(name: str, measure: MeasureSummary, frame: Frame) -> Markup:
    """A measure of one number a trial."""
    samples = samples_of(measure)
    if not samples:
        return tag("p", NO_VALUES, class_="warning")
    span = shown_span(measure, [sample.bars for sample in samples])
    x = frame.across(*span, measure.unit)
    form = measure.analytic_closed_form
    peak = max(float(sample.bars.density.max()) for sample in samples)
    y = Axis(0.0, 1.05 * peak or 1.0, start=BOTTOM, end=TOP)
    columns = ranged(measure)
    bottom = BOTTOM + 14 + RANGE * len(columns)
    inside = [
        *below(x, TOP, bottom, values_label(name, measure.unit)),
        *beside(y, frame, density_label(measure.unit)),
        *_bars(samples[0], x, y, measure),
        *(_outline(own, x, y) for own in samples[1:]),
    ]
    if form and form.sigma:
        inside.append(_normal(form.mean, form.sigma, x, y))
    inside += [*_ends(samples[0], x, measure.unit, frame), *_limits(measure, x, frame), *_ranges(measure, x, frame)]
    return chart(frame, f"histogram of {name}", bottom + FOOT, *inside)


def _bars(sample: DrawnSample, x: Axis, y: Axis, measure: MeasureSummary) -> Iterator[Markup]:
    """Each bar with its values and number of trials in a tooltip, in two pieces where a limit runs through it."""
    bars, pieces = sample.bars, sample.pieces
    for k, bar in enumerate(pieces.bars):
        count = bars.counts[bar]
        if not count:
            continue
        low, high = (short_text(float(edge), measure.unit) for edge in bars.edges[bar : bar + 2])
        cut = " on both sides of the limit" if np.count_nonzero(pieces.bars == bar) > 1 else ""
        left, right, top = x(float(pieces.edges[k])), x(float(pieces.edges[k + 1])), y(float(bars.density[bar]))
        yield tag(
            "rect",
            tag("title", f"{low} to {high}: {count:.0f} trials{cut}"),
            x=left + 0.4,
            y=top,
            width=max(right - left - 0.8, 0.3),
            height=BOTTOM - top,
            class_="beyond" if pieces.outside[k] else measure.best_method,
            data_bar=int(bar),
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


def _ends(sample: DrawnSample, x: Axis, unit: str, frame: Frame) -> Iterator[Markup]:
    """Dotted lines at mean and ends, with words above where there is room."""
    free = 0.0
    for word, value in sample.known_ends:
        place = x(value)
        yield tag("path", d=f"M{place:.1f} {TOP:.1f}V{BOTTOM:.1f}", class_="dotted")
        text = f"{word} {short_text(value, unit)}"
        wide = LETTER * len(text)
        starts = min(max(place - wide / 2, 0.0), frame.width - wide)
        if starts >= free:
            yield tag("text", text, x=starts + wide / 2, y=TOP - 6, text_anchor="middle", class_="tick")
            free = starts + wide


def _limits(measure: MeasureSummary, x: Axis, frame: Frame) -> Iterator[Markup]:
    """Lines at limits, and above them their words: those of the upper one higher where both find no room in a line."""
    shares, free = measure.shares, 0.0
    sides = (("LSL", "below", shares.below_limit_ppm), ("USL", "above", shares.above_limit_ppm))
    for limit, (word, side, ppm) in zip(measure.limits, sides, strict=True):
        if limit is None:
            continue
        inside = x.low <= limit <= x.high
        place = x(min(max(limit, x.low), x.high))
        words = f"{word} {limit_text(limit, measure.unit)}, {out_text(ppm, side)}"
        if not inside:
            words = f"◄ {words}" if side == "below" else f"{words} ►"
        wide = LETTER * len(words)
        starts = min(max(place + 5 if place < frame.width / 2 else place - 5 - wide, 0.0), max(frame.width - wide, 0.0))
        height = TOP - (24 if starts >= free else 38)
        free = starts + wide
        if inside:
            yield tag("path", tag("title", words), d=f"M{place:.1f} {height + 2:.1f}V{BOTTOM:.1f}", class_="limit")
        after = starts + wide / 2 < place
        yield tag(
            "text",
            words,
            x=min(starts + wide, frame.width) if after else starts,
            y=height,
            text_anchor="end" if after else "start",
            class_="tick limit-words",
        )


def _ranges(measure: MeasureSummary, x: Axis, frame: Frame) -> Iterator[Markup]:
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
        yield tag(
            "text",
            legible(METHOD_WORDS.get(column.method, column.heading), 2 * frame.letters),
            x=4.0,
            y=y - 4,
            class_="tick",
        )
