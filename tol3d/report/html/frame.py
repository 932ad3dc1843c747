"""Frames and scales of charts as SVG: the width for which a chart is drawn, and places of values on it."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

from tol3d.report.chart import Axis
from tol3d.report.html.blocks import Markup, tag
from tol3d.report.ticks import Ticks, decades, ticks_of


@dataclass(frozen=True)
class Frame:
    """Width for which a chart is drawn, in SVG units: on a page at least that wide letters of 11 are readable.

    Args:
        name: CSS class of charts of this width.
        width: of the chart.
        left, right: margins of its values.
        names: left margin instead, of charts whose rows have names.
        letters: most letters of a name that fit it.
    """

    name: str
    width: float
    left: float
    right: float
    names: float
    letters: int


TICK: Final = 90.0
"""Least distance of two ticks of an axis, so that their words stand apart."""
LETTER: Final = 6.6
"""Mean width of a letter."""
LEAST_TICKS: Final = 3
"""Of an axis on which their words find room: one tick tells no scale."""
WIDE: Final = Frame("wide-chart", 720.0, 64.0, 16.0, 230.0, 38)
NARROW: Final = Frame("narrow-chart", 324.0, 54.0, 6.0, 142.0, 21)
"""Fits a page of 390 pixels with its scroll bar, without scaling."""


@dataclass(frozen=True)
class Scale:
    """Map of an axis to places of a chart.

    Args:
        axis: with its ends.
        start, end: places of its lower and upper end.
        most: about the number of ticks.
    """

    axis: Axis
    start: float
    end: float
    most: int

    def __call__(self, value: float) -> float:
        low, high = self.axis.low, self.axis.high
        if self.axis.log:
            low, high, value = math.log10(low), math.log10(high), math.log10(max(value, low))
        return self.start + (value - low) / (high - low) * (self.end - self.start)

    def within(self, value: float) -> float:
        """Place of a value, or of the axis' end that it lies beyond."""
        return self(min(max(value, self.axis.low), self.axis.high))

    @property
    def ticks(self) -> Ticks:
        """Values of the ticks with their words."""
        axis = self.axis
        if not axis.ticks:
            return []
        if axis.log:
            return decades(axis.low, axis.high)
        first = ticks_of(axis.low, axis.high, axis.unit, self.most)
        if len(first) >= LEAST_TICKS:
            return first
        denser = (ticks_of(axis.low, axis.high, axis.unit, most) for most in range(self.most + 1, 3 * self.most))
        some = (own for every in denser for own in (every, every[::2]))
        return next((own for own in some if len(own) >= LEAST_TICKS and self._stand_apart(own)), first)

    def _stand_apart(self, ticks: Ticks) -> bool:
        """True if a letter's room is between the words of each tick and of the next, side by side."""
        return all(
            abs(self(other) - self(value)) >= LETTER * ((len(words) + len(next_words)) / 2 + 1)
            for (value, words), (other, next_words) in pairwise(ticks)
        )

    def grid_below(self, top: float, bottom: float) -> Iterator[Markup]:
        """Upright grid lines at its ticks over a panel."""
        for value, _ in self.ticks:
            yield tag("path", d=f"M{self(value):.1f} {top:.1f}V{bottom:.1f}", class_="grid")

    def words_below(self, bottom: float) -> Iterator[Markup]:
        """A horizontal axis below the last panel: its line, the words of its ticks, and its label."""
        for value, words in self.ticks:
            yield tag("text", words, x=self(value), y=bottom + 15, text_anchor="middle", class_="tick")
        yield tag("path", d=f"M{self.start:.1f} {bottom:.1f}H{self.end:.1f}", class_="frame")
        middle, room = (self.start + self.end) / 2, int((self.end - self.start) / LETTER)
        yield tag("text", self.axis.words(room), x=middle, y=bottom + 33, text_anchor="middle", class_="label")

    def beside(self, left: float, right: float) -> Iterator[Markup]:
        """A vertical axis at the left of a panel: grid lines, the words of its ticks, and its label."""
        for value, words in self.ticks:
            y = self(value)
            yield tag("path", d=f"M{left:.1f} {y:.1f}H{right:.1f}", class_="grid")
            yield tag("text", words, x=left - 6, y=y + 4, text_anchor="end", class_="tick")
        middle, room = (self.start + self.end) / 2, int((self.start - self.end) / LETTER)
        turned = f"rotate(-90 11 {middle:.0f})"
        yield tag(
            "text", self.axis.words(room), x=11.0, y=middle, text_anchor="middle", class_="label", transform=turned
        )
