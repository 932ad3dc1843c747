"""Contact lines of helical gears in the plane of action, and the first of them that touches where axes lean.

In the plane of action of the driver's flank side sigma, u counts along the line of action from the pitch point on, z
along the axis. Pair k touches along the line

    u = r_b1 (alpha_wt + eta_b1 - sigma (theta1 + 2 pi k/z1) - tan alpha_wt) - sigma h1 tan(beta_b) z,

as far as it lies between the tips, u1 to u2, and on the common face. A lean f of the axes against each other in that
plane opens it by f l, l = z cos(beta_b) - sigma h1 u sin(beta_b) the coordinate along the line: to first order a pair
touches first at an end of its line, on an end of the face or on a tip edge, and the pair whose end is lowest carries.
"""

import math
from dataclasses import dataclass

import numpy as np

from tol3d.gears import SpurPair
from tol3d.numerics.arrays import Array


@dataclass(frozen=True)
class ContactLines:
    """The contact lines of a helical pair at its nominal places."""

    pair: SpurPair

    @property
    def path(self) -> tuple[float, float]:
        """u1 and u2 [mm], where the tips of wheel and pinion end the path of contact."""
        at_pitch = math.tan(self.pair.working_pressure_angle)
        pinion, wheel = self.pair.pinion, self.pair.wheel
        return -wheel.base_radius * (wheel.tip_roll - at_pitch), pinion.base_radius * (pinion.tip_roll - at_pitch)

    def ends(self, side: int, driver_angle: Array) -> tuple[Array, Array]:
        """Lowest and highest l of all points that may touch, over that of the upper end of the face; each (rows,).

        A lean that opens the upper end of the face in the pitch point by g takes -g times the lowest from the gap where
        it opens there, and -g times the highest where it closes.

        Args:
            side: 1 where the driver's right flanks touch, -1 where its left ones do.
            driver_angle: (rows,) [rad].
        """
        pinion, half = self.pair.pinion, self.pair.common_face / 2
        cosine, sine = pinion.base_helix_cosine, side * pinion.hand * math.sin(pinion.base_helix_angle)
        fall = sine / cosine
        first, last = self.path
        pitch, working = pinion.transverse_base_pitch, self.pair.working_pressure_angle
        tooth = pinion.base_radius * (working + pinion.base_half_angle - side * driver_angle - math.tan(working))
        furthest_down = first - abs(fall) * half
        below = furthest_down + np.mod(tooth - furthest_down, pitch)
        lowest, highest = np.full(len(driver_angle), np.inf), np.full(len(driver_angle), -np.inf)
        for line in range(math.floor((last - first + 2 * abs(fall) * half) / pitch) + 1):
            u = below + line * pitch  # in the middle of the face
            reaches = np.sort([(u - first) / fall, (u - last) / fall], axis=0)
            low, high = np.maximum(reaches[0], -half), np.minimum(reaches[1], half)
            for z in (low, high):
                along = z * cosine - sine * (u - fall * z)
                lowest = np.where(low <= high, np.minimum(lowest, along), lowest)
                highest = np.where(low <= high, np.maximum(highest, along), highest)
        return lowest / (half * cosine), highest / (half * cosine)


def lost(at_end: Array, ends: tuple[Array, Array]) -> Array:
    """Loss of a flank side by a lean [mm], (rows,): positive where it touches earlier.

    Args:
        at_end: opening by the lean at the upper end of the face in the pitch point [mm], (rows,).
        ends: of the contact lines, as `ContactLines.ends` has them.
    """
    return np.asarray(-np.where(at_end > 0.0, at_end * ends[0], at_end * ends[1]))
