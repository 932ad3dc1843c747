"""Where two parts may be nearest in trials, seen from their nominal poses: pairs of points, one on each.

To first order the distance of the parts is the least of the distances of such pairs as their points move: vertices and
edges of flat faces over each other, one pair of smooth convex faces. Which pairs there are is asked of the meshes at
poses that small displacements give; a pair is kept where it is nearer, to first order, than all that are known.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.clearances.distances import surface_of
from tol3d.assembly.clearances.meshes import SolidMesh
from tol3d.assembly.clearances.pair import SolidPair, inverse, solid_pair
from tol3d.assembly.model.facing import Facing
from tol3d.numerics import frames
from tol3d.solids.distance import NearestPoints, put

Array = NDArray[np.float64]

NEARER: Final = 0.1
"""Of the chord error: by how much a pair must be nearer than the known ones to be kept."""
MOST_PAIRS: Final = 256
"""That are kept; more are of parts round each other, whose polygons are as fine as that."""
HALVINGS: Final = 8
"""How often a displacement by which the parts overlap is made half as large."""


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
    """Of two parts as they stand nominally [mm]; 0 where they overlap."""
    first, second = (surface_of(mesh) for mesh in meshes)
    put(second, relative[:3, :3], relative[:3, 3])
    return float(max(NearestPoints().of(first, second).distance, 0.0))


def facing(meshes: tuple[SolidMesh, SolidMesh], displaced: Displaced, distance: float, chord_error: float) -> Facing:
    """The pairs of points of two parts, and how far they move against each other.

    Args:
        meshes: of both.
        displaced: motions like those of trials, the widest of them included.
        distance: nominally, above 0 [mm].
        chord_error: that is stated [mm].
    """
    motions = range(len(displaced.of_start))
    still = SolidPair(*meshes, displaced.relative, distance, 0.0, *(np.zeros(0, dtype=np.int64),) * 2)
    poses = np.array([displaced.posed(k, 1.0) for k in motions]).reshape(-1, 4, 4)
    reach = float(still.moved(poses).max(initial=0.0))
    search = _Search(solid_pair(meshes, displaced.relative, distance, reach), displaced, NEARER * chord_error)
    search.ask(displaced.relative)
    for k in motions:
        search.along(k)
    return Facing(np.array(search.starts), np.array(search.ends), reach)


@dataclass
class _Search:
    pair: SolidPair
    displaced: Displaced
    nearer: float
    starts: list[Array] = field(default_factory=list)
    ends: list[Array] = field(default_factory=list)
    lengths: list[Array] = field(default_factory=list)

    def __post_init__(self) -> None:
        self._nearest = NearestPoints()
        self._first, self._second = (
            surface_of(mesh, faces)
            for mesh, faces in ((self.pair.start, self.pair.start_faces), (self.pair.end, self.pair.end_faces))
        )

    def along(self, motion: int) -> None:
        """Ask at a motion, or at the part of it by which the parts do not overlap yet."""
        for halving in range(HALVINGS):
            if self.ask(self.displaced.posed(motion, 0.5**halving), motion):
                return

    def ask(self, pose: Array, motion: int | None = None) -> bool:
        """Keep the nearest points at a pose (4, 4), if no pair is as near; whether the parts are apart there."""
        put(self._second, pose[:3, :3], pose[:3, 3])
        found = self._nearest.of(self._first, self._second)
        if found.distance <= 0.0:
            return False
        start, end = found.points[0], pose[:3, :3].T @ (found.points[1] - pose[:3, 3])
        length = self._to_first_order(start, end)
        known = min((own[motion] for own in self.lengths), default=np.inf) if motion is not None else np.inf
        if motion is None or (length[motion] < known - self.nearer and len(self.starts) < MOST_PAIRS):
            self.starts.append(np.array(start))
            self.ends.append(np.array(end))
            self.lengths.append(length)
        return True

    def _to_first_order(self, start: Array, end: Array) -> Array:
        """Distances of two points, in the frames of their parts, in all motions (motions,) [mm]."""
        own, its = self.displaced.start, self.displaced.end
        here, there = own[:3, :3] @ start + own[:3, 3], its[:3, :3] @ end + its[:3, 3]
        length = float(np.linalg.norm(there - here))
        normal = (there - here) / length
        changes: Sequence[Array] = [
            torsors[:, :3] @ normal + torsors[:, 3:] @ np.cross(point, normal)
            for point, torsors in ((there, self.displaced.of_end), (here, self.displaced.of_start))
        ]
        return np.asarray(length + changes[0] - changes[1])
