"""Positions at which a measure is read, and the value taken over them."""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

Over = Literal["random", "at", "turn", "long_period", "swing"]
Take = Literal["value", "min", "max", "range", "harmonic", "curve"]


@dataclass(frozen=True)
class Positions:
    """Positions at which a measure is read, such as angles of a driving shaft.

    Args:
        over: "random" (uniform over the long period, one a trial), "at" (one angle), "turn" or
            "long_period" (`count` even steps, the first position at 0), "swing" (`angles`).
        turns: turns that the positions span.
        count: steps from position to position in those turns; a turn has its end as one position more.
        angle: the angle for "at" [rad].
        angles: for "swing" [rad].
        shown: the angles that a reader knows these positions by [rad], such as those of the output.
        jumps: whether values may jump from one position to the next: extremes are then those of the positions alone.
        in_turn: whether methods read one position after the other, so that of many only the values are held.
    """

    over: Over
    turns: int
    count: int
    angle: float = 0.0
    angles: tuple[float, ...] = ()
    shown: tuple[float, ...] = ()
    jumps: bool = False
    in_turn: bool = False

    @property
    def closed(self) -> bool:
        """True if the first position follows the last: the wheel is not back where it was after one driver turn."""
        return self.over == "long_period"

    @cached_property
    def fixed(self) -> tuple[float, ...] | None:
        """The angles [rad] that every trial shares; None for random ones."""
        if self.over == "random":
            return None
        if self.over == "at":
            return (self.angle,)
        if self.over == "swing":
            return self.angles
        positions = self.count if self.closed else self.count + 1
        return tuple(2 * math.pi * self.turns * k / self.count for k in range(positions))

    @property
    def in_a_trial(self) -> int:
        """Number of positions at which a trial is read."""
        return 1 if self.fixed is None else len(self.fixed)


AT_RANDOM = Positions("random", 1, 1)
