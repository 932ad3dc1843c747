"""Convergence of mean and sigma with the number of trials, as SVG, with the 95 % range of other draws."""

import math
from collections.abc import Iterator
from typing import Final

import numpy as np

from tol3d.numerics.arrays import Array
from tol3d.report.convergence import CONFIDENCE, Convergence
from tol3d.report.distribution import values_label
from tol3d.report.html.axis import Axis, Frame, beside, chart
from tol3d.report.html.tags import Markup, tag
from tol3d.runs.summary.measure import MeasureSummary

TOP, HIGH, GAP, FOOT = 14.0, 92.0, 16.0, 44.0
POINTS: Final = 48
"""Numbers of trials at which it is drawn."""


def convergence_chart(measure: MeasureSummary, own: Convergence, frame: Frame, factor: float = 1.0) -> Markup:
    """Mean above sigma over the number of trials.

    Args:
        measure: in the unit that is shown.
        own: in the measure's unit of files.
        frame: width that it is drawn for.
        factor: from that to the one that is shown.
    """
    first, last = float(own.counts[0]), float(own.counts[-1])
    x = frame.across(math.log10(first), math.log10(last) if last > first else math.log10(first) + 1.0)
    inside = list[Markup]()
    rows = (("mean", own.mean, own.mean_error), ("sigma", own.sigma, own.sigma_error))
    for row, (word, values, errors) in enumerate(rows):
        top = TOP + row * (HIGH + GAP)
        inside += _panel(word, factor * values, factor * CONFIDENCE * errors, own.counts, measure, x, top, frame)
    bottom = TOP + 2 * HIGH + GAP
    for value, words in _decades(first, last):
        inside.append(tag("text", words, x=x(value), y=bottom + 15, text_anchor="middle", class_="tick"))
    label = "trials, with what 95 % of other draws would give"
    inside.append(tag("text", label, x=frame.middle, y=bottom + 33, text_anchor="middle", class_="label"))
    return chart(frame, "mean and sigma over the number of trials", bottom + FOOT, *inside)


def _panel(
    word: str, values: Array, reach: Array, counts: Array, measure: MeasureSummary, x: Axis, top: float, frame: Frame
) -> Iterator[Markup]:
    bottom, method = top + HIGH, measure.best_method
    low, high = float((values - reach).min()), float((values + reach).max())
    margin = 0.05 * (high - low) or 1.0
    y = Axis(low - margin, high + margin, start=bottom, end=top, unit=measure.unit)
    for value, _ in _decades(float(counts[0]), float(counts[-1])):
        yield tag("path", d=f"M{x(value):.1f} {top:.1f}V{bottom:.1f}", class_="grid")
    label = word if measure.unit == "arcmin" else values_label(word, measure.unit, 20)  # of angles ticks have the unit
    yield from beside(y, frame, label)
    places = [x(math.log10(own)) for own in counts]
    there = _points(places, values + reach, y)
    back = _points(places[::-1], (values - reach)[::-1], y)
    yield tag("path", tag("title", "95 % of other draws"), d=f"M{there}L{back}Z", class_=f"band {method}")
    yield tag("path", tag("title", word), d=f"M{_points(places, values, y)}", class_=f"line {method}")
    yield tag("path", d=f"M{frame.left:.1f} {y(float(values[-1])):.1f}H{frame.end:.1f}", class_="dotted")
    yield tag("path", d=f"M{frame.left:.1f} {bottom:.1f}H{frame.end:.1f}", class_="frame")


def _points(places: list[float], values: Array, y: Axis) -> str:
    return "L".join(f"{place:.1f} {y(float(value)):.1f}" for place, value in zip(places, values, strict=True))


def _decades(first: float, last: float) -> Iterator[tuple[float, str]]:
    """Powers of ten between two numbers, with their words; of less than a decade the ends."""
    decades = np.arange(math.ceil(math.log10(first) - 1e-9), math.floor(math.log10(last) + 1e-9) + 1)
    numbers = [10 ** int(own) for own in decades] if len(decades) > 1 else [round(first), round(last)]
    yield from ((math.log10(own), f"{own:,}".replace(",", " ")) for own in dict.fromkeys(numbers))
