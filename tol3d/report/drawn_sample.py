"""Samples as one histogram, over each other: in pictures of runs, of comparisons, of compensations."""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from numpy.typing import NDArray

from tol3d.numerics.arrays import Array
from tol3d.report.bars import Bars
from tol3d.report.canvas import BLACK, GREY, OUTSIDE
from tol3d.report.ends import Ends
from tol3d.report.number import measured_text, short_text

Limits = tuple[float | None, float | None]
Line = Literal["filled", "solid", "dashed"]

UNKNOWN_ENDS: Final = Ends(None, None)
FILL_OPACITY, OUTSIDE_OPACITY = 0.55, 0.85
BAR_EDGE: Final = 0.5  # points; the white between two bars
LINE_TOP: Final = 0.84  # of the axes' height, where words stand above the lines
ROOM_OF_TEXT: Final = 0.115  # of the axes' width, for the words at the mean or at an end of 3 sigma
LEAST_ROOM: Final = 0.06  # less, and they stand together


@dataclass(frozen=True, eq=False)
class Pieces:
    """Bars cut at limits.

    Args:
        edges: (pieces + 1,) rising.
        bars: (pieces,) index of the bar that each is of.
        outside: (pieces,) which of them lie beyond a limit.
    """

    edges: Array
    bars: NDArray[np.intp]
    outside: NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class DrawnSample:
    """A sample as a histogram shows it; values in one unit.

    Args:
        label: in the legend; None where it is named elsewhere.
        colour: of its role: the method's, the run's, the state's.
        bars: its values, counted.
        line: "filled", or as the outline of its bars.
        mean: of its values.
        ends: between which most of them lie.
        limits: lower and upper, None for none; what is beyond is filled in its own colour.
    """

    label: str | None
    colour: str
    bars: Bars
    line: Line = "filled"
    mean: float | None = None
    ends: Ends = UNKNOWN_ENDS
    limits: Limits = (None, None)

    @property
    def known_ends(self) -> list[tuple[str, float]]:
        """Low end, mean and high end by their words, as far as they are known, from left to right."""
        words = ((self.ends.words[0], self.ends.low), ("mean", self.mean), (self.ends.words[1], self.ends.high))
        return [(word, value) for word, value in words if value is not None]

    @property
    def pieces(self) -> "Pieces":
        """Its bars, those that a limit runs through cut there."""
        lower, upper = self.limits
        first, last = self.bars.edges[0], self.bars.edges[-1]
        within = [limit for limit in self.limits if limit is not None and first < limit < last]
        edges = np.unique(np.concatenate([self.bars.edges, within]))
        middles = (edges[:-1] + edges[1:]) / 2
        below, above = -math.inf if lower is None else lower, math.inf if upper is None else upper
        bars = np.clip(np.searchsorted(self.bars.edges, middles) - 1, 0, len(self.bars.counts) - 1)
        return Pieces(edges, bars, np.asarray((middles < below) | (middles > above)))


def draw_samples(axes: Axes, samples: Sequence[DrawnSample], per: float = 1.0) -> None:
    """Draw samples over each other, the first one lowest.

    Bars of a single filled sample are told apart by white edges; several filled ones have an outline each, so that the
    shape of each is seen through the others.

    Args:
        axes: where.
        samples: the samples.
        per: heights are % of the trials per so many units.
    """
    alone = sum(sample.line == "filled" for sample in samples) == 1
    for sample in samples:
        edges, heights = sample.bars.edges, per * sample.bars.density
        if sample.line != "filled":
            style = "-" if sample.line == "solid" else "--"
            axes.stairs(heights, edges, color=sample.colour, linestyle=style, linewidth=1.8, label=sample.label)
        elif alone:
            _draw_bars(axes, sample, heights)
        else:
            _draw_area(axes, sample, heights)


def _draw_bars(axes: Axes, sample: DrawnSample, heights: Array) -> None:
    """Bars as two collections: a hundred rectangles by themselves take five times as long."""
    pieces = sample.pieces
    beyond, lefts, rights, heights = pieces.outside, pieces.edges[:-1], pieces.edges[1:], heights[pieces.bars]
    none = np.zeros_like(heights)
    corners = np.array([[lefts, none], [lefts, heights], [rights, heights], [rights, none]]).transpose(2, 0, 1)
    for chosen, colour, opacity in ((~beyond, sample.colour, FILL_OPACITY), (beyond, OUTSIDE, OUTSIDE_OPACITY)):
        bars = PolyCollection(
            list(corners[chosen]),
            facecolor=colour,
            alpha=opacity,
            edgecolor="white",
            linewidth=BAR_EDGE,
            label=None if colour == OUTSIDE else sample.label,
        )
        axes.add_collection(bars)


def _draw_area(axes: Axes, sample: DrawnSample, heights: Array) -> None:
    pieces = sample.pieces
    edges, heights = pieces.edges, heights[pieces.bars]
    beyond = np.where(pieces.outside, heights, 0.0)
    axes.stairs(heights - beyond, edges, fill=True, color=sample.colour, alpha=FILL_OPACITY, label=sample.label)
    if pieces.outside.any():
        axes.stairs(beyond, edges, fill=True, color=OUTSIDE, alpha=OUTSIDE_OPACITY)
    axes.stairs(heights, edges, color=sample.colour, linewidth=1.0)


def draw_ends(axes: Axes, sample: DrawnSample, top: float = 1.0) -> None:
    """Lines at the mean and the ends of a sample, up to `top` of the axes' height."""
    for _, value in sample.known_ends:
        axes.axvline(value, ymax=top, color=GREY, linewidth=1.0, linestyle=":")


def name_ends(axes: Axes, sample: DrawnSample, unit: str, span: tuple[float, float]) -> None:
    """Words at the lines of `draw_ends`, side by side; in one where there is no room for that.

    Args:
        axes: where.
        sample: the sample.
        unit: of its values.
        span: what the axis shows.
    """
    known = sample.known_ends
    steps = itertools.pairwise(value for _, value in known)
    room = min((after - before for before, after in steps), default=math.inf) / (span[1] - span[0])
    text_of = short_text if len({short_text(value, unit) for _, value in known}) == len(known) else measured_text
    texts = [(f"{word}\n{text_of(value, unit)}", value, "center") for word, value in known]
    if sample.mean is not None and room < LEAST_ROOM:
        words, values = (" … ".join(each) for each in zip(*(text.split("\n") for text, _, _ in texts), strict=True))
        texts = [(f"{words}\n{values}", sample.mean, "center")]
    elif room < ROOM_OF_TEXT:
        sides = ("right", *["center"] * (len(texts) - 2), "left")
        texts = [(text, value, side) for (text, value, _), side in zip(texts, sides, strict=True)]
    for text, value, side in texts:
        axes.annotate(
            text, (value, 1.0), xycoords=("data", "axes fraction"), ha=side, va="top", fontsize=8.5, color=BLACK
        )
