"""The basic rack that all gears of a set share."""

import math
from dataclasses import dataclass
from typing import Final

from tol3d.errors import GeometryError

ISO53_ADDENDUM: Final = 1.0
ISO53_DEDENDUM: Final = 1.25


@dataclass(frozen=True)
class BasicRack:
    """Module m [mm], pressure angle alpha [rad], addendum and dedendum factors h_a*, h_f*.

    Raises:
        GeometryError: a module of 0 or less, an angle beyond 5 to 45 deg, a dedendum below the addendum.
    """

    module: float = 1.0
    pressure_angle: float = math.radians(20)
    addendum: float = ISO53_ADDENDUM
    dedendum: float = ISO53_DEDENDUM

    def __post_init__(self) -> None:
        if not self.module > 0.0:
            raise GeometryError(f"module: expected more than 0 mm, got {self.module:g} mm")
        if not math.radians(5) <= self.pressure_angle <= math.radians(45):
            raise GeometryError(f"pressure angle: expected 5 to 45 deg, got {math.degrees(self.pressure_angle):g} deg")
        if not self.dedendum > self.addendum > 0.0:
            raise GeometryError(
                f"expected a dedendum above the addendum, and that above 0, got {self.dedendum:g} and {self.addendum:g}"
            )
