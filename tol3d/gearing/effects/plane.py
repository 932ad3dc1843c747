"""Deviations with a direction across an axis, and how a gear lies to the frame in which they are counted."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Plane:
    """How a gear lies to the frame in which a deviation with a direction is counted, such as its shaft's.

    Args:
        azimuth: of that frame's x axis in the gear's frame [rad].
        mirrored: whether the two count azimuths in opposite senses, as a gear does that faces backward on its shaft.
    """

    azimuth: float = 0.0
    mirrored: bool = False

    @property
    def matrix(self) -> Array:
        """(x, y) of the gear's frame from (x, y) of the other, (2, 2)."""
        cos, sin, sense = math.cos(self.azimuth), math.sin(self.azimuth), -1.0 if self.mirrored else 1.0
        return np.array([[cos, -sense * sin], [sin, sense * cos]])

    def seen_from(self, azimuth: float) -> "Plane":
        """The same in a frame whose x axis lies at an azimuth [rad] of the gear's."""
        return Plane(self.azimuth - azimuth, self.mirrored)


AS_COUNTED = Plane()
