"""Two parts at their nominal poses, with the triangles that can be nearest: made once, in the parent process."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.clearances.faces import SolidMesh, nearby, needed, solid_mesh
from tol3d.cad.solids import BuiltShape
from tol3d.numerics import frames
from tol3d.numerics.arrays import Array

Integers = NDArray[np.int64]

SHARES = (0.25, 0.5, 1.0)
"""Fractions of the reach: the nearer parts are to their nominal poses, the fewer triangles they need."""
FIRST = 0.5
"""Fraction of the chord error allowed to the first part; the second has the rest, or all beside a flat part."""

ROUNDING = 1e-6
"""mm; of distances of boxes about triangles."""


@dataclass(frozen=True, eq=False)
class Level:
    """Geometry needed of two parts that have not moved far from their nominal poses.

    Args:
        reach: largest displacement of points: of the second part along x, y and z of the first, of the first along
            those of the second (2, 3) [mm].
        faces: triangles that can be nearest to the other part, numbers of the first mesh's and of the second's.
        near: triangles that can meet the other part's, likewise.
    """

    reach: Array
    faces: tuple[Integers, Integers]
    near: tuple[Integers, Integers]


@dataclass(frozen=True, eq=False)
class SolidPair:
    """Two parts whose distance is read. It pickles.

    Args:
        start, end: their meshes, each in the frame of its part.
        nominal: pose of the second one in the frame of the first (4, 4).
        distance: nominally, by the meshes [mm].
        levels: the nearest first; parts that have moved farther than all of them are read with all their triangles.
    """

    start: SolidMesh
    end: SolidMesh
    nominal: Array
    distance: float
    levels: tuple[Level, ...] = ()

    @property
    def chord_error(self) -> float:
        """Largest error of a reading due to chords [mm]."""
        return self.start.chord_error + self.end.chord_error

    def moved(self, relative: Array) -> Array:
        """Largest displacement of any point from the nominal poses (n, 2, 3) [mm], see Level.reach.

        Args:
            relative: poses of the second part in the frame of the first (n, 4, 4).
        """
        there = _largest(relative, self.nominal, self.end.box)
        return np.stack([there, _largest(inverse(relative), inverse(self.nominal), self.start.box)], axis=1)


def inverse(pose: Array) -> Array:
    """Inverses of rigid poses (..., 4, 4)."""
    turn = frames.transposed(pose[..., :3, :3])
    return frames.transform(turn, -frames.apply(turn, pose[..., :3, 3]))


def relative_pose(start: Array, end: Array) -> Array:
    """Poses of the second parts in the frames of the first (..., 4, 4)."""
    turn = frames.transposed(start[..., :3, :3])
    return frames.transform(
        frames.matmul(turn, end[..., :3, :3]), frames.apply(turn, end[..., :3, 3] - start[..., :3, 3])
    )


def _largest(poses: Array, nominal: Array, box: Array) -> Array:
    """The largest displacements of the corners of a box (8, 3) from a nominal pose to others (n, 4, 4): (n, 3) [mm]."""
    largest = np.zeros((*poses.shape[:-2], 3))
    for corner in box:
        there = frames.apply(poses[..., :3, :3], np.broadcast_to(corner, (*poses.shape[:-2], 3))) + poses[..., :3, 3]
        largest = np.maximum(largest, np.abs(there - (nominal[:3, :3] @ corner + nominal[:3, 3])))
    return largest


def meshes_of(start: BuiltShape, end: BuiltShape, chord_error: float) -> tuple[SolidMesh, SolidMesh]:
    """Meshes of two solids whose chord errors together are at most as stated [mm].

    Raises:
        GeometryError: that would take too many triangles.
    """
    first = solid_mesh(start, FIRST * chord_error)
    return first, solid_mesh(end, chord_error - first.chord_error)


def solid_pair(meshes: tuple[SolidMesh, SolidMesh], nominal: Array, distance: float, reach: Array) -> SolidPair:
    """A pair whose parts move mostly within a reach (2, 3) [mm]; see SolidPair and Level."""
    start, end = meshes
    there = end.corners @ nominal[:3, :3].T + nominal[:3, 3]
    back = inverse(nominal)
    here = start.corners @ back[:3, :3].T + back[:3, 3]
    levels = []
    for share in SHARES:
        slack = share * reach + ROUNDING
        height = distance + float(np.linalg.norm(slack, axis=1).max())
        own = needed(start.vertices, start.triangles, there, height, slack[0])
        its = needed(end.vertices, end.triangles, here, height, slack[1])
        near = nearby(start.corners, there, slack[0]), nearby(end.corners, here, slack[1])
        faces = np.flatnonzero(own), np.flatnonzero(its)
        levels.append(Level(share * reach, faces, (np.flatnonzero(near[0]), np.flatnonzero(near[1]))))
    return SolidPair(start, end, nominal, distance, tuple(levels))
