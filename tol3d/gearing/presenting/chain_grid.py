"""Where things stand in the picture of a train: its parts below each other, its columns; lengths in inches."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate
from typing import Final

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.gridspec import SubplotSpec

from tol3d.gearing.presenting.shown_stage import ShownStage, shafts_along
from tol3d.gearing.summary_types import TrainSummary
from tol3d.report.canvas import GREY, PUBLISHED_COLOURS

WIDTH: Final = 15.0
HEAD: Final = 0.95
EDGE: Final = 0.2
CAPTIONS: Final = 1.4  # right end of the column of captions
ARM: Final = 1.3
SHAFT: Final = 1.5
NARROW_SHAFT: Final = 0.92
LINK_ROOM: Final = 1.4  # between two shafts, which grow narrower for it
MOST_IN_A_ROW: Final = 6
MOST_PITCH: Final = 3.4
NAMES, CHAIN, LINES = 0.5, 1.3, 0.8  # heights of what is drawn of a row, from its top: names, shafts, lines of text
SKETCH: Final = NAMES + CHAIN + LINES
BARS: Final = 1.6  # heights of the bars below, and of the shares below those
SHARES: Final = 0.75

TEXT, SMALL, STRONG = 9.5, 9.0, 10.5
LIGHT: Final = 0.4  # opacity of highs


@dataclass(frozen=True)
class ChainRow:
    """A row of the chain: its links with the shafts between them, from left to right.

    Args:
        stages: its links.
        shafts: names of its shafts, one more than links.
        senses: 1 for a shaft that turns as the first one of the train does, else -1.
        first, pitch, shaft: middle of the first shaft, from shaft to shaft, a shaft's width [inch].
        last: whether the train ends here.
    """

    stages: Sequence[ShownStage]
    shafts: Sequence[str]
    senses: Sequence[int]
    first: float
    pitch: float
    shaft: float
    last: bool

    @property
    def goes_on(self) -> bool:
        """Whether its first shaft stood at the end of the row before."""
        return self.stages[0].number > 1

    def shaft_at(self, column: int) -> float:
        """Middle of a shaft."""
        return self.first + column * self.pitch

    def link_at(self, column: int) -> float:
        """Middle between two shafts."""
        return self.shaft_at(column) + self.pitch / 2

    def link_ends(self, column: int) -> tuple[float, float]:
        """The ends of the shafts on both sides of a link."""
        return self.shaft_at(column) + self.shaft / 2, self.shaft_at(column + 1) - self.shaft / 2


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
    shafts = shafts_along(stages, held)
    senses = list(accumulate((-1 if stage.opposite else 1 for stage in stages), lambda a, b: a * b, initial=1))
    starts = range(0, len(stages), columns)
    return [
        ChainRow(
            stages=stages[start : start + columns],
            shafts=shafts[start : start + columns + 1],
            senses=senses[start : start + columns + 1],
            first=CAPTIONS + EDGE + shaft / 2,
            pitch=min((room - shaft) / columns, MOST_PITCH),
            shaft=shaft,
            last=start == starts[-1],
        )
        for start in starts
    ]


def plain_part(figure: Figure, place: SubplotSpec, height: float) -> Axes:
    """A part of the picture without axes, in which one unit is an inch, its lower left corner at 0."""
    axes = figure.add_subplot(place)
    axes.set(xlim=(0, WIDTH), ylim=(0, height))
    axes.set_axis_off()
    return axes


def draw_caption(axes: Axes, share: float, text: str) -> None:
    """A caption at the left of what stands at a share of the height of axes."""
    at = CAPTIONS / WIDTH
    axes.text(at, share, text, ha="right", va="center", fontsize=SMALL, color=GREY, transform=axes.transAxes)


def published_colours(train: TrainSummary) -> dict[str, str]:
    """A colour for everybody who published something of a train."""
    published = [stage.published for stage in train.stages] + [train.sums.published]
    names = dict.fromkeys(name for each in published for name in each)
    return {name: PUBLISHED_COLOURS[(k + 1) % len(PUBLISHED_COLOURS)] for k, name in enumerate(names)}
