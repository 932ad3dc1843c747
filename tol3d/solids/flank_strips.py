"""Measuring strips: profile points and normals sampled from the named flank faces of a gear's solid."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tol3d.gears import LEFT, RIGHT, Flank, Gear
from tol3d.numerics.arrays import Array
from tol3d.solids.cache import cached
from tol3d.solids.lazy import cad

Triangles = NDArray[np.int64]
Span = tuple[float, float]

WHOLE_FACE: Span = (0.0, 1.0)


@dataclass(frozen=True, eq=False)
class FlankStrips:
    """Both flanks of tooth 0 in the gear's frame, as strips between two polylines: the flanks are ruled.

    Args:
        parameter: (steps + 1,) where along the profile [rad], from where the involute begins to the tip: roll
            of a spur gear, in-plane angle of a bevel gear, uniform in its power 1.5. The sagitta of
            every step is the same then: a spur gear's is r_b t dt^2 / 8.
        inner, outer: of each flank, (steps + 1, 3) points [mm] at the lower and upper end of the face in z.
        normals: of each flank, (steps + 1, 3) unit vectors out of the tooth, from the face's derivatives; the
            same along each generator.
        chord_error: largest distance [mm] between face and polyline; the polyline lies inside the tooth.
        flank_error: largest distance [mm] of a point from the involute's at the same parameter.
    """

    parameter: Array
    inner: Mapping[Flank, Array]
    outer: Mapping[Flank, Array]
    normals: Mapping[Flank, Array]
    chord_error: float
    flank_error: float


def measuring_strips(gear: Gear, steps: int) -> FlankStrips:
    """Strips of a gear with that many steps a flank; from the cache, or from its solid, built for it."""
    arrays = cached("strips", gear, {"steps": steps}, lambda: cad().sample_flanks(gear, steps))

    def of_flanks(name: str) -> dict[Flank, Array]:
        return {flank: arrays[name][index].astype(np.float64) for index, flank in enumerate((RIGHT, LEFT))}

    return FlankStrips(
        parameter=arrays["parameter"].astype(np.float64),
        inner=of_flanks("inner"),
        outer=of_flanks("outer"),
        normals=of_flanks("normals"),
        chord_error=float(arrays["chord_error"]),
        flank_error=float(arrays["flank_error"]),
    )


def strip_mesh(
    strips: FlankStrips, flank: Flank, slack: float, scale: float = 1.0, span: Span = WHOLE_FACE
) -> tuple[Array, Triangles]:
    """The strip of one flank as triangles: two a step, none across the face, which is ruled.

    The flank is scaled first (thermal growth about the gear's origin) and then pulled into the tooth
    by `slack` [mm] along its normals, so that the slack is the same at any scale. The pulled
    polyline's own chord error is smaller than the strips', for its radius of curvature is. Within
    slack/r_b of roll 0 a flank that begins at the base circle folds over itself; contact never gets there.

    Args:
        strips, flank: which.
        slack: [mm].
        scale: growth of the gear.
        span: from where to where on the face, 0 its lower and 1 its upper end.

    Returns:
        vertices (2 (steps + 1), 3) [mm], first those at the lower end; triangles (2 steps, 3), turned outwards.
    """
    inner, outer, normals = strips.inner[flank], strips.outer[flank], strips.normals[flank]
    count = len(normals)
    vertices = np.concatenate([((1 - at) * inner + at * outer) * scale - slack * normals for at in span])
    low = np.arange(count - 1)
    near, far = (low, low + 1) if flank == RIGHT else (low + 1, low)
    first = np.stack([near, far, far + count], axis=-1)
    second = np.stack([near, far + count, near + count], axis=-1)
    return vertices, np.concatenate([first, second])
