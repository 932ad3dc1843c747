"""Pieces of evaluations, so long that a program can show progress or stop between them."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final

FIRST_PIECE: Final = 64
"""Builds of the first piece, where they are not expected to take longer than a piece."""
FEWEST: Final = 8
"""Builds of the first piece of dear ones: of some as much again does not grow with builds, and guesses are high."""
PIECE: Final = 0.1
"""Seconds to which pieces grow by default."""
MOST_GROWTH: Final = 16.0
FIXED_IN: Final = 10.0
"""Seconds of a piece over those of it that do not grow with builds, up to `LONGEST`."""
QUICK: Final = 0.02
"""Seconds of pieces of fewer builds than asked for that tell nothing."""
LONGEST: Final = 0.5
"""Seconds to which that lengthens pieces."""


@dataclass
class Pace:
    """Number of builds of the next piece: a piece of n builds takes fixed + each · n seconds, by the last two sizes.

    Args:
        count: of the next piece.
        measured: the least seconds of the last two sizes.
        piece: seconds to which pieces grow.
    """

    count: int = FIRST_PIECE
    measured: Mapping[int, float] = field(default_factory=dict)
    piece: float = PIECE

    @classmethod
    def of(cls, seconds: float) -> "Pace":
        """Of builds that are expected to take so many seconds each."""
        return cls(max(min(int(PIECE / max(seconds, 1e-9)), FIRST_PIECE), FEWEST))

    def took(self, builds: int, seconds: float) -> None:
        """Take the time of a piece; the second one is larger or smaller, so as to learn what does not grow with it."""
        if builds < self.count and seconds < QUICK:
            return
        seconds = max(min(seconds, self.measured.get(builds, seconds)), 1e-6)
        others = [(count, its) for count, its in self.measured.items() if count != builds][-1:]
        self.measured = dict([*others, (builds, seconds)])
        if not others:
            longer = 2.0 if seconds < 2.5 * self.piece else 0.5
            longer = min(self.piece / seconds, MOST_GROWTH) if seconds < self.piece else longer
            self.count = max(int(builds * longer), 1)
            return
        ((count, its),) = others
        each = max((seconds - its) / (builds - count), 1e-9)
        fixed = max(seconds - each * builds, 0.0)
        wanted = max(self.piece, min(FIXED_IN * fixed, LONGEST), 2.0 * fixed)
        self.count = max(round(min((wanted - fixed) / each, MOST_GROWTH * builds)), 1)
