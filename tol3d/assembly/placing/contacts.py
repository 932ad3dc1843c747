"""Six contacts of points on planes: the finite pose, trial by trial.

A contact asks n . (R p + t) = h. Each step solves it as if it were linear, about the pose reached: first with the
inverse of the nominal contacts, which gains as many digits a step as the turn is small; where that does not do, by
Newton's method. A trial ends by its own steps, so that it has the same bits alone and among thousands.
"""

from typing import Any, Final

import numpy as np

from tol3d.numerics.compiled import kernel, part

CHORDS: Final = 14
"""Steps with the nominal inverse before Newton's method; a turn of 1e-2 takes seven."""
NEWTONS: Final = 60
MET: Final = 1e-13
"""Step [rad, and mm a mm of the points' reach] after which a trial is done: the next one were shorter yet."""
NO_PIVOT: Final = 1e-12
"""Pivot of equations in lengths of 1, under which the contacts have lost their rank."""


@part
def turned_by(pose: Any, a: float, b: float, c: float) -> None:
    """Turn the rotation of a pose (3, 4) further, about (a, b, c) by 2 atan(|(a, b, c)| / 2): Cayley's formula."""
    a, b, c = a / 2, b / 2, c / 2
    share = 2.0 / (1.0 + a * a + b * b + c * c)
    for k in range(3):
        x, y, z = pose[0, k], pose[1, k], pose[2, k]
        u, v, w = b * z - c * y, c * x - a * z, a * y - b * x
        pose[0, k] = x + share * (u + b * w - c * v)
        pose[1, k] = y + share * (v + c * u - a * w)
        pose[2, k] = z + share * (w + a * v - b * u)


@part
def solved(matrix: Any, right: Any, count: int) -> Any:
    """Solve count equations in place by elimination with pivots; the least pivot."""
    least = np.inf
    for k in range(count):
        best = k
        for i in range(k + 1, count):
            if abs(matrix[i, k]) > abs(matrix[best, k]):
                best = i
        if best != k:
            for j in range(k, count):
                matrix[k, j], matrix[best, j] = matrix[best, j], matrix[k, j]
            right[k], right[best] = right[best], right[k]
        pivot = matrix[k, k]
        least = min(least, abs(pivot))
        if not abs(pivot) > NO_PIVOT:
            return 0.0
        for i in range(k + 1, count):
            factor = matrix[i, k] / pivot
            for j in range(k + 1, count):
                matrix[i, j] -= factor * matrix[k, j]
            right[i] -= factor * right[k]
    for k in range(count - 1, -1, -1):
        total = right[k]
        for j in range(k + 1, count):
            total -= matrix[k, j] * right[j]
        right[k] = total / matrix[k, k]
    return least


@part
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


@part
def stepped(pose: Any, step: Any, reach: float) -> Any:
    """Move a pose by a step: turn [1 / reach] and shift; its length [reach]."""
    turned_by(pose, step[0] / reach, step[1] / reach, step[2] / reach)
    length = 0.0
    for r in range(3):
        pose[r, 3] += step[3 + r]
        length = max(length, abs(step[r]) / reach, abs(step[3 + r]) / reach)
    return length


@part
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


@part
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
        if not solved(matrix, right, 6) > 0.0:
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
    """Poses of contacts.

    Args:
        points, normals, heights: p, n (6, 3, n) and h (6, n) of the contacts [mm]; (..., 1) of what does not vary.
        inverse: of the contacts' rows as they are nominally: turn by reach, then shift (6, 6).
        start: the nominal pose (3, 4).
        reach: of the points about the origin of p [mm].
        turns, shifts: found (3, 3, n), (3, n) [mm]; not a number where they are not met.
        met: whether they are (n,).
    """
    contacts = (points, normals, heights)
    rooms = (np.empty((6, 3)), np.empty(6), np.empty(6), np.empty((6, 6)))
    pose = np.empty((3, 4))
    for i in range(met.shape[0]):
        pose[:] = start
        found = by_chords(pose, contacts, i, inverse, reach, rooms)
        if not found:
            pose[:] = start
            found = by_newton(pose, contacts, i, reach, rooms)
        met[i] = found
        for r in range(3):
            for c in range(3):
                turns[r, c, i] = pose[r, c] if found else np.nan
            shifts[r, i] = pose[r, 3] if found else np.nan
