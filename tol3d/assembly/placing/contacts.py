"""Six contacts of points on planes: the finite pose, trial by trial.

A contact asks n . (R p + t) = h. Each step solves it as if it were linear, about the pose reached: first with the
inverse of the nominal contacts, which gains as many digits a step as the turn is small; where that does not do, by
Newton's method. A trial ends by its own steps, so that it has the same bits alone and among thousands.
"""

from typing import Any, Final

import numpy as np

from tol3d.assembly.placing.pose_steps import solved, stepped
from tol3d.numerics.compiled import kernel, nested
from tol3d.numerics.loops import copy_matrix

CHORDS: Final = 14
"""Steps with the nominal inverse before Newton's method; a turn of 1e-2 takes seven."""
NEWTONS: Final = 60
MET: Final = 1e-13
"""Step [rad, and mm a mm of the points' reach] after which a trial is done: the next one were shorter yet."""


@nested
def missing(pose: Any, contacts: Any, i: int, arms: Any, right: Any) -> None:
    """What each contact lacks, and the arms R p of the points."""
    points, normals, heights = contacts
    p, q, h = min(i, points.shape[2] - 1), min(i, normals.shape[2] - 1), min(i, heights.shape[1] - 1)
    for k in range(6):
        x, y, z = points[k, 0, p], points[k, 1, p], points[k, 2, p]
        for r in range(3):
            arms[k, r] = pose[r, 0] * x + pose[r, 1] * y + pose[r, 2] * z
        right[k] = heights[k, h] - (
            normals[k, 0, q] * (arms[k, 0] + pose[0, 3])
            + normals[k, 1, q] * (arms[k, 1] + pose[1, 3])
            + normals[k, 2, q] * (arms[k, 2] + pose[2, 3])
        )


@nested
def by_chords(pose: Any, contacts: Any, i: int, inverse: Any, reach: float, rooms: Any) -> bool:
    """Whether the nominal inverse finds the pose."""
    arms, right, step, _ = rooms
    before = np.inf
    for _ in range(CHORDS):
        missing(pose, contacts, i, arms, right)
        for r in range(6):
            total = 0.0
            for k in range(6):
                total += inverse[r, k] * right[k]
            step[r] = total
        length = stepped(pose, step, reach)
        if length <= MET:
            return True
        if not length < before / 2:
            return False
        before = length
    return False


@nested
def by_newton(pose: Any, contacts: Any, i: int, reach: float, rooms: Any) -> bool:
    """Whether Newton's method finds the pose."""
    normals = contacts[1]
    q = min(i, normals.shape[2] - 1)
    arms, right, _, matrix = rooms
    for _ in range(NEWTONS):
        missing(pose, contacts, i, arms, right)
        for k in range(6):
            a, b, c = normals[k, 0, q], normals[k, 1, q], normals[k, 2, q]
            x, y, z = arms[k, 0], arms[k, 1], arms[k, 2]
            matrix[k, 0], matrix[k, 1], matrix[k, 2] = (
                (y * c - z * b) / reach,
                (z * a - x * c) / reach,
                (x * b - y * a) / reach,
            )
            matrix[k, 3], matrix[k, 4], matrix[k, 5] = a, b, c
        if not solved(matrix, right, 6):
            return False
        length = stepped(pose, right, reach)
        if length <= MET:
            return True
        if not length < np.inf:
            return False
    return False


@kernel(
    arrays="float64[:,:,::1], float64[:,:,::1], float64[:,::1], float64[:,::1], float64[:,::1], float64, "
    "float64[:,:,::1], float64[:,::1], boolean[::1]"
)
def contacts_met(
    points: Any, normals: Any, heights: Any, inverse: Any, start: Any, reach: float, turns: Any, shifts: Any, met: Any
) -> None:
    """Poses of contacts: of the middle of the points, from where it lies nominally.

    Args:
        points, normals, heights: p from the middle, n (6, 3, n) and h (6, n) of the contacts [mm]; (..., 1) of what
            does not vary.
        inverse: of the contacts' rows as they are nominally: turn by reach, then shift (6, 6).
        start: the nominal pose (3, 4).
        reach: of the points about the middle [mm].
        turns, shifts: found (3, 3, n), (3, n) [mm]; not a number where they are not met.
        met: whether they are (n,).
    """
    contacts = (points, normals, heights)
    rooms = (np.empty((6, 3)), np.empty(6), np.empty(6), np.empty((6, 6)))
    pose = np.empty((3, 4))
    for i in range(met.shape[0]):
        copy_matrix(pose, start)
        found = by_chords(pose, contacts, i, inverse, reach, rooms)
        if not found:
            copy_matrix(pose, start)
            found = by_newton(pose, contacts, i, reach, rooms)
        met[i] = found
        for r in range(3):
            for c in range(3):
                turns[r, c, i] = pose[r, c] if found else np.nan
            shifts[r, i] = pose[r, 3] if found else np.nan
