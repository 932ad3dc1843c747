"""Where things stand in the picture of a train; all lengths in inches of the picture, sizes of text in points."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate
from typing import Any, Final

from matplotlib.axes import Axes

from tol3d.gearing.presenting.stage import Stage, shafts_along
from tol3d.report.canvas import GREY, PUBLISHED_COLOURS

Summary = Any  # typed, read by text

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
NAMES: Final = 0.5  # heights of a row's parts, from its top
CHAIN: Final = 1.3
LINES: Final = 0.8
BARS: Final = 1.6
SHARES: Final = 0.75
ROW: Final = NAMES + CHAIN + LINES + BARS + SHARES

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
        top: its upper end, from the foot of the picture [inch].
        last: whether the train ends here.
    """

    stages: Sequence[Stage]
    shafts: Sequence[str]
    senses: Sequence[int]
    first: float
    pitch: float
    shaft: float
    top: float
    last: bool

    @property
    def goes_on(self) -> bool:
        """Whether its first shaft stood at the end of the row before."""
        return self.stages[0].number > 1

    @property
    def middle(self) -> float:
        """Height of the shafts."""
        return self.top - NAMES - CHAIN / 2

    @property
    def floor(self) -> float:
        """Height on which the bars stand."""
        return self.top - NAMES - CHAIN - LINES - BARS

    def line_at(self, line: int, height: float) -> float:
        """Height of a line of text below the chain."""
        return self.top - NAMES - CHAIN - (line + 0.5) * height

    def shaft_at(self, column: int) -> float:
        """Middle of a shaft."""
        return self.first + column * self.pitch

    def link_at(self, column: int) -> float:
        """Middle between two shafts."""
        return self.shaft_at(column) + self.pitch / 2

    def link_ends(self, column: int) -> tuple[float, float]:
        """The ends of the shafts on both sides of a link."""
        return self.shaft_at(column) + self.shaft / 2, self.shaft_at(column + 1) - self.shaft / 2


def rows_of(stages: Sequence[Stage], held: str, arm: float, top: float) -> list[ChainRow]:
    """The chain in as few rows as it needs, about as many links in each.

    Args:
        stages: of the train, one at least.
        held: the shaft that it begins with.
        arm: room behind the last shaft [inch].
        top: upper end of the first row [inch].
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
            top=top - index * ROW,
            last=start == starts[-1],
        )
        for index, start in enumerate(starts)
    ]


def draw_caption(axes: Axes, y: float, text: str) -> None:
    """A caption at the left of what stands at height `y`."""
    axes.text(CAPTIONS, y, text, ha="right", va="center", fontsize=SMALL, color=GREY)


def published_colours(train: Summary) -> dict[str, str]:
    """A colour for everybody who published something of a train."""
    told = [stage.get("published", {}) for stage in train["stages"]] + [train["sums"].get("published", {})]
    names = dict.fromkeys(name for each in told for name in each)
    return {name: PUBLISHED_COLOURS[(k + 1) % len(PUBLISHED_COLOURS)] for k, name in enumerate(names)}
