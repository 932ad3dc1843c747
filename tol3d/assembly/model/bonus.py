"""Material conditions: what a size adds to the room that a drawing leaves."""

from dataclasses import dataclass
from typing import Literal

Modifier = Literal["mmc", "lmc"]
"""Maximum or least material condition: the size without bonus."""


@dataclass(frozen=True)
class MaterialBonus:
    """clip(±(size - origin), 0, high - low): a size's departure from its material condition.

    Args:
        low, high: limits of the size on the drawing, as deviations from nominal [mm].
        grows: whether larger sizes add: of a hole at MMC and of a pin at LMC; the origin is then `low`, else `high`.
    """

    low: float
    high: float
    grows: bool


@dataclass(frozen=True)
class GaugeRoom:
    """Where a gauge of virtual condition may lie in a datum feature: within ±(size - virtual) / 2 of its ends.

    Args:
        feature: the hole, pin, slot or tab, with its part.
        virtual: diameter or width of the gauge [mm].
        grows: whether larger features leave more room: holes and slots.
    """

    feature: str
    virtual: float
    grows: bool
