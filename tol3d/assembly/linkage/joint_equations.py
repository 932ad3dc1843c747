"""Poses and twists of a loop's bodies along its tree, and residuals of the joints that close it, in kernels."""

from typing import Any

import numpy as np

from tol3d.assembly.linkage.joint_motions import (
    ALONG,
    BALL,
    CYLINDRICAL,
    FIXED,
    PRISMATIC,
    REVOLUTE,
    ROLLING,
    SCREW,
    SWING,
    UNIVERSAL,
    composed,
    motion,
    moving,
    rolled,
    rolling,
)
from tol3d.numerics.compiled import nested
from tol3d.numerics.loops import copy_matrix, fill_matrix


@nested
def forward(model: Any, state: Any, room: Any) -> None:
    """Poses and twists of all bodies from the coordinates, joint by joint of the tree."""
    tree, _, numbers, free, _ = model
    q, turns, base, child, poses, twists = state
    at, moved, made, vectors, none = room[0], room[1], room[2], room[3], room[4]
    tilt = vectors[1]
    for t in range(tree.shape[0]):
        kind, on, body, q0, f, carrier = tree[t, 0], tree[t, 1], tree[t, 2], tree[t, 3], tree[t, 4], tree[t, 5]
        if on >= 0:
            composed(poses[on], base[f], at)
        else:
            copy_matrix(at, base[f])
        if kind == ROLLING:
            if carrier >= 0:
                composed(poses[carrier], base[f + 1], made)
            else:
                copy_matrix(made, base[f + 1])
            rolled(numbers[f, 0], at, made, moved, tilt)
            composed(moved, child[f], poses[body])
            fixed = twists[on] if on >= 0 else none
            rolling(numbers[f, 0], at, tilt, moved, fixed, twists[carrier] if carrier >= 0 else none, twists[body])
            continue
        motion(kind, numbers[f], q, q0, turns[f], moved)
        composed(at, moved, made)
        composed(made, child[f], poses[body])
        if on >= 0:
            copy_matrix(twists[body], twists[on])
        else:
            fill_matrix(twists[body], 0.0)
        moving(kind, numbers[f], q, q0, at, free, twists[body], vectors)


@nested
def turn_row(seen: Any, twist: Any, r: int, c: int) -> Any:
    """Derivative of an entry of a rotation (3, 4) at an angular velocity (3,)."""
    s, t = (r + 1) % 3, (r + 2) % 3
    return twist[s] * seen[t, c] - twist[t] * seen[s, c]


@nested
def keeps(kind: int, k: int, numbers: Any, angle: float, seen: Any, twist: Any, length: float) -> Any:
    """An equation of a joint that closes a loop: its residual, and the residual's change with a twist (6,).

    Args:
        kind: of the joint.
        k: which of its equations.
        numbers: see `motion`.
        angle: approximate one of a screw [rad].
        seen: the one frame in the other (3, 4).
        twist: of it, in the other's frame, at its own origin.
        length: that turns angles into lengths.
    """
    if kind == SWING and k == 3:
        return length * (seen[1, 0] - seen[0, 1]), length * (turn_row(seen, twist, 1, 0) - turn_row(seen, twist, 0, 1))
    if kind == UNIVERSAL and k == 3:
        return length * (seen[2, 2] - numbers[9]), length * turn_row(seen, twist, 2, 2)
    if kind == PRISMATIC and k == 4:
        return length * (seen[1, 0] - seen[0, 1]), length * (turn_row(seen, twist, 1, 0) - turn_row(seen, twist, 0, 1))
    if kind == SCREW and k == 4:
        own = np.arctan2(seen[1, 0], seen[0, 0]) - angle
        own = angle + own - 2.0 * np.pi * np.round(own / (2.0 * np.pi))
        size = seen[0, 0] * seen[0, 0] + seen[1, 0] * seen[1, 0]
        rate = (seen[0, 0] * turn_row(seen, twist, 1, 0) - seen[1, 0] * turn_row(seen, twist, 0, 0)) / size
        return seen[2, 3] - numbers[0] * own, twist[5] - numbers[0] * rate
    if kind == FIXED and k >= 3:
        r, c = (k - 1) % 3, (k - 2) % 3  # (2, 1), (0, 2), (1, 0)
        own = length * (seen[r, c] - seen[c, r])
        return own, length * (turn_row(seen, twist, r, c) - turn_row(seen, twist, c, r))
    across = kind in (PRISMATIC, CYLINDRICAL, SCREW)
    shifts = 0 if kind == ALONG else (2 if across else 3)
    if k < shifts:
        return seen[k, 3], twist[3 + k]
    r = k - shifts
    return length * seen[r, 2], length * turn_row(seen, twist, r, 2)


@nested
def rows_of(kind: int) -> int:
    """Number of equations of a joint."""
    if kind == BALL:
        return 3
    if kind in (REVOLUTE, PRISMATIC, SCREW):
        return 5
    if kind == FIXED:
        return 6
    return 2 if kind == ALONG else 4


@nested
def equations(model: Any, state: Any, room: Any, length: float, matrix: Any, right: Any) -> None:
    """Residuals of the joints that close loops (rows,), their Jacobian (rows, free), then those of held motions."""
    _, shut, numbers, _, held = model
    q, _, base, child, poses, twists = state
    at, other, seen, vectors, none, twist, own = room
    count = 0
    for s in range(shut.shape[0]):
        kind, on, body, q0, f = shut[s, 0], shut[s, 1], shut[s, 2], shut[s, 3], shut[s, 4]
        if on >= 0:
            composed(poses[on], base[f], at)
        else:
            copy_matrix(at, base[f])
        if body >= 0:
            composed(poses[body], child[f], other)
        else:
            copy_matrix(other, child[f])
        for r in range(3):
            for c in range(4):
                seen[r, c] = 0.0
            vectors[0][r] = other[r, 3] - at[r, 3]
        for r in range(3):
            for k in range(3):
                for c in range(3):
                    seen[r, c] += at[k, r] * other[k, c]
                seen[r, 3] += at[k, r] * vectors[0][k]
        first = twists[on] if on >= 0 else none
        last = twists[body] if body >= 0 else none
        rows = rows_of(kind)
        for column in range(matrix.shape[1]):
            for r in range(6):
                own[r] = last[r, column] - first[r, column]
            x, y, z = other[0, 3], other[1, 3], other[2, 3]
            u = own[3] + own[1] * z - own[2] * y
            v = own[4] + own[2] * x - own[0] * z
            w = own[5] + own[0] * y - own[1] * x
            for r in range(3):
                twist[r] = at[0, r] * own[0] + at[1, r] * own[1] + at[2, r] * own[2]
                twist[3 + r] = at[0, r] * u + at[1, r] * v + at[2, r] * w
            for k in range(rows):
                lacks, rate = keeps(kind, k, numbers[f], q[q0], seen, twist, length)
                right[count + k] = lacks
                matrix[count + k, column] = rate
        count += rows
    for h in range(held.shape[0]):
        right[count] = 0.0
        for column in range(matrix.shape[1]):
            matrix[count, column] = held[h, column]
        count += 1
