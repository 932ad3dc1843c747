"""Bars of several intervals of a measure below each other, over its limits, and several measures in one picture."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from matplotlib.axes import Axes

from tol3d.report.canvas import BLACK, OUTSIDE, label_angles, new_figure, plain_axes, save_figure, title_axes
from tol3d.report.number import UNIT_SIGNS

COLUMNS: Final = 2
WIDTH, BAR, ABOVE = 6.4, 0.24, 1.15  # inch; of a measure, of a bar, and of its title and axis
BAR_SHARE: Final = 0.62
NAMES: Final = 2.4  # inch; of words beside bars
MARGIN: Final = 0.04


@dataclass(frozen=True)
class Interval:
    """A bar.

    Args:
        words: beside it.
        low, high: its ends in the unit of its measure, None where one is not known.
        colour: the colour.
    """

    words: str
    low: float | None
    high: float | None
    colour: str


@dataclass(frozen=True)
class Intervals:
    """The bars of one measure, in its unit.

    Args:
        name, words: of the measure, and what is said below.
        unit: in which they are.
        bars: from the top.
        limits: of the measure.
        middle: where a dotted line stands; None for none.
    """

    name: str
    words: str
    unit: str
    bars: Sequence[Interval]
    limits: Sequence[float]
    middle: float | None


def draw_intervals(measures: Sequence[Intervals], path: Path) -> None:
    """Draw measures side by side.

    Raises:
        InputError: the picture cannot be written there.
    """
    columns = min(COLUMNS, len(measures))
    rows = -(-len(measures) // columns)
    most = max(len(own.bars) for own in measures)
    figure = new_figure(WIDTH * columns, rows * (ABOVE + BAR * most))
    every = figure.subplots(rows, columns, squeeze=False)
    for k, axes in enumerate(every.flat):
        if k < len(measures):
            _draw(axes, measures[k])
        else:
            axes.set_axis_off()
    save_figure(figure, path)


def _draw(axes: Axes, own: Intervals) -> None:
    plain_axes(axes)
    for k, bar in enumerate(own.bars):
        if bar.low is not None and bar.high is not None:
            axes.barh(k, bar.high - bar.low, BAR_SHARE, left=bar.low, color=bar.colour)
    for limit in own.limits:
        axes.axvline(limit, color=OUTSIDE, linewidth=1.4)
    if own.middle is not None:
        axes.axvline(own.middle, color=BLACK, linewidth=0.8, linestyle=":")
    axes.use_sticky_edges = False
    axes.margins(x=MARGIN)
    axes.set_yticks(range(len(own.bars)), [bar.words for bar in own.bars], fontsize=8)
    axes.invert_yaxis()
    axes.set_xlabel(UNIT_SIGNS[own.unit] if own.unit != "arcmin" else "", fontsize=9)
    title_axes(axes, own.name, own.words, WIDTH - NAMES)
    label_angles(axes.xaxis, own.unit)
