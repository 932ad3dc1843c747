"""Gears on a shaft of which one point moves: each shifts with it by its share, and tilts."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from tol3d.gearing.effects import AxisOffset, AxisTilt, Effect, Plane

if TYPE_CHECKING:
    from tol3d.gearing.model.shafts import Carried


@dataclass(frozen=True)
class Lever:
    """A gear on a shaft of which one point moves.

    Args:
        own: the gear on the shaft.
        moved: z of the point that moves [mm].
        fixed: z of one that does not; None where all of the shaft moves alike.
        rate: how far the point moves by a deviation of 1; half of it by a clearance.
    """

    own: "Carried"
    moved: float
    fixed: float | None
    rate: float = 0.5

    @property
    def share(self) -> float:
        """What the gear moves of what the point moves."""
        return 1.0 if self.fixed is None else (self.own.at - self.fixed) / (self.moved - self.fixed)

    def anywhere(self) -> Iterator[Effect]:
        """Shift and tilt of the gear's axis where the point moves by a deviation with a direction on the shaft."""
        plane = Plane(mirrored=self.own.backward)
        yield AxisOffset(self.own.gear, factor=self.rate * self.share, plane=plane)
        if self.fixed is not None:
            per_length = self.rate * self.own.sense / (self.moved - self.fixed)
            yield AxisTilt(self.own.gear, per_length=per_length, plane=plane)

    def towards(self, azimuth: float) -> Iterator[Effect]:
        """Shift and tilt of the gear's axis where the point moves by a deviation, at an azimuth on the shaft."""
        sense = -1.0 if self.own.backward else 1.0
        x, y, _ = unit_vector(azimuth)
        yield AxisOffset(self.own.gear, (x, sense * y, 0.0), factor=self.rate * self.share)
        if self.fixed is not None:
            # z of the shaft turns towards (x, y): about z cross (x, y) = (-y, x)
            per_length = self.rate / (self.moved - self.fixed)
            yield AxisTilt(self.own.gear, (-y, sense * x, 0.0), per_length=per_length)


def unit_vector(azimuth: float) -> tuple[float, float, float]:
    """Unit vector across an axis at an azimuth [rad]."""
    return _exact(math.cos(azimuth)), _exact(math.sin(azimuth)), 0.0


def _exact(cosine: float) -> float:
    """A cosine or sine of a right angle as 0 or 1, not 6e-17 off."""
    return round(cosine) + 0.0 if abs(cosine - round(cosine)) < 1e-15 else cosine
