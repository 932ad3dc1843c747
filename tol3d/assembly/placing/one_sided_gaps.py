"""Gaps of a part's one-sided contacts, constraints by its relations, and their changes with its pose, in kernels.

Steps of poses, in kernels.
"""

from typing import Any, Final

import numpy as np

from tol3d.numerics.compiled import nested
from tol3d.numerics.loops import copy_matrix, fill

MET: Final = 1e-13
"""Step [rad, and mm per mm of reach] at which a trial is done."""
TIMES: Final = 40
"""Corrections of the constraints; a turn of 0.1 takes 13."""


@nested
def gap_of(pose: Any, contacts: Any, k: int, i: int, on_part: bool) -> Any:
    """A gap [mm]: n . (R p + t) - h, or with the normal on the part (R n) . (t - p) - h."""
    points, normals, heights = contacts
    p, q, h = min(i, points.shape[2] - 1), min(i, normals.shape[2] - 1), min(i, heights.shape[1] - 1)
    total = -heights[k, h]
    if on_part:
        x, y, z = points[k, 0, p], points[k, 1, p], points[k, 2, p]
        for r in range(3):
            total += normals[k, r, q] * (pose[r, 0] * x + pose[r, 1] * y + pose[r, 2] * z + pose[r, 3])
    else:
        a, b, c = normals[k, 0, q], normals[k, 1, q], normals[k, 2, q]
        for r in range(3):
            total += (pose[r, 0] * a + pose[r, 1] * b + pose[r, 2] * c) * (pose[r, 3] - points[k, r, p])
    return total


@nested
def kept_at(pose: Any, kept: Any, e: int, i: int) -> Any:
    """n . (R p + s t) of what is kept."""
    vectors, normals, shifts = kept
    p, q = min(i, vectors.shape[2] - 1), min(i, normals.shape[2] - 1)
    x, y, z = vectors[e, 0, p], vectors[e, 1, p], vectors[e, 2, p]
    total = 0.0
    for r in range(3):
        here = pose[r, 0] * x + pose[r, 1] * y + pose[r, 2] * z + shifts[e] * pose[r, 3]
        total += normals[e, r, q] * here
    return total


@nested
def rows_at(pose: Any, contacts: Any, i: int, on_part: bool, reach: float, rows: Any) -> None:
    """Change of gaps per turn by reach and shift at a pose (contacts, 6)."""
    points, normals, _ = contacts
    arm, normal = np.empty(3), np.empty(3)
    for k in range(rows.shape[0]):
        p, q = min(i, points.shape[2] - 1), min(i, normals.shape[2] - 1)
        for r in range(3):
            if on_part:
                normal[r] = normals[k, r, q]
                arm[r] = pose[r, 0] * points[k, 0, p] + pose[r, 1] * points[k, 1, p] + pose[r, 2] * points[k, 2, p]
            else:
                normal[r] = (
                    pose[r, 0] * normals[k, 0, q] + pose[r, 1] * normals[k, 1, q] + pose[r, 2] * normals[k, 2, q]
                )
                arm[r] = points[k, r, p] - pose[r, 3]
        wrench(arm, normal, reach, rows[k])


@nested
def wrench(arm: Any, force: Any, reach: float, found: Any) -> None:
    """Moment by reach, and force (6,)."""
    found[0] = (arm[1] * force[2] - arm[2] * force[1]) / reach
    found[1] = (arm[2] * force[0] - arm[0] * force[2]) / reach
    found[2] = (arm[0] * force[1] - arm[1] * force[0]) / reach
    for r in range(3):
        found[3 + r] = force[r]


@nested
def pull_at(pose: Any, force: Any, reach: float, pull: Any) -> float:
    """Component of the force along turn by reach and shift (6,) at a pose; and the path of its point [mm]."""
    along, at = force
    arm = np.empty(3)
    gone = 0.0
    for r in range(3):
        arm[r] = pose[r, 0] * at[0] + pose[r, 1] * at[1] + pose[r, 2] * at[2]
        gone += along[r] * (arm[r] + pose[r, 3])
    wrench(arm, along, reach, pull)
    return gone


@nested
def tangents_at(pose: Any, kept: Any, i: int, steps: Any, reach: float, tangents: Any) -> None:
    """Steps (6, motions), turn by reach and shift, that keep the constraints at a pose.

    The nominal ones nearly do; their error is undone by nominal steps, each reducing it by the turn.
    """
    vectors, normals, shifts, undo, _ = kept
    copy_matrix(tangents, steps)
    arm, normal, row = np.empty(3), np.empty(3), np.empty(6)
    change = np.empty((shifts.shape[0], steps.shape[1]))
    largest, before = 0.0 if shifts.shape[0] == 0 else 1.0, np.inf
    while largest > MET and largest < before:  # constraints held by relations already are met as nearly as possible
        before, largest = largest, 0.0
        for e in range(shifts.shape[0]):
            p, q = min(i, vectors.shape[2] - 1), min(i, normals.shape[2] - 1)
            for r in range(3):
                normal[r] = normals[e, r, q]
                arm[r] = pose[r, 0] * vectors[e, 0, p] + pose[r, 1] * vectors[e, 1, p] + pose[r, 2] * vectors[e, 2, p]
            wrench(arm, normal, reach, row)
            for j in range(steps.shape[1]):
                change[e, j] = 0.0
                for r in range(3):
                    change[e, j] += row[r] * tangents[r, j] + shifts[e] * row[3 + r] * tangents[3 + r, j]
                largest = max(largest, abs(change[e, j]))
        for r in range(6):
            for j in range(steps.shape[1]):
                for e in range(shifts.shape[0]):
                    tangents[r, j] -= undo[r, e] * change[e, j]


@nested
def undoing(pose: Any, kept: Any, i: int, step: Any) -> None:
    """The step (6,), turn by reach and shift, that undoes a change of the constraints."""
    vectors, normals, shifts, undo, first = kept
    fill(step, 0.0)
    for e in range(first.shape[0]):
        change = kept_at(pose, (vectors, normals, shifts), e, i) - first[e]
        for r in range(6):
            step[r] -= undo[r, e] * change


@nested
def restored(pose: Any, kept: Any, i: int, reach: float, step: Any) -> None:
    """Bring back what is kept."""
    for _ in range(TIMES if kept[4].shape[0] else 0):
        undoing(pose, kept, i, step)
        if stepped(pose, step, reach) <= MET:
            break


@nested
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


@nested
def stepped(pose: Any, step: Any, reach: float) -> Any:
    """Move a pose by a step (6,), turn times reach and shift; returns its length, a turn [rad] or a shift per reach."""
    turned_by(pose, step[0] / reach, step[1] / reach, step[2] / reach)
    length = 0.0
    for r in range(3):
        pose[r, 3] += step[3 + r]
        length = max(length, abs(step[r]) / reach, abs(step[3 + r]) / reach)
    return length
