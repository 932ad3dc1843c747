"""What is measured, over which positions, and what is taken of it."""

import math
from dataclasses import dataclass
from typing import Literal

Quantity = Literal["normal_backlash", "circumferential_backlash", "angular_backlash"]
Take = Literal["value", "min", "max", "range", "curve"]


@dataclass(frozen=True)
class Reading:
    """Where on the face, and at which teeth, a mesh is brought to contact and its gap is read.

    Args:
        contact: the working flanks touch over the whole face, or in the section in its middle.
        gap: the other flanks' distance is the least over the whole face, or that in the section.
        teeth: "all" candidate pairs, or one tooth in its space, the driver's or the driven's next to the
            line of centres.
    """

    contact: Literal["face", "section"] = "face"
    gap: Literal["face", "section"] = "face"
    teeth: Literal["all", "driver", "driven"] = "all"


@dataclass(frozen=True)
class Backlash:
    """A backlash of a mesh: normal and circumferential [mm], or angular [rad] of one gear, the other held."""

    quantity: Quantity
    mesh: str
    gear: str
    reading: Reading = Reading()

    @property
    def is_angle(self) -> bool:
        """Whether the value is an angle [rad] rather than a length [mm]."""
        return self.quantity == "angular_backlash"


@dataclass(frozen=True)
class Positions:
    """Driver positions at which a measure is read.

    Args:
        over: "random" (uniform over the long period, one a trial), "at" (one angle), "turn" or
            "long_period" (`count` even steps, the first position at 0).
        turns: turns of the driver that the positions span.
        count: steps from position to position in those turns; a turn has its end as one position more.
        angle: the driver's angle for "at" [rad].
    """

    over: Literal["random", "at", "turn", "long_period"]
    turns: int
    count: int
    angle: float = 0.0

    @property
    def closed(self) -> bool:
        """Whether the first position follows the last: the wheel is not back where it was after one driver turn."""
        return self.over == "long_period"

    @property
    def fixed(self) -> tuple[float, ...] | None:
        """The driver angles [rad] that every trial shares; None for random ones."""
        if self.over == "random":
            return None
        if self.over == "at":
            return (self.angle,)
        positions = self.count if self.closed else self.count + 1
        return tuple(2 * math.pi * self.turns * k / self.count for k in range(positions))


@dataclass(frozen=True)
class Measure:
    """A measure with its limits [mm or rad]."""

    name: str
    kind: Backlash
    positions: Positions
    take: Take
    lower_limit: float | None = None
    upper_limit: float | None = None

    @property
    def unit(self) -> str:
        """Unit of its columns and of summary.json: "um" or "arcmin"."""
        return "arcmin" if self.kind.is_angle else "um"

    @property
    def per_internal(self) -> float:
        """What one mm or rad is in that unit."""
        return 10800 / math.pi if self.kind.is_angle else 1000.0
