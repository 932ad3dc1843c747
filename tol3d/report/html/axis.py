"""Axes of charts: a span of values on a length of a picture, and the ticks on it."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from matplotlib.ticker import MaxNLocator, MultipleLocator

from tol3d.report.canvas import angle_step, minutes_seconds
from tol3d.report.html.tags import Markup, tag

WIDTH, LEFT, RIGHT = 720.0, 64.0, 16.0
"""Sizes of charts, in their own unit."""


@dataclass(frozen=True)
class Axis:
    """Values from `low` to `high` on places from `start` to `end` of a picture.

    Args:
        unit: of the values, for the words of the ticks.
    """

    low: float
    high: float
    start: float = LEFT
    end: float = WIDTH - RIGHT
    unit: str = ""

    def __call__(self, value: float) -> float:
        return self.start + (value - self.low) / (self.high - self.low) * (self.end - self.start)

    @property
    def ticks(self) -> list[tuple[float, str]]:
        """Values within the span with their words."""
        step = angle_step(self.low, self.high) if self.unit == "arcmin" else None
        locator = MultipleLocator(step / 60) if step else MaxNLocator(7, steps=[1, 2, 2.5, 5, 10])
        found = np.asarray(locator.tick_values(self.low, self.high), dtype=float)
        inside = [float(own) for own in found if self.low <= own <= self.high]
        return list(zip(inside, map(self._words(found), inside), strict=True))

    def _words(self, ticks: "np.ndarray") -> Callable[[float], str]:
        if self.unit == "arcmin":
            return minutes_seconds
        step = float(np.diff(ticks).min()) if len(ticks) > 1 else 1.0
        digits = max(0, -int(np.floor(np.log10(step) + 1e-9)))
        digits += bool(round(step * 10**digits, 6) % 1)
        return lambda value: f"{value + 0.0:.{digits}f}".replace("-", "−")


def below(axis: Axis, top: float, bottom: float, label: str) -> Iterator[Markup]:
    """A horizontal axis at the bottom of a chart: lines, ticks, its label."""
    for value, words in axis.ticks:
        x = axis(value)
        yield tag("path", d=f"M{x:.1f} {top:.1f}V{bottom:.1f}", class_="grid")
        yield tag("text", words, x=x, y=bottom + 15, text_anchor="middle", class_="tick")
    yield tag("path", d=f"M{axis.start:.1f} {bottom:.1f}H{axis.end:.1f}", class_="frame")
    yield tag("text", label, x=(axis.start + axis.end) / 2, y=bottom + 33, text_anchor="middle", class_="label")


def beside(axis: Axis, left: float, right: float, label: str) -> Iterator[Markup]:
    """A vertical axis at the left of a chart."""
    for value, words in axis.ticks:
        y = axis(value)
        yield tag("path", d=f"M{left:.1f} {y:.1f}H{right:.1f}", class_="grid")
        yield tag("text", words, x=left - 6, y=y + 4, text_anchor="end", class_="tick")
    middle = (axis.start + axis.end) / 2
    yield tag(
        "text", label, x=14.0, y=middle, text_anchor="middle", class_="label", transform=f"rotate(-90 14 {middle:.0f})"
    )


def chart(words: str, height: float, *inside: Markup) -> Markup:
    """A chart: an SVG as wide as the page allows, with alternative text."""
    return tag(
        "svg",
        tag("title", words),
        *inside,
        viewBox=f"0 0 {WIDTH:.0f} {height:.0f}",
        role="img",
        class_="chart",
        xmlns="http://www.w3.org/2000/svg",
    )
