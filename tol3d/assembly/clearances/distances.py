"""Distances of parts in their trials, by FCL. Made in the worker, for FCL's objects do not pickle."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.clearances.meshes import SolidMesh
from tol3d.assembly.clearances.pair import SolidPair, relative_pose
from tol3d.assembly.model.statuses import OK, OVERLAP
from tol3d.solids.distance import NearestPoints, Surface, mesh_surface, overlapping, put

Array = NDArray[np.float64]
Codes = NDArray[np.int8]

INSIDE = 0.5
"""Turns that a closed mesh makes about a point in it: 1 inside, 0 outside."""


class SolidDistances:
    """Reads clearances.

    Args:
        pairs: of each measure, by its name.
    """

    def __init__(self, pairs: Mapping[str, SolidPair]) -> None:
        self._readers = {name: PairDistances(pair) for name, pair in pairs.items()}

    def read(self, name: str, start: Array, end: Array) -> tuple[Array, Codes]:
        """Distances (n,) [mm], not a number where parts overlap, and codes (n,).

        Args:
            name: of the measure.
            start, end: poses of both parts in the world (n, 4, 4).
        """
        return self._readers[name].of(relative_pose(start, end))


class PairDistances:
    """Reads the distance of two parts."""

    def __init__(self, pair: SolidPair) -> None:
        self._pair = pair
        self._nearest = NearestPoints()
        self._faces = surface_of(pair.start, pair.start_faces), surface_of(pair.end, pair.end_faces)
        self._whole: tuple[Surface, Surface] | None = None

    def of(self, relative: Array) -> tuple[Array, Codes]:
        """Distances and codes, see SolidDistances.read; of poses of the second part in the frame of the first."""
        moved = self._pair.moved(relative)
        values, codes = np.empty(len(relative)), np.full(len(relative), OK, dtype=np.int8)
        for k, pose in enumerate(relative):
            distance = self._distance(pose, float(moved[k]))
            values[k] = distance if distance > 0.0 else np.nan
            codes[k] = OK if distance > 0.0 else OVERLAP
        return values, codes

    def _distance(self, pose: Array, moved: float) -> float:
        """0 where the parts overlap."""
        pair = self._pair
        enough = moved <= pair.reach
        if moved >= pair.distance and self._overlap(pose):
            return 0.0
        first, second = self._faces if enough else self._solids
        put(second, pose[:3, :3], pose[:3, 3])
        return max(self._nearest.of(first, second).distance, 0.0)

    @property
    def _solids(self) -> tuple[Surface, Surface]:
        """All triangles of both: for parts that have moved far, and made when the first of them has."""
        if self._whole is None:
            self._whole = surface_of(self._pair.start), surface_of(self._pair.end)
        return self._whole

    def _overlap(self, pose: Array) -> bool:
        """Whether the parts meet, or one lies in the other."""
        first, second = self._solids
        put(second, pose[:3, :3], pose[:3, 3])
        if overlapping(first, second):
            return True
        start, end = self._pair.start, self._pair.end
        one = pose[:3, :3] @ end.vertices[0] + pose[:3, 3]
        other = pose[:3, :3].T @ (start.vertices[0] - pose[:3, 3])
        return turns_about(start.corners - one) > INSIDE or turns_about(end.corners - other) > INSIDE


def turns_about(corners: Array) -> float:
    """How often a closed mesh, triangles (n, 3, 3) [mm], goes around the origin.

    Solid angles by Van Oosterom and Strackee, The solid angle of a plane triangle (IEEE Trans. Biomed. Eng. 30, 1983).
    """
    a, b, c = np.moveaxis(corners, 1, 0)
    x, y, z = (np.linalg.norm(own, axis=1) for own in (a, b, c))
    volume = np.einsum("nx,nx->n", a, np.cross(b, c))
    sums = [np.einsum("nx,nx->n", one, other) for one, other in ((a, b), (b, c), (c, a))]
    angles = np.arctan2(volume, x * y * z + sums[0] * z + sums[1] * x + sums[2] * y)
    return float(angles.sum() / (2 * np.pi))


def surface_of(mesh: SolidMesh, faces: NDArray[np.int64] | None = None) -> Surface:
    """A mesh, or some of its triangles with no vertices but theirs."""
    if faces is None:
        return mesh_surface(mesh.vertices, mesh.triangles)
    kept, numbers = np.unique(mesh.triangles[faces], return_inverse=True)
    return mesh_surface(mesh.vertices[kept], numbers.reshape(-1, 3))
