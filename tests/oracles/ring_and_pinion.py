"""A ring and a pinion in it as outlines in polar form: where a point at some radius stands off a flank, by its azimuth.

The tooth of a gear takes the half angle s/(2 r) +- (inv alpha - inv alpha_R) at the radius R; a turn about the axis
keeps R, so the free turn of a gear against a point is a difference of azimuths, and of a pair the smallest over points
of the other's outline. No contact normal, line of action or roll is known here.
"""

import math
from dataclasses import dataclass

import numpy as np

POINTS = 20_001  # a flank: a parabola's minimum is missed by (step / 2)^2 / (2 x radius of curvature), 1e-9 mm


def inv(angle: np.ndarray) -> np.ndarray:
    return np.asarray(np.tan(angle) - angle)


@dataclass(frozen=True)
class Toothed:
    """A gear by its circles: `inside` of a ring."""

    teeth: int
    module: float
    alpha: float
    thickness: float
    first: float
    last: float
    inside: bool

    @property
    def base(self) -> float:
        return self.module * self.teeth / 2 * math.cos(self.alpha)

    def half_angle(self, radius: np.ndarray) -> np.ndarray:
        """Half a tooth [rad] at radii between first and last."""
        grown = inv(np.arccos(self.base / radius)) - inv(np.array(self.alpha))
        return self.thickness / (self.module * self.teeth) + (grown if self.inside else -grown)

    def flank(self, side: int, turn: float) -> np.ndarray:
        """Points (n, 2) of the flank of tooth 0 on its low (side 1) or high (-1) side, turned."""
        radius = np.linspace(self.first, self.last, POINTS)
        azimuth = turn - side * self.half_angle(radius)
        return radius[:, None] * np.stack([np.cos(azimuth), np.sin(azimuth)], axis=1)


def free_turn(ring: Toothed, pinion: Toothed, offset: np.ndarray, turns: tuple[float, float], side: int) -> float:
    """Turn [rad] of the ring until a ring's flank meets that side of the pinion's teeth.

    Args:
        ring, pinion: both.
        offset: (2,) [mm], of the pinion's centre from the ring's.
        turns: of ring and pinion [rad].
        side: of the pinion's teeth, 1 low or -1 high.

    Returns:
        How far the ring is free to turn towards the pinion, counter-clockwise on side 1, clockwise on side -1.
    """
    pitch, best = 2 * math.pi / pinion.teeth, math.inf
    for tooth in range(pinion.teeth):
        points = offset + pinion.flank(side, turns[1] + pitch * tooth)
        radius, azimuth = np.hypot(*points.T), np.arctan2(points[:, 1], points[:, 0])
        met = (ring.first <= radius) & (radius <= ring.last)
        if not met.any():
            continue
        half, ring_pitch = ring.half_angle(radius[met]), 2 * math.pi / ring.teeth
        # the ring's tooth flank that looks at this side: its high one on side 1, at turn + half, below the point
        apart = side * (azimuth[met] - turns[0]) - half
        best = min(best, float((apart - ring_pitch * np.floor(apart / ring_pitch + 0.5)).min()))
    return best
