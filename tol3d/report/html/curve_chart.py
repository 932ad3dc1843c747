"""A measure over its positions as SVG: mean, ±3 sigma and extremes, the analytic mean, limits."""

from collections.abc import Iterator

import numpy as np

from tol3d.numerics.arrays import Array
from tol3d.report.curve import Stepped, position_label
from tol3d.report.distribution import NO_VALUES, values_label
from tol3d.report.html.axis import Axis, Frame, below, beside, chart
from tol3d.report.html.tags import Markup, tag
from tol3d.report.number import limit_text
from tol3d.runs.summary.measure import MeasureSummary

TOP, BOTTOM, FOOT = 20.0, 280.0, 44.0


def curve_chart(name: str, measure: MeasureSummary, frame: Frame) -> Markup:
    """A measure that takes a curve."""
    stepped, own = Stepped(measure), measure.curve_sample(measure.best_method)
    if own is None or all(value is None for value in own.mean):
        return tag("p", NO_VALUES, class_="warning")
    mean, sigma = stepped(own.mean), stepped(own.sigma)
    lowest, highest = stepped(own.min), stepped(own.max)
    limits = [limit for limit in measure.limits if limit is not None]
    every = np.concatenate([mean - 3 * sigma, mean + 3 * sigma, lowest, highest, limits])
    every = every[np.isfinite(every)]
    margin = 0.04 * float(np.ptp(every)) or 1.0
    last = float(stepped.x[-1])
    x = frame.across(float(stepped.x[0]), last if last > stepped.x[0] else last + 1.0)
    y = Axis(float(every.min()) - margin, float(every.max()) + margin, start=BOTTOM, end=TOP, unit=measure.unit)
    method = measure.best_method
    inside = [
        *below(x, TOP, BOTTOM, position_label(measure)),
        *beside(y, frame, values_label(name, measure.unit, 34)),
        _band(stepped.x, mean - 3 * sigma, mean + 3 * sigma, x, y, method),
        *(_line(stepped.x, own, x, y, f"line thin {method}", "smallest and largest") for own in (lowest, highest)),
        _line(stepped.x, mean, x, y, f"line {method}", "mean"),
    ]
    if method != "analytic" and (analytic := measure.curve_sample("analytic")):
        inside.append(_line(stepped.x, stepped(analytic.mean), x, y, "line dashed analytic", "analytic, mean"))
    inside += _limits(measure, y, frame)
    return chart(frame, f"{name} over its positions", BOTTOM + FOOT, *inside)


def _points(x: Array, values: Array, across: Axis, up: Axis) -> str:
    known = np.isfinite(values)
    return "L".join(f"{across(float(a)):.1f} {up(float(b)):.1f}" for a, b in zip(x[known], values[known], strict=True))


def _line(x: Array, values: Array, across: Axis, up: Axis, kind: str, words: str) -> Markup:
    points = _points(x, values, across, up)
    return tag("path", tag("title", words), d=f"M{points}" if points else None, class_=kind)


def _band(x: Array, low: Array, high: Array, across: Axis, up: Axis, method: str) -> Markup:
    there, back = _points(x, low, across, up), _points(x[::-1], high[::-1], across, up)
    return tag("path", tag("title", "±3 sigma"), d=f"M{there}L{back}Z" if there else None, class_=f"band {method}")


def _limits(measure: MeasureSummary, y: Axis, frame: Frame) -> Iterator[Markup]:
    for limit, word in zip(measure.limits, ("LSL", "USL"), strict=True):
        if limit is not None:
            words = f"{word} {limit_text(limit, measure.unit)}"
            yield tag(
                "path", tag("title", words), d=f"M{frame.left:.1f} {y(limit):.1f}H{frame.end:.1f}", class_="limit"
            )
            yield tag("text", words, x=frame.left + 5, y=y(limit) - 4, class_="tick limit-words")
