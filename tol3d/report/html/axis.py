"""Frames and axes of charts: the width that a chart is drawn for, a span of values on a length of it, and its ticks."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np
from matplotlib.ticker import MaxNLocator, MultipleLocator

from tol3d.report.canvas import angle_step, minutes_seconds
from tol3d.report.html.tags import Markup, tag, together


@dataclass(frozen=True)
class Frame:
    """Width that a chart is drawn for, in its own unit: letters of 11 are readable from there on.

    Args:
        name: CSS class of charts of this width.
        width: of the chart.
        left, right: margins of its values.
        names: width of the names at its left, where it has names; `letters` of them find room.
    """

    name: str
    width: float
    left: float
    right: float
    names: float
    letters: int

    @property
    def end(self) -> float:
        """Right end of its values."""
        return self.width - self.right

    @property
    def middle(self) -> float:
        """Middle of its values."""
        return (self.left + self.end) / 2

    def across(self, low: float, high: float, unit: str = "") -> "Axis":
        """A horizontal axis as long as there is room."""
        return Axis(low, high, self.left, self.end, unit, most=round((self.end - self.left) / TICK))


TICK: Final = 90.0
"""Length of an axis between two ticks, at least, so that their words stand apart."""
WIDE: Final = Frame("wide-chart", 720.0, 64.0, 16.0, 230.0, 38)
NARROW: Final = Frame("narrow-chart", 324.0, 46.0, 8.0, 128.0, 21)
"""A page of 390 pixels shows it in its own size, beside a bar that scrolls."""


@dataclass(frozen=True)
class Axis:
    """Values from `low` to `high` on places from `start` to `end` of a picture.

    Args:
        unit: of the values, for the words of the ticks.
        most: number of ticks, about.
    """

    low: float
    high: float
    start: float
    end: float
    unit: str = ""
    most: int = 7

    def __call__(self, value: float) -> float:
        return self.start + (value - self.low) / (self.high - self.low) * (self.end - self.start)

    @property
    def ticks(self) -> list[tuple[float, str]]:
        """Values within the span with their words."""
        step = angle_step(self.low, self.high, self.most + 2) if self.unit == "arcmin" else None
        locator = MultipleLocator(step / 60) if step else MaxNLocator(self.most, steps=[1, 2, 2.5, 5, 10])
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


def beside(axis: Axis, frame: Frame, label: str) -> Iterator[Markup]:
    """A vertical axis at the left of a chart."""
    for value, words in axis.ticks:
        y = axis(value)
        yield tag("path", d=f"M{frame.left:.1f} {y:.1f}H{frame.end:.1f}", class_="grid")
        yield tag("text", words, x=frame.left - 6, y=y + 4, text_anchor="end", class_="tick")
    middle = (axis.start + axis.end) / 2
    yield tag(
        "text", label, x=11.0, y=middle, text_anchor="middle", class_="label", transform=f"rotate(-90 11 {middle:.0f})"
    )


def chart(frame: Frame, words: str, height: float, *inside: Markup) -> Markup:
    """A chart: an SVG as wide as the page allows, with alternative text."""
    return tag(
        "svg",
        tag("title", words),
        *inside,
        viewBox=f"0 0 {frame.width:.0f} {height:.0f}",
        role="img",
        class_=f"chart {frame.name}",
        xmlns="http://www.w3.org/2000/svg",
    )


def of_both_widths(drawn: Callable[[Frame], Markup]) -> Markup:
    """A chart as it is drawn for wide and for narrow pages, each of which shows its own."""
    return together(*dict.fromkeys(map(drawn, (WIDE, NARROW))))  # a sentence instead of it stands once
