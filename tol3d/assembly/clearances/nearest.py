"""Pairs of points, one on each part, at which two parts may be nearest in trials, found from their nominal poses.

To first order the distance of the parts is the smallest distance of such a pair as its points move: vertices and edges
of flat faces over each other, one pair of smooth convex faces. Pairs are found on the meshes at slightly displaced
poses; a pair is kept if it is nearer, to first order, than all known pairs.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from tol3d.assembly.clearances.distances import Asked, PairDistances, is_inside, surface_of, unit_normal
from tol3d.assembly.clearances.faces import SolidMesh
from tol3d.assembly.clearances.pair import SolidPair, inverse, solid_pair
from tol3d.assembly.model.measures import Facing
from tol3d.cad.solids.distance import Nearest, NearestPoints, put
from tol3d.numerics import frames
from tol3d.numerics.arrays import Array

NEARER: Final = 0.1
"""Fraction of the chord error by which a pair must be nearer than the known ones to be kept."""
MOST_PAIRS: Final = 256
"""Largest number of pairs; more occur only for parts round each other, with polygons as fine as that."""
SLANT: Final = 1e-6
"""Angle [rad] between the normal of a face and a direction that is the same."""
HALVINGS: Final = 8
"""Halvings of a displacement at which the parts overlap."""


@dataclass(frozen=True)
class Displaced:
    """Small displacements of two parts, as torsors seen at the world's origin.

    Args:
        start, end: poses of the parts, nominally in the world (4, 4).
        of_start, of_end: (motions, 6) [mm, rad].
    """

    start: Array
    end: Array
    of_start: Array
    of_end: Array

    @property
    def relative(self) -> Array:
        """Nominal pose of the second part in the frame of the first (4, 4)."""
        return np.asarray(inverse(self.start) @ self.end)

    def posed(self, motion: int, share: float) -> Array:
        """Pose of the second part in the frame of the first (4, 4), moved by a share of a motion."""
        return np.asarray(
            inverse(_moved(self.start, share * self.of_start[motion])) @ _moved(self.end, share * self.of_end[motion])
        )


def _moved(pose: Array, torsor: Array) -> Array:
    turn = frames.about_vector(torsor[3:])
    moved = np.eye(4)
    moved[:3, :3], moved[:3, 3] = turn @ pose[:3, :3], turn @ pose[:3, 3] + torsor[:3]
    return moved


def nominal_distance(meshes: tuple[SolidMesh, SolidMesh], relative: Array) -> float:
    """Nominal distance of two parts [mm]; 0 if they overlap or one lies inside the other."""
    first, second = (surface_of(mesh) for mesh in meshes)
    put(second, relative[:3, :3], relative[:3, 3])
    found = float(max(NearestPoints().of(first, second).distance, 0.0))
    return 0.0 if found > 0.0 and is_inside(*meshes, relative) else found


def facing(meshes: tuple[SolidMesh, SolidMesh], displaced: Displaced, distance: float, chord_error: float) -> Facing:
    """Pairs of points of two parts, and their relative displacements.

    Args:
        meshes: of both.
        displaced: motions like those of trials, the widest of them included.
        distance: nominally, above 0 [mm].
        chord_error: that is stated [mm].
    """
    motions = range(len(displaced.of_start))
    poses = np.array([displaced.posed(k, 1.0) for k in motions]).reshape(-1, 4, 4)
    reach = SolidPair(*meshes, displaced.relative, distance).moved(poses).max(axis=0, initial=0.0)
    search = _Search(solid_pair(meshes, displaced.relative, distance, reach), displaced, NEARER * chord_error)
    search.ask(displaced.relative)
    for k in motions:
        search.along(k)
    kept = search.kept
    starts, ends, normals = (np.array([getattr(own, side) for own in kept]) for side in ("start", "end", "normal"))
    return Facing(starts, ends, normals, np.array([own.length for own in kept]), reach)


@dataclass(frozen=True)
class _Kept:
    """A pair of points; see Facing. And its distances in all motions, to first order (motions,) [mm]."""

    start: Array
    end: Array
    normal: Array
    length: float
    moved: Array


class _Search:
    def __init__(self, pair: SolidPair, displaced: Displaced, nearer: float) -> None:
        self.kept: list[_Kept] = []
        self._pair, self._displaced, self._nearer = pair, displaced, nearer
        self._nearest, self._distances = NearestPoints(), PairDistances(pair)

    def along(self, motion: int) -> None:
        """Query at a motion, or at the fraction of it before the parts overlap."""
        for halving in range(HALVINGS):
            if self.ask(self._displaced.posed(motion, 0.5**halving), motion):
                return

    def ask(self, pose: Array, motion: int | None = None) -> bool:
        """Keep the nearest points at a pose (4, 4) if no pair is as near; True if the parts are apart there."""
        asked = self._distances.asked(self._pair.moved(pose[None])[0])
        found = asked.nearest(self._nearest, pose)
        if found.distance <= 0.0:
            return False
        own = self._kept(found, pose, asked)
        known = min((each.moved[motion] for each in self.kept), default=np.inf) if motion is not None else np.inf
        if motion is None or (own.moved[motion] < known - self._nearer and len(self.kept) < MOST_PAIRS):
            self.kept.append(own)
        return True

    def _kept(self, found: Nearest, pose: Array, asked: Asked) -> _Kept:
        """The pair found at a pose; for a point over a face, with the point nominally below it."""
        relative, turn = self._displaced.relative, pose[:3, :3]
        start, there = found.points
        end = turn.T @ (there - pose[:3, 3])
        across = [unit_normal(corners[number]) for corners, number in zip(asked.corners, found.triangles, strict=True)]
        normal = (there - start) / np.linalg.norm(there - start)
        at = relative[:3, :3] @ end + relative[:3, 3]  # nominally, in the frame of the first part
        if np.linalg.norm(normal + turn @ across[1]) < SLANT:  # a face of the second part, with which the normal turns
            normal = -relative[:3, :3] @ across[1]
            end = relative[:3, :3].T @ (start + float(normal @ (at - start)) * normal - relative[:3, 3])
        elif np.linalg.norm(normal - across[0]) < SLANT:
            normal = across[0]
            start = at - float(normal @ (at - start)) * normal
        at = relative[:3, :3] @ end + relative[:3, 3]
        apart = float(normal @ (at - start))
        length = max(apart, self.kept[0].length) if self.kept else apart
        return _Kept(np.array(start), end, normal, length, length + self._closing(start, end, normal))

    def _closing(self, start: Array, end: Array, normal: Array) -> Array:
        """Changes of the distance of two points along a normal, to first order, in all motions (motions,) [mm]."""
        displaced = self._displaced
        along = displaced.start[:3, :3] @ normal
        changes = []
        for pose, point, torsors in (
            (displaced.start, start, displaced.of_start),
            (displaced.end, end, displaced.of_end),
        ):
            at = pose[:3, :3] @ point + pose[:3, 3]
            changes.append(torsors[:, :3] @ along + torsors[:, 3:] @ np.cross(at, along))
        return np.asarray(changes[1] - changes[0])
