"""Triangles of the faces of a foreign part, each with its face: for pictures, and for selecting by a point."""

from collections.abc import Sequence, Set
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.cad.solids.lazy import Arrays
from tol3d.numerics.arrays import Array

JOINED: Final = 1e-5
"""mm; nodes of two faces on one edge agree to OCC's 1e-7, others lie much further apart."""
DECIMALS: Final = 4
"""Decimals of a point of a face [mm], as short as a person would paste it."""

Triple = tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class FaceMesh:
    """Triangles of some faces [mm].

    Args:
        vertices: (n, 3).
        triangles: (m, 3) vertex numbers, turned outwards.
        faces: (m,) the number in the file of the face of each.
        off: (k, 2) face and largest distance between it and its triangles.
        bare: faces that cannot be triangulated.
    """

    vertices: Array
    triangles: NDArray[np.int64]
    faces: NDArray[np.int64]
    off: Array
    bare: frozenset[int] = frozenset()

    @classmethod
    def of(cls, arrays: Arrays) -> "FaceMesh":
        """Mesh from the arrays of the process that read the file, vertices on edges joined.

        Raises:
            KeyError, TypeError, ValueError: it is no mesh.
        """
        nodes, corners = arrays["nodes"].astype(np.float64), arrays["corners"].astype(np.int64)
        owners, off = arrays["faces"].astype(np.int64), arrays["off"].astype(np.float64)
        fits = nodes.ndim == corners.ndim == off.ndim == 2 and corners.shape == (len(owners), 3) and off.shape[1] == 2
        inside = corners.min(initial=0) >= 0 and corners.max(initial=-1) < len(nodes)
        if not fits or not np.isfinite(nodes).all() or not inside:
            raise ValueError("no mesh")
        _, first, number = np.unique(
            np.round(nodes / JOINED).astype(np.int64), axis=0, return_index=True, return_inverse=True
        )
        triangles = number.ravel()[corners]
        a, b, c = triangles.T
        whole = (a != b) & (b != c) & (c != a)
        bare = frozenset(arrays["bare"].astype(np.int64).tolist())
        return cls(nodes[first], triangles[whole], owners[whole], off, bare)

    @property
    def chord_error(self) -> float:
        """Largest distance between faces and triangles [mm]."""
        return float(self.off[:, 1].max(initial=0.0))

    def of_faces(self, faces: Set[int]) -> "FaceMesh":
        """The triangles of some faces alone."""
        numbers = np.array(sorted(faces), dtype=np.int64)
        own = np.isin(self.faces, numbers)
        used, triangles = np.unique(self.triangles[own], return_inverse=True)
        off = self.off[np.isin(self.off[:, 0], numbers)]
        return FaceMesh(self.vertices[used], triangles.reshape(-1, 3), self.faces[own], off, self.bare & faces)

    def corners(self, faces: Sequence[int]) -> Array:
        """Corners (m, 3, 3) of the triangles of some faces."""
        own = np.isin(self.faces, np.array(faces, dtype=np.int64))
        return np.asarray(self.vertices[self.triangles[own]])

    def middle(self, faces: Sequence[int]) -> Triple | None:
        """A point of some faces: the middle of their largest triangle, to a tenth of a micrometre; None without any."""
        corners = self.corners(faces)
        if not len(corners):
            return None
        areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
        x, y, z = (round(float(own), DECIMALS) + 0.0 for own in corners[int(np.argmax(areas))].mean(axis=0))
        return x, y, z

    def distance(self, point: Array, faces: Sequence[int], *, less_error: bool) -> float:
        """Distance of a point (3,) from some faces [mm].

        Args:
            point: the point.
            faces: their numbers in the file.
            less_error: subtract the error of their triangles, so that it is 0 for a point on them.
        """
        found = nearest(point, self.corners(faces))
        if not less_error:
            return found
        off = self.off[np.isin(self.off[:, 0], np.array(faces, dtype=np.int64)), 1].max(initial=0.0)
        return max(0.0, found - float(off))


def nearest(point: Array, corners: Array) -> float:
    """Distance of a point (3,) from triangles (m, 3, 3); infinite of none."""
    if not len(corners):
        return float("inf")
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    distances = [_from_segments(point, *ends) for ends in ((a, b), (b, c), (c, a))]
    normal = np.cross(b - a, c - a)
    size = np.linalg.norm(normal, axis=1)
    flat = size > 0.0
    normal = normal[flat] / size[flat, None]
    above = ((point - a[flat]) * normal).sum(axis=1)
    inside = np.ones(len(normal), dtype=bool)
    for start, end in ((a, b), (b, c), (c, a)):
        inside &= (np.cross(end[flat] - start[flat], point - start[flat]) * normal).sum(axis=1) >= 0.0
    return float(min(np.abs(above[inside]).min(initial=np.inf), *(distance.min() for distance in distances)))


def _from_segments(point: Array, start: Array, end: Array) -> Array:
    """Distances (m,) of a point (3,) from segments (m, 3)."""
    along = end - start
    squared = np.maximum((along * along).sum(axis=1), 1e-300)
    place = np.clip(((point - start) * along).sum(axis=1) / squared, 0.0, 1.0)
    return np.asarray(np.linalg.norm(start + place[:, None] * along - point, axis=1))
