"""A gear inside a ring on parallel axes, by vectors: two involutes that unwind the same way, cut by one normal.

An involute is where the end of a string lies that unwinds from a circle. The flanks of a gear and of the ring around it
that face each other unwind the same way; a normal of both is a line that touches both circles on the same side. All
lengths in mm, angles in rad, everything (n,) or (n, 2).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

ROUNDS = 12  # of a turn that an eccentricity changes by its share of the radius: 1e-2 at most


@dataclass(frozen=True)
class RingPair:
    """Gear and ring.

    Args:
        teeth: of gear and ring.
        module, pressure_angle: of both.
        thickness: of their teeth at the reference circles, gear and ring, each (n,).
        axes: where the axes lie, gear and ring, each (n, 2).
        centres: of the teeth off the axes, in frames that turn, each (n, 2).
    """

    teeth: tuple[int, int]
    module: float | Array
    pressure_angle: float
    thickness: tuple[Array, Array]
    axes: tuple[Array, Array]
    centres: tuple[Array, Array]

    @property
    def base(self) -> tuple[float | Array, float | Array]:
        half = self.module * np.cos(self.pressure_angle) / 2
        return half * self.teeth[0], half * self.teeth[1]

    def gap(self, side: int, gear: Array, ring: Array) -> Array:
        """Distance of the flanks along their normal where the gear's is a right one (1), or a left one (-1).

        The pair of teeth nearest to each other; turns of both count from a tooth in the direction of x.
        """
        first, second = (
            axis + turned(off, angle) for axis, off, angle in zip(self.axes, self.centres, (gear, ring), strict=True)
        )
        (r1, r2), (z1, z2) = self.base, self.teeth
        away = first - second
        distance, direction = np.hypot(*away.T), np.arctan2(away[:, 1], away[:, 0])
        touching = direction + side * np.arccos((r2 - r1) / distance)  # azimuth at which the line touches both circles
        along = side * np.stack([np.sin(touching), -np.cos(touching)], axis=-1)
        flat = np.tan(self.pressure_angle) - self.pressure_angle
        reference = self.module * z1 / 2, self.module * z2 / 2
        # where strings of flanks end that begin at the middle of a tooth of the gear, and of a space of the ring
        tooth = self.thickness[0] / (2 * reference[0]) + flat
        space = (np.pi * self.module - self.thickness[1]) / (2 * reference[1]) + flat
        ends = (r1 * (side * (touching - gear) + tooth), r2 * (side * (touching - ring - np.pi / z2) + space))
        gap = ends[1] - ends[0] - (away * along).sum(axis=1)
        pitch = np.pi * self.module * np.cos(self.pressure_angle)
        return np.asarray(gap - pitch * np.round(gap / pitch))

    def seated(self, side: int, driver: Array, start: Array, *, ring_drives: bool) -> Array:
        """Turn of the other gear near a start at which the flanks of a side of the inner gear touch."""

        angle, rate = start, side * (self.base[0] if ring_drives else -self.base[1])
        for _ in range(ROUNDS):
            angle = angle - self.gap(side, *((angle, driver) if ring_drives else (driver, angle))) / rate
        return angle


def turned(vectors: Array, angle: Array) -> Array:
    """Vectors (n, 2) turned."""
    cos, sin = np.cos(angle), np.sin(angle)
    x, y = vectors.T
    return np.stack([cos * x - sin * y, sin * x + cos * y], axis=-1)
