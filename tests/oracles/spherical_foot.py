"""The foot of a point on a spherical-involute flank, in closed form."""

from dataclasses import dataclass

import numpy as np

from tol3d.gears.flank import Flank
from tol3d.gears.spherical_involute import Angles, flank_normals, involute_azimuth
from tol3d.numerics.arrays import Array


@dataclass(frozen=True, eq=False)
class FlankFoot:
    """The point of an endless flank that is nearest to a point in space, for any number of points.

    Args:
        distance: signed [mm], positive outside the tooth, (...).
        q: in-plane angle of the foot [rad], (...); negative where the flank would have to go on below its base cone.
        cone_distance: of the foot from the apex [mm], (...).
        normal: unit vector out of the tooth at the foot, (..., 3); the distance's gradient.
    """

    distance: Array
    q: Array
    cone_distance: Array
    normal: Array


def nearest_on_flank(points: Array, base: float, start: Angles, flank: Flank) -> FlankFoot:
    """Signed distance of points to a flank, in closed form.

    The rolling plane through a point holds the flank's normal too, so the foot lies in it: where the point has
    the in-plane angle q and the flank q_f, the distance is g = R sin(q - q_f) and the foot's distance from the
    apex R cos(q - q_f). The flank turned by q - q_f over sin b would pass through the point.

    Args:
        points: (..., 3) [mm], apex at the origin. Below the base cone there is no such plane: there the
            distance is that of the nearest place of the cone, no more than a sign to go by.
        base: base angle [rad].
        start: azimuth [rad] at which the flank leaves the base cone, broadcast over the points.
        flank: RIGHT or LEFT.
    """
    x, y, z = points[..., 0], points[..., 1], points[..., 2]
    sin_base, cos_base = np.sin(base), np.cos(base)
    outwards = np.sqrt(x * x + y * y)
    # R sin q cos b, as a product of sum and difference so that no digits cancel near the base cone
    above = np.maximum(outwards * cos_base - z * sin_base, 0.0) * (outwards * cos_base + z * sin_base)
    q = np.arctan2(np.sqrt(above), z)
    behind = flank * (np.arctan2(y, x) - start) - involute_azimuth(q, base)
    behind = behind - 2 * np.pi * np.round(behind / (2 * np.pi))
    q_foot = q + sin_base * behind
    radius = np.sqrt(outwards * outwards + z * z)
    return FlankFoot(
        distance=-radius * np.sin(sin_base * behind),
        q=q_foot,
        cone_distance=radius * np.cos(sin_base * behind),
        normal=flank_normals(q_foot, base, start, flank),
    )
