"""Seat of a cone in another one, both coaxial: how far one goes into the other until their surfaces meet.

Radii along the axis of the target, z from the middle of each: of the target R + k z, of the moving cone r + q (z - h),
h the height of its middle. Equal angles, k = q, meet all over at h = (r - R) / k. Of unequal angles the end of one, at
e from its middle, meets the other's surface: the target's at h = e - (R + k e - r) / q, the moving one's at
h = (r + q e - R) / k - e. That end stays on its part while its cone lies off along the axis by c, so at e - c.
"""

from dataclasses import dataclass
from typing import Final

from tol3d.assembly.model.feature import Shape

ALIKE: Final = 1e-9
"""Part of a slope by which two slopes of one cone differ by rounding."""
MISSED: Final = "expected cones that meet within their lengths, got ends that do not reach each other"
ON_END: Final = 1e-9
"""Part of a length by which a place on its end lies beyond it by rounding."""


@dataclass(frozen=True)
class ConeSeat:
    """The place of one cone in another, along the axis of the target [mm].

    Args:
        height: of the moving cone's middle over the target's.
        by_moving, by_target: change of it with the shift of each cone along its own z, which moves its middle as well.
    """

    height: float
    by_moving: float = 0.0
    by_target: float = 0.0


def unfit_cones(moving: Shape, target: Shape, sign: float) -> str:
    """Why two cones do not lie in each other, in words; "" where they do.

    Args:
        moving, target: the cones.
        sign: of the moving cone's z along the target's.
    """
    if moving.inner == target.inner:
        return f"expected a cone in a conical hole, got two {'holes' if moving.inner else 'cones without a hole'}"
    if sign * moving.slope * target.slope < 0.0:
        return "expected both to widen the same way, got one against the other; turn one of their axes"
    return "" if cone_seat(moving, target, sign) else MISSED


def cone_seat(moving: Shape, target: Shape, sign: float) -> ConeSeat | None:
    """Their seat; None where neither's end reaches the other one, or one is no cone.

    Args:
        moving, target: one in the other, which widens the same way.
        sign: of the moving cone's z along the target's.
    """
    if not (moving.slope and target.slope):
        return None
    slope, other = sign * moving.slope, target.slope
    own, its = ((shape.nominal_size or 0.0) / 2 for shape in (moving, target))
    half, its_half = moving.reach[0], target.reach[0]
    if abs(slope - other) <= ALIKE * abs(other):
        height = (own - its) / other
        return ConeSeat(height) if abs(height) <= half + its_half else None
    hole, pin = (slope, other) if moving.inner else (other, slope)
    lower = -1.0 if hole > pin else 1.0  # the end of the engagement at which they are nearer
    end, its_end = lower * half, lower * its_half
    height = its_end - (its + other * its_end - own) / slope
    if abs(its_end - height) <= half * (1.0 + ON_END):
        return ConeSeat(height, by_target=other / slope - 1.0)
    height = (own + slope * end - its) / other - end
    if abs(height + end) <= its_half * (1.0 + ON_END):
        return ConeSeat(height, by_moving=sign * (1.0 - slope / other))
    return None
