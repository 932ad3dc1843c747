"""The grid of a train's picture: its parts below each other, its shafts and links beside each other.

Widths are in inches because names are wrapped to them: matplotlib breaks a text at the border of the figure only, and
its constrained layout makes columns as wide as their longest name.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import accumulate
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.gridspec import SubplotSpec

from tol3d.gearing.presenting.link_symbol import link_colour
from tol3d.gearing.presenting.shown_stage import ShownStage, shafts_along
from tol3d.gearing.summary.types import TrainSummary
from tol3d.numerics.arrays import Array
from tol3d.report.canvas import GREY, PUBLISHED_COLOURS

NO_CAPTIONS: Final[Mapping[float, str]] = {}
WIDTH: Final = 15.0
HEAD: Final = 0.95
EDGE: Final = 0.2
CAPTIONS: Final = 1.4  # width of the column of captions
ARM: Final = 1.3
SHAFT: Final = 1.5
NARROW_SHAFT: Final = 0.92
LINK_ROOM: Final = 1.4  # between two shafts, which grow narrower for it
MOST_IN_A_ROW: Final = 6
MOST_PITCH: Final = 3.4
NAMES, CHAIN, LINES, BARS, GAUGES, SHARES = 0.5, 1.3, 0.8, 1.6, 0.25, 0.5  # heights of what a row shows, from its top
ROW: Final = (NAMES, CHAIN, LINES, BARS, GAUGES, SHARES)

TEXT, SMALL, STRONG = 9.5, 9.0, 10.5
LIGHT: Final = 0.4  # opacity of highs


@dataclass(frozen=True, eq=False)
class ChainRow:
    """A row of the chain: its links with the shafts between them, from left to right.

    Args:
        stages: its links.
        shafts: names of its shafts, one more than links.
        senses: 1 for a shaft that turns as the first one of the train does, else -1.
        middles: of its shafts (links + 1,) [inch from the captions].
        shaft: a shaft's width [inch].
        last: whether the train ends here.
    """

    stages: Sequence[ShownStage]
    shafts: Sequence[str]
    senses: Sequence[int]
    middles: Array
    shaft: float
    last: bool

    @property
    def goes_on(self) -> bool:
        """True if its first shaft was at the end of the previous row."""
        return self.stages[0].number > 1

    @property
    def pitch(self) -> float:
        """From shaft to shaft [inch]."""
        return float(self.middles[1] - self.middles[0])

    @property
    def links(self) -> Array:
        """Middles between two shafts each (links,) [inch from the captions]."""
        return self.middles[1:] - self.pitch / 2

    @property
    def colours(self) -> list[str]:
        """Colours of its links, by kind."""
        return [link_colour(stage.kind) for stage in self.stages]


def rows_of(stages: Sequence[ShownStage], held: str, arm: float) -> list[ChainRow]:
    """The chain in as few rows as it needs, about as many links in each.

    Args:
        stages: of the train, one at least.
        held: the shaft that it begins with.
        arm: room at the right of the last shaft [inch].
    """
    count = -(-len(stages) // MOST_IN_A_ROW)
    columns = -(-len(stages) // count)
    room = WIDTH - CAPTIONS - 2 * EDGE - arm
    shaft = min(max((room - columns * LINK_ROOM) / (columns + 1), NARROW_SHAFT), SHAFT)
    pitch = min((room - shaft) / columns, MOST_PITCH)
    shafts = shafts_along(stages, held)
    senses = list(accumulate((-1 if stage.opposite else 1 for stage in stages), lambda a, b: a * b, initial=1))
    rows = []
    for start in range(0, len(stages), columns):
        own = stages[start : start + columns]
        shown = slice(start, start + len(own) + 1)
        middles: Array = EDGE + shaft / 2 + pitch * np.arange(len(own) + 1.0)
        rows.append(ChainRow(own, shafts[shown], senses[shown], middles, shaft, start + columns >= len(stages)))
    return rows


def plain_part(
    figure: Figure, place: SubplotSpec, ends: tuple[float, float], captions: Mapping[float, str] = NO_CAPTIONS
) -> Axes:
    """A part of the picture from the captions to its right border, without a frame; x is in inches.

    Args:
        figure, place: where.
        ends: lower and upper, of y.
        captions: what stands at its left, by y.
    """
    axes = figure.add_subplot(place, xlim=(0, WIDTH - CAPTIONS), ylim=ends, frameon=False, xticks=[])
    axes.set_yticks([*captions], [*captions.values()], fontsize=SMALL, color=GREY, va="center")
    axes.tick_params(length=0)
    return axes


def published_colours(train: TrainSummary) -> dict[str, str]:
    """A colour for each published source of a train."""
    published = [stage.published for stage in train.stages] + [train.sums.published]
    names = dict.fromkeys(name for each in published for name in each)
    return {name: PUBLISHED_COLOURS[(k + 1) % len(PUBLISHED_COLOURS)] for k, name in enumerate(names)}
