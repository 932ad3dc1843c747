"""Two parts as they stand nominally, with what of them can be nearest: made once, in the parent."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.clearances.faces import nearby, needed
from tol3d.assembly.clearances.meshes import SolidMesh, solid_mesh
from tol3d.numerics import frames
from tol3d.solids import BuiltShape

Array = NDArray[np.float64]

SHARE = 0.5
"""Of the chord error that the first part may have; the second has what it leaves, which of a flat part is all."""

ROUNDING = 1e-6
"""mm; of distances of boxes about triangles."""


@dataclass(frozen=True, eq=False)
class SolidPair:
    """Two parts whose distance is read. It pickles.

    Args:
        start, end: their meshes, each in the frame of its part.
        nominal: pose of the second one in the frame of the first (4, 4).
        distance: nominally, by the meshes [mm].
        reach: how far points of one part may move against the other [mm] for the next four to be enough.
        start_faces, end_faces: triangles that can be nearest then, numbers of their meshes'.
        start_near, end_near: triangles that can meet the other part's then.
    """

    start: SolidMesh
    end: SolidMesh
    nominal: Array
    distance: float
    reach: float
    start_faces: NDArray[np.int64]
    end_faces: NDArray[np.int64]
    start_near: NDArray[np.int64]
    end_near: NDArray[np.int64]

    @property
    def chord_error(self) -> float:
        """How far a reading may be off [mm]."""
        return self.start.chord_error + self.end.chord_error

    def moved(self, relative: Array) -> Array:
        """How far any point of one part has moved at most against the other since it stood nominally (n,) [mm].

        Args:
            relative: poses of the second part in the frame of the first (n, 4, 4).
        """
        return np.maximum(
            _largest(relative, self.nominal, self.end.box),
            _largest(inverse(relative), inverse(self.nominal), self.start.box),
        )


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
    """The largest displacement of the corners of a box (8, 3) between poses (n, 4, 4) and a nominal one: (n,) [mm]."""
    largest = np.zeros(poses.shape[:-2])
    for corner in box:
        there = frames.apply(poses[..., :3, :3], np.broadcast_to(corner, (*poses.shape[:-2], 3))) + poses[..., :3, 3]
        off = there - (nominal[:3, :3] @ corner + nominal[:3, 3])
        square = off[..., 0] * off[..., 0] + off[..., 1] * off[..., 1] + off[..., 2] * off[..., 2]
        largest = np.maximum(largest, np.sqrt(square))
    return largest


def meshes_of(start: BuiltShape, end: BuiltShape, chord_error: float) -> tuple[SolidMesh, SolidMesh]:
    """Meshes of two solids whose chord errors together are at most as stated [mm].

    Raises:
        GeometryError: that would take too many triangles.
    """
    first = solid_mesh(start, SHARE * chord_error)
    return first, solid_mesh(end, chord_error - first.chord_error)


def solid_pair(meshes: tuple[SolidMesh, SolidMesh], nominal: Array, distance: float, reach: float) -> SolidPair:
    """A pair, for motions within a reach [mm]; see SolidPair."""
    start, end = meshes
    slack = reach + ROUNDING
    height = distance + 2 * slack
    there = end.corners @ nominal[:3, :3].T + nominal[:3, 3]
    back = inverse(nominal)
    here = start.corners @ back[:3, :3].T + back[:3, 3]
    own = needed(start.vertices, start.triangles, there, height, slack)
    its = needed(end.vertices, end.triangles, here, height, slack)
    near = nearby(start.corners, there, slack), nearby(end.corners, here, slack)
    return SolidPair(start, end, nominal, distance, reach, *map(np.flatnonzero, (own, its, *near)))
