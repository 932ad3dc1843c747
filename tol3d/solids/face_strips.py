"""Measuring strips of any swept shape: points and normals sampled from its named faces, which are ruled along z."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.arrays import Array
from tol3d.solids.built_shape import SweptShape
from tol3d.solids.cache import cached
from tol3d.solids.lazy import cad

Triangles = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class FaceStrip:
    """One face in the frame of its part, as a strip between two polylines.

    Args:
        parameter: (steps + 1,) of the face, its u; steps leave the face by about the same distance.
        points: (steps + 1, 2) [mm].
        normals: (steps + 1, 2) unit vectors out of the part.
        width: from z = -width/2 to +width/2 [mm].
        chord_error: largest distance [mm] between face and polyline, which lies inside the part where the face is
            convex and outside where it is concave.
    """

    parameter: Array
    points: Array
    normals: Array
    width: float
    chord_error: float

    def mesh(self, slack: float) -> tuple[Array, Triangles]:
        """The strip as triangles, pulled into the part by `slack` [mm] along its normals: two a step.

        Returns:
            vertices (2 (steps + 1), 3) [mm], first those at the lower end; triangles (2 steps, 3), turned outwards.
        """
        pulled = self.points - slack * self.normals
        ends = (np.full((len(pulled), 1), end) for end in (-self.width / 2, self.width / 2))
        vertices = np.concatenate([np.hstack([pulled, end]) for end in ends])
        count, low = len(pulled), np.arange(len(pulled) - 1)
        along = pulled[1] - pulled[0]
        outwards_right = along[1] * self.normals[0, 0] - along[0] * self.normals[0, 1] > 0  # counter-clockwise outline
        near, far = (low, low + 1) if outwards_right else (low + 1, low)
        first = np.stack([near, far, far + count], axis=-1)
        second = np.stack([near, far + count, near + count], axis=-1)
        return vertices, np.concatenate([first, second])


def face_strips(shape: SweptShape, faces: Sequence[str], steps: int) -> tuple[FaceStrip, ...]:
    """Strips of faces of a shape with that many steps each; from the cache, or from its solid, built for it.

    The chord error is the largest of all of them.
    """
    settings = {"steps": float(steps)} | {face: float(number) for number, face in enumerate(faces)}
    arrays = cached("faces", shape, settings, lambda: cad().sample_faces(shape, faces, steps))
    parameter, points, normals = (arrays[name].astype(np.float64) for name in ("parameter", "points", "normals"))
    error = float(arrays["chord_error"])
    return tuple(FaceStrip(parameter[k], points[k], normals[k], shape.width, error) for k in range(len(faces)))
