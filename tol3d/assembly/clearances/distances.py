"""Distances of parts in their trials, by FCL. Made in the worker, for FCL's objects do not pickle."""

from collections.abc import Mapping
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.clearances.faces import SolidMesh
from tol3d.assembly.clearances.pair import Level, SolidPair, relative_pose
from tol3d.assembly.model.statuses import OK, OVERLAP
from tol3d.cad.solids.distance import Integers, Nearest, NearestPoints, Surface, mesh_surface, overlapping, put
from tol3d.numerics.arrays import Array

Codes = NDArray[np.int8]

INSIDE = 0.5
"""Winding number of a closed mesh about a point above which the point is inside: 1 inside, 0 outside."""


class SolidDistances:
    """Reads clearances.

    Args:
        pairs: of each measure, by its name.
    """

    def __init__(self, pairs: Mapping[str, SolidPair]) -> None:
        self._readers = {name: PairDistances(pair) for name, pair in pairs.items()}

    def read(self, name: str, start: Array, end: Array) -> tuple[Array, Codes]:
        """Distances (n,) [mm], NaN where parts overlap, and codes (n,).

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
        self._asked: dict[int, Asked] = {}

    def asked(self, moved: Array) -> "Asked":
        """Cached query for points that have moved by up to `moved` (2, 3) [mm], see Level.reach."""
        levels = self._pair.levels
        number = next((k for k, level in enumerate(levels) if (moved <= level.reach).all()), len(levels))
        if number not in self._asked:
            self._asked[number] = self._made(levels[number] if number < len(levels) else None)
        return self._asked[number]

    def _made(self, level: Level | None) -> "Asked":
        if level is not None:
            return Asked(self._pair, level.faces, level.near)
        every = np.arange(len(self._pair.start.triangles)), np.arange(len(self._pair.end.triangles))
        return Asked(self._pair, every, every)

    def of(self, relative: Array) -> tuple[Array, Codes]:
        """Distances and codes, see SolidDistances.read; of poses of the second part in the frame of the first."""
        moved = self._pair.moved(relative)
        values, codes = np.empty(len(relative)), np.full(len(relative), OK, dtype=np.int8)
        for k, pose in enumerate(relative):
            distance = self._distance(pose, moved[k])
            values[k] = distance if distance > 0.0 else np.nan
            codes[k] = OK if distance > 0.0 else OVERLAP
        return values, codes

    def _distance(self, pose: Array, moved: Array) -> float:
        """0 where the parts overlap."""
        asked = self.asked(moved)
        found = asked.nearest(self._nearest, pose)
        if found.distance <= 0.0:
            return 0.0
        could_meet = np.linalg.norm(moved, axis=1).min() >= self._pair.distance
        meshes = self._pair.start, self._pair.end
        if could_meet and not asked.has_between(found, pose) and (asked.meet(pose) or is_inside(*meshes, pose)):
            return 0.0
        return found.distance


def is_inside(start: SolidMesh, end: SolidMesh, pose: Array) -> bool:
    """True if one of two parts whose surfaces do not meet lies inside the other.

    The pose places the second part in the frame of the first.
    """
    one = pose[:3, :3] @ end.vertices[0] + pose[:3, 3]
    other = pose[:3, :3].T @ (start.vertices[0] - pose[:3, 3])
    return turns_about(start.corners - one) > INSIDE or turns_about(end.corners - other) > INSIDE


class Asked:
    """Triangles of two parts that can be nearest, and those that can meet.

    Args:
        pair: the pair.
        faces: that can be nearest, of the first part and of the second.
        near: that can meet, likewise.
    """

    def __init__(self, pair: SolidPair, faces: tuple[Integers, Integers], near: tuple[Integers, Integers]) -> None:
        self._meshes = pair.start, pair.end
        self._surfaces = surface_of(pair.start, faces[0]), surface_of(pair.end, faces[1])
        self.corners = pair.start.corners[faces[0]], pair.end.corners[faces[1]]
        self._near = near

    def nearest(self, query: NearestPoints, pose: Array) -> Nearest:
        """Nearest points of the two parts, the second one at a pose (4, 4) in the frame of the first."""
        put(self._surfaces[1], pose[:3, :3], pose[:3, 3])
        return query.of(*self._surfaces)

    def has_between(self, found: Nearest, pose: Array) -> bool:
        """True if a plane separates all that can meet and both nearest points face it from their parts.

        Then no surface meets another, and neither part is in the other. False decides nothing.
        """
        (here, there), (one, other) = found.points, found.triangles
        normal, turn = there - here, pose[:3, :3]
        if (
            unit_normal(self.corners[0][one]) @ normal <= 0.0
            or turn @ unit_normal(self.corners[1][other]) @ normal >= 0.0
        ):
            return False
        first, second = self._points
        return bool(
            (first @ normal).max(initial=-np.inf)
            < (second @ (turn.T @ normal)).min(initial=np.inf) + pose[:3, 3] @ normal
        )

    @cached_property
    def _points(self) -> tuple[Array, Array]:
        """Vertices of what can meet, each in the frame of its part (n, 3) [mm]."""
        first, second = (
            mesh.vertices[np.unique(mesh.triangles[near])] for mesh, near in zip(self._meshes, self._near, strict=True)
        )
        return first, second

    @cached_property
    def _meeting(self) -> tuple[Surface, Surface]:
        return surface_of(self._meshes[0], self._near[0]), surface_of(self._meshes[1], self._near[1])

    def meet(self, pose: Array) -> bool:
        """True if surfaces meet."""
        put(self._meeting[1], pose[:3, :3], pose[:3, 3])
        return overlapping(*self._meeting)


def unit_normal(corners: Array) -> Array:
    """Outward unit normal of a triangle (3, 3); 0 if its area is 0."""
    across = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    return np.asarray(across / (np.linalg.norm(across) or 1.0))


def turns_about(corners: Array) -> float:
    """Winding number about the origin of a closed mesh, triangles (n, 3, 3) [mm].

    Solid angles by Van Oosterom and Strackee, The solid angle of a plane triangle (IEEE Trans. Biomed. Eng. 30, 1983).
    """
    a, b, c = np.moveaxis(corners, 1, 0)
    x, y, z = (np.linalg.norm(own, axis=1) for own in (a, b, c))
    volume = np.einsum("nx,nx->n", a, np.cross(b, c))
    sums = [np.einsum("nx,nx->n", one, other) for one, other in ((a, b), (b, c), (c, a))]
    angles = np.arctan2(volume, x * y * z + sums[0] * z + sums[1] * x + sums[2] * y)
    return float(angles.sum() / (2 * np.pi))


def surface_of(mesh: SolidMesh, faces: NDArray[np.int64] | None = None) -> Surface:
    """A mesh, or some of its triangles with their vertices only; all if none are named, as FCL holds no empty mesh."""
    if faces is None or not len(faces):
        return mesh_surface(mesh.vertices, mesh.triangles)
    kept, numbers = np.unique(mesh.triangles[faces], return_inverse=True)
    return mesh_surface(mesh.vertices[kept], numbers.reshape(-1, 3))
