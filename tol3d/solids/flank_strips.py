"""Measuring strips: profile points and normals sampled from the named flank faces of a gear's solid."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tol3d.gears import LEFT, RIGHT, Flank, SpurGear
from tol3d.solids.cache import cached
from tol3d.solids.door import cad

Array = NDArray[np.float64]
Triangles = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class FlankStrips:
    """Both flanks of tooth 0 in the gear's frame, as polylines in the transverse plane.

    Args:
        roll: (steps + 1,) roll angles [rad] from where the involute begins to the tip, uniform in
            roll^1.5: the sagitta r_b t dt^2 / 8 is then the same at every step.
        profile: of each flank, (steps + 1, 2) points [mm] on the solid's face.
        normals: of each flank, (steps + 1, 2) unit vectors out of the tooth, from the face's derivatives.
        half_width: half the face width [mm]; the strips reach from -half_width to +half_width in z.
        chord_error: largest distance [mm] between face and polyline; the polyline lies inside the tooth.
        flank_error: largest distance [mm] of a profile point from the involute's at the same roll.
    """

    roll: Array
    profile: Mapping[Flank, Array]
    normals: Mapping[Flank, Array]
    half_width: float
    chord_error: float
    flank_error: float


def measuring_strips(gear: SpurGear, steps: int) -> FlankStrips:
    """Strips of a gear with that many steps a flank; from the cache, or from its solid, built for it."""
    arrays = cached("strips", gear, {"steps": steps}, lambda: cad().sample_flanks(gear, steps))
    return FlankStrips(
        roll=arrays["roll"].astype(np.float64),
        profile={flank: arrays["profile"][index].astype(np.float64) for index, flank in enumerate((RIGHT, LEFT))},
        normals={flank: arrays["normals"][index].astype(np.float64) for index, flank in enumerate((RIGHT, LEFT))},
        half_width=gear.face_width / 2,
        chord_error=float(arrays["chord_error"]),
        flank_error=float(arrays["flank_error"]),
    )


def strip_mesh(strips: FlankStrips, flank: Flank, slack: float, scale: float = 1.0) -> tuple[Array, Triangles]:
    """The strip of one flank as triangles: two a step, none across the face, which is ruled along z.

    The flank is scaled first (thermal growth about the gear's centre) and then pulled into the tooth
    by `slack` [mm] along its normals, so that the slack stays what it is at any scale. The pulled
    polyline's own chord error is smaller than the strips', for its radius of curvature is. Within
    slack/r_b of roll 0 a flank that begins at the base circle folds over itself; contact never gets there.

    Returns:
        vertices (2 (steps + 1), 3) [mm], first those at -z; triangles (2 steps, 3), turned outwards.
    """
    points = strips.profile[flank] * scale - slack * strips.normals[flank]
    count = len(points)
    ends = [np.full((count, 1), side * strips.half_width * scale) for side in (-1.0, 1.0)]
    vertices = np.concatenate([np.hstack([points, end]) for end in ends])
    low = np.arange(count - 1)
    near, far = (low, low + 1) if flank == RIGHT else (low + 1, low)
    first = np.stack([near, far, far + count], axis=-1)
    second = np.stack([near, far + count, near + count], axis=-1)
    return vertices, np.concatenate([first, second])
