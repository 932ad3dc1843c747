"""Loops closed trial by trial, in a kernel: Newton on the equations of the joints, with exact Jacobians.

Joints that span a tree from the placed bodies place all others by their coordinates: turns, slides, tilts. Each joint
beside the tree shuts a loop, and asks for what its kind keeps: equations of its two frames. The Jacobian follows from
the twists of the bodies, a column for each coordinate that is free.

A trial begins at the nominal pose. Where the root that Newton finds from there is far, on the other side of a singular
pose, or none, the deviations are brought in step by step, so that the branch of the nominal pose is followed.
"""

from typing import Any, Final

import numpy as np

from tol3d.assembly.model.statuses import DOES_NOT_CLOSE, OK, OTHER_BRANCH, SINGULAR
from tol3d.linkage.joint_kinds import (
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
)
from tol3d.numerics.compiled import kernel, nested
from tol3d.numerics.loops import copy, copy_matrix, fill, fill_matrix

STEPS: Final = 24
"""Of Newton, most trials take 3."""
MET: Final = 1e-11
"""Last step, as a share of the loop's length, or rad: what it leaves is its square."""
LONGEST: Final = 0.4
"""Longest step [rad, or of the loop's length]; a longer one is shortened."""
SMALL: Final = 3e-3
"""Way from the nominal pose [rad, or of the loop's length] after which a root is followed step by step."""
QUICK: Final = 6
"""Steps of Newton after which it is, too."""
PARTS: Final = 32
"""Steps in which deviations are brought in."""
FLAT: Final = 1e-6
"""Least singular value of the Jacobian, lengths as shares of the loop's, at which a pose is singular."""
SUSPECT: Final = 1e-3
"""Pivot under which the least singular value is looked at."""
STRAIGHT: Final = 1e-4
"""Angle [rad] below which series take the place of sines."""


@nested
def composed(left: Any, right: Any, to: Any) -> None:
    """A pose after another one, (3, 4) each."""
    for r in range(3):
        for c in range(4):
            to[r, c] = left[r, 0] * right[0, c] + left[r, 1] * right[1, c] + left[r, 2] * right[2, c]
        to[r, 3] += left[r, 3]


@nested
def rotation_of(x: float, y: float, z: float, to: Any) -> None:
    """The rotation (3, 3) of a rotation vector."""
    square = x * x + y * y + z * z
    angle = np.sqrt(square)
    if angle > STRAIGHT:
        a, b = np.sin(angle) / angle, (1.0 - np.cos(angle)) / square
    else:
        a, b = 1.0 - square / 6.0, 0.5 - square / 24.0
    to[0, 0] = 1.0 - b * (y * y + z * z)
    to[1, 1] = 1.0 - b * (x * x + z * z)
    to[2, 2] = 1.0 - b * (x * x + y * y)
    to[0, 1], to[1, 0] = b * x * y - a * z, b * x * y + a * z
    to[0, 2], to[2, 0] = b * x * z + a * y, b * x * z - a * y
    to[1, 2], to[2, 1] = b * y * z - a * x, b * y * z + a * x


@nested
def rate_of(x: float, y: float, u: float, v: float, to: Any) -> None:
    """The angular velocity (3,) of the rotation by (x, y, 0) while that changes by (u, v, 0)."""
    square = x * x + y * y
    angle = np.sqrt(square)
    if angle > STRAIGHT:
        b, c = (1.0 - np.cos(angle)) / square, (angle - np.sin(angle)) / (square * angle)
    else:
        b, c = 0.5 - square / 24.0, 1.0 / 6.0 - square / 120.0
    spin = x * v - y * u
    to[0] = u + c * y * spin
    to[1] = v - c * x * spin
    to[2] = b * spin


@nested
def motion(kind: int, numbers: Any, q: Any, q0: int, turn: Any, to: Any) -> None:
    """What the coordinates of a joint make of its frame: a pose (3, 4).

    Args:
        kind: the joint's.
        numbers: its lead a radian or its ratio, then a rotation between its two axes (10,).
        q: all coordinates.
        q0: the first of its own.
        turn: of a ball, its rotation (3, 3).
        to: the pose.
    """
    for r in range(3):
        for c in range(4):
            to[r, c] = 1.0 if r == c else 0.0
    if kind == BALL:
        for r in range(3):
            for c in range(3):
                to[r, c] = turn[r, c]
    elif kind == SWING:
        rotation_of(q[q0], q[q0 + 1], 0.0, to)
    elif kind == PRISMATIC:
        to[2, 3] = q[q0]
    elif kind == UNIVERSAL:
        cos, sin, other, own = np.cos(q[q0]), np.sin(q[q0]), np.cos(q[q0 + 1]), np.sin(q[q0 + 1])
        for r in range(3):
            x, y = numbers[1 + 3 * r], numbers[2 + 3 * r]
            to[r, 0], to[r, 1], to[r, 2] = x * other + y * own, y * other - x * own, numbers[3 + 3 * r]
        for c in range(3):
            x, y = to[0, c], to[1, c]
            to[0, c], to[1, c] = cos * x - sin * y, sin * x + cos * y
    else:
        cos, sin = np.cos(q[q0]), np.sin(q[q0])
        to[0, 0], to[0, 1], to[1, 0], to[1, 1] = cos, -sin, sin, cos
        if kind == CYLINDRICAL:
            to[2, 3] = q[q0 + 1]
        elif kind == SCREW:
            to[2, 3] = numbers[0] * q[q0]


@nested
def add_turn(twists: Any, column: int, axis: Any, point: Any) -> None:
    """Add to a body's twists (6, free) at a column a turn about an axis (3,) through a point (3,)."""
    if column >= 0:
        for r in range(3):
            twists[r, column] += axis[r]
        twists[3, column] += point[1] * axis[2] - point[2] * axis[1]
        twists[4, column] += point[2] * axis[0] - point[0] * axis[2]
        twists[5, column] += point[0] * axis[1] - point[1] * axis[0]


@nested
def add_slide(twists: Any, column: int, axis: Any, rate: float) -> None:
    """Add to a body's twists (6, free) at a column a slide along an axis (3,)."""
    if column >= 0:
        for r in range(3):
            twists[3 + r, column] += rate * axis[r]


@nested
def moving(kind: int, numbers: Any, q: Any, q0: int, at: Any, free: Any, twists: Any, room: Any) -> None:
    """Add to a body's twists (6, free) what the coordinates of the joint that carries it make of them.

    Args:
        kind, numbers, q, q0: of the joint, see `motion`.
        at: the joint's frame in the world (3, 4).
        free: column of each coordinate; -1 where that is given.
        twists: the body's.
        room: three vectors to work in.
    """
    axis, point, own = room
    for r in range(3):
        axis[r], point[r] = at[r, 2], at[r, 3]
    if kind in (REVOLUTE, CYLINDRICAL, SCREW, UNIVERSAL):
        add_turn(twists, free[q0], axis, point)
    if kind == PRISMATIC:
        add_slide(twists, free[q0], axis, 1.0)
    elif kind == CYLINDRICAL:
        add_slide(twists, free[q0 + 1], axis, 1.0)
    elif kind == SCREW:
        add_slide(twists, free[q0], axis, numbers[0])
    elif kind == UNIVERSAL:
        cos, sin, x, y = np.cos(q[q0]), np.sin(q[q0]), numbers[3], numbers[6]
        for r in range(3):
            axis[r] = at[r, 0] * (cos * x - sin * y) + at[r, 1] * (sin * x + cos * y) + at[r, 2] * numbers[9]
        add_turn(twists, free[q0 + 1], axis, point)
    elif kind == SWING:
        for k in range(2):
            rate_of(q[q0], q[q0 + 1], 1.0 - k, float(k), own)
            for r in range(3):
                axis[r] = at[r, 0] * own[0] + at[r, 1] * own[1] + at[r, 2] * own[2]
            add_turn(twists, free[q0 + k], axis, point)
    elif kind == BALL:
        for k in range(3):
            for r in range(3):
                axis[r] = at[r, k]
            add_turn(twists, free[q0 + k], axis, point)


@nested
def rolled(ratio: float, at: Any, carried: Any, to: Any, tilt: Any) -> None:
    """A gear that rolls on another one: its frame (3, 4), and its carrier's tilt (2,) as a rotation vector.

    Args:
        ratio: its tilt by that of the carrier.
        at: frame of the fixed gear (3, 4).
        carried: frame of the carrier: its origin is the gear's centre, its z lies along that of the fixed gear at rest.
        to, tilt: what is found.
    """
    n, turned = np.empty(3), np.empty((3, 3))
    for c in range(3):
        n[c] = at[0, c] * carried[0, 2] + at[1, c] * carried[1, 2] + at[2, c] * carried[2, 2]
    sine = np.sqrt(n[0] * n[0] + n[1] * n[1])
    share = np.arctan2(sine, n[2]) / sine if sine > STRAIGHT else 1.0 + sine * sine / 6.0
    tilt[0], tilt[1] = -share * n[1], share * n[0]
    rotation_of(ratio * tilt[0], ratio * tilt[1], 0.0, turned)
    for r in range(3):
        for c in range(3):
            to[r, c] = at[r, 0] * turned[0, c] + at[r, 1] * turned[1, c] + at[r, 2] * turned[2, c]
        to[r, 3] = carried[r, 3]


@nested
def rolling(ratio: float, at: Any, tilt: Any, centre: Any, fixed: Any, carrier: Any, twists: Any) -> None:
    """The twists (6, free) of a gear that rolls on another one.

    Args:
        ratio, at: see `rolled`.
        tilt: of the carrier (2,).
        centre: of the gear's frame (3, 4).
        fixed, carrier: twists of the other gear and of the carrier (6, free).
        twists: what is found.
    """
    swung, own, rate, turned = np.empty((3, 3)), np.empty(3), np.empty((2, 3)), np.empty(3)
    rotation_of(tilt[0], tilt[1], 0.0, swung)
    for k in range(2):
        rate_of(tilt[0], tilt[1], 1.0 - k, float(k), own)
        copy(rate[k], own)
    # the carrier's axis moves as the two columns of its tilt say: seen along two directions across it
    a, b, c, d = 0.0, 0.0, 0.0, 0.0
    for r in range(3):
        a += swung[r, 0] * rate[0, r]
        b += swung[r, 0] * rate[1, r]
        c += swung[r, 1] * rate[0, r]
        d += swung[r, 1] * rate[1, r]
    det = a * d - b * c
    for column in range(twists.shape[1]):
        x, y = 0.0, 0.0
        for r in range(3):
            seen = 0.0
            for s in range(3):
                seen += at[s, r] * (carrier[s, column] - fixed[s, column])
            x += swung[r, 0] * seen
            y += swung[r, 1] * seen
        u, v = (d * x - b * y) / det, (a * y - c * x) / det
        rate_of(ratio * tilt[0], ratio * tilt[1], ratio * u, ratio * v, own)
        for r in range(3):
            turned[r] = fixed[r, column] + at[r, 0] * own[0] + at[r, 1] * own[1] + at[r, 2] * own[2]
        for r in range(3):
            s, t = (r + 1) % 3, (r + 2) % 3
            # the centre goes with the carrier, whatever turns about it
            shift = carrier[3 + r, column] + carrier[s, column] * centre[t, 3] - carrier[t, column] * centre[s, 3]
            twists[3 + r, column] = shift - (turned[s] * centre[t, 3] - turned[t] * centre[s, 3])
            twists[r, column] = turned[r]


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
    """How an entry of a rotation (3, 4) changes with an angular velocity (3,)."""
    s, t = (r + 1) % 3, (r + 2) % 3
    return twist[s] * seen[t, c] - twist[t] * seen[s, c]


@nested
def keeps(kind: int, k: int, numbers: Any, angle: float, seen: Any, twist: Any, length: float) -> Any:
    """An equation of a joint that shuts a loop: what it lacks, and how that changes with a twist (6,).

    Args:
        kind: of the joint.
        k: which of its equations.
        numbers: see `motion`.
        angle: of a screw, about where it is [rad].
        seen: the one frame in the other (3, 4).
        twist: of it, in the other's frame, at its own origin.
        length: by which angles are lengths.
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
    """How many equations a joint asks for."""
    if kind == BALL:
        return 3
    if kind in (REVOLUTE, PRISMATIC, SCREW):
        return 5
    if kind == FIXED:
        return 6
    return 2 if kind == ALONG else 4


@nested
def equations(model: Any, state: Any, room: Any, length: float, matrix: Any, right: Any) -> None:
    """What the joints that shut loops lack (rows,) and its Jacobian (rows, free), then what is held."""
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


@nested
def eliminated(matrix: Any, right: Any) -> Any:
    """Solve equations in place by elimination with pivots: their determinant's sign, 0 of none, and the least pivot."""
    count, sign, least = right.shape[0], 1.0, np.inf
    for k in range(count):
        best = k
        for i in range(k + 1, count):
            if abs(matrix[i, k]) > abs(matrix[best, k]):
                best = i
        if best != k:
            sign = -sign
            for j in range(count):
                matrix[k, j], matrix[best, j] = matrix[best, j], matrix[k, j]
            right[k], right[best] = right[best], right[k]
        pivot = matrix[k, k]
        least = min(least, abs(pivot))
        if not abs(pivot) > 1e-14:
            return 0.0, 0.0
        sign = -sign if pivot < 0.0 else sign
        for i in range(k + 1, count):
            factor = matrix[i, k] / pivot
            if factor != 0.0:
                for j in range(k + 1, count):
                    matrix[i, j] -= factor * matrix[k, j]
                right[i] -= factor * right[k]
    for k in range(count - 1, -1, -1):
        total = right[k]
        for j in range(k + 1, count):
            total -= matrix[k, j] * right[j]
        right[k] = total / matrix[k, k]
    return sign, least


@nested
def least_singular(matrix: Any, square: Any, vector: Any) -> Any:
    """The least singular value of a matrix, by inverse iteration on its square."""
    count, size = matrix.shape[0], 0.0
    fill(vector, 1.0)
    for k in range(count):
        vector[k] += 0.1 * (k % 3)
    for _ in range(4):
        for i in range(count):
            for j in range(count):
                square[i, j] = 0.0
                for k in range(count):
                    square[i, j] += matrix[k, i] * matrix[k, j]
        before = 0.0
        for k in range(count):
            before += vector[k] * vector[k]
        before = np.sqrt(before)
        for k in range(count):
            vector[k] /= before
        sign, _ = eliminated(square, vector)
        if sign == 0.0:
            return 0.0
        size = 0.0
        for k in range(count):
            size += vector[k] * vector[k]
    return 1.0 / np.sqrt(np.sqrt(size))


@nested
def stepped(model: Any, state: Any, scale: Any, step: Any, moved: Any, room: Any) -> float:
    """Change the free coordinates by a step (free,); its largest part [rad, or of the loop's length]."""
    tree, _, _, free, _ = model
    q, turns = state[0], state[1]
    turned, made = room[0], room[1]
    largest = 0.0
    for column in range(step.shape[0]):
        largest = max(largest, abs(step[column]))
    share = min(1.0, LONGEST / largest) if largest > 0.0 else 1.0
    for t in range(tree.shape[0]):
        kind, q0, f = tree[t, 0], tree[t, 3], tree[t, 4]
        count = 3 if kind == BALL else (2 if kind in (CYLINDRICAL, UNIVERSAL, SWING) else 1)
        if kind == ROLLING:
            continue
        for k in range(count):
            if free[q0 + k] >= 0:
                q[q0 + k] += share * step[free[q0 + k]] * scale[free[q0 + k]]
        if kind == BALL:
            a, b, c = 0.0, 0.0, 0.0
            if free[q0] >= 0:
                a, b, c = share * step[free[q0]], share * step[free[q0 + 1]], share * step[free[q0 + 2]]
            rotation_of(a, b, c, turned)
            for r in range(3):
                for s in range(3):
                    made[r, s] = (
                        turned[r, 0] * turns[f, 0, s] + turned[r, 1] * turns[f, 1, s] + turned[r, 2] * turns[f, 2, s]
                    )
            for r in range(3):
                for s in range(3):
                    turns[f, r, s] = made[r, s]
    for column in range(step.shape[0]):
        moved[column] += share * step[column]
    return largest


@nested
def newton(model: Any, state: Any, scale: Any, length: float, work: Any, room: Any) -> Any:
    """Close the loops from the coordinates: steps taken (-1: none found), the determinant's sign, its least pivot.

    In the end all poses are those of the coordinates, and `work` holds the Jacobian there.
    """
    matrix, right, square, moved, vector = work
    held, sign, least = model[4], 0.0, 0.0
    count = right.shape[0]
    for n in range(STEPS):
        forward(model, state, room)
        equations(model, state, room, length, matrix, right)
        for i in range(count - held.shape[0]):
            right[i] = -right[i] / length
            for j in range(count):
                matrix[i, j] *= scale[j] / length
        for h in range(held.shape[0]):  # they stay where they began
            i = count - held.shape[0] + h
            for j in range(count):
                right[i] -= matrix[i, j] * moved[j]
        copy_matrix(square, matrix)
        copy(vector, right)
        sign, least = eliminated(square, vector)
        if sign == 0.0 or not np.isfinite(vector[0]):
            return -1, sign, least
        taken = stepped(model, state, scale, vector, moved, room)
        if not taken < np.inf:
            return -1, sign, least
        if taken <= MET:
            forward(model, state, room)
            return n + 1, sign, least
    return -1, sign, least


@nested
def begin(start: Any, frames: Any, given: Any, free: Any, i: int, share: float, state: Any) -> None:
    """The coordinates and frames of a trial whose deviations are a share of what they are."""
    base, child, nominal_base, nominal_child = frames
    b, c = min(i, base.shape[0] - 1), min(i, child.shape[0] - 1)
    for k in range(start.shape[0]):
        if free[k] < 0:
            state[0][k] = start[k] + share * (given[min(i, given.shape[0] - 1), k] - start[k])
    for f in range(nominal_base.shape[0]):
        for r in range(3):
            for s in range(4):
                if share == 1.0:
                    state[2][f, r, s] = base[b, f, r, s]
                    state[3][f, r, s] = child[c, f, r, s]
                else:
                    own, other = nominal_base[f, r, s], nominal_child[f, r, s]
                    state[2][f, r, s] = own + share * (base[b, f, r, s] - own)
                    state[3][f, r, s] = other + share * (child[c, f, r, s] - other)


@nested
def at_start(start: Any, turns: Any, state: Any, moved: Any) -> None:
    """The nominal coordinates."""
    for k in range(start.shape[0]):
        state[0][k] = start[k]
    for f in range(turns.shape[0]):
        for r in range(3):
            for c in range(3):
                state[1][f, r, c] = turns[f, r, c]
    fill(moved, 0.0)


@nested
def far_off(moved: Any, most: float) -> bool:
    """Whether coordinates have moved by more than that."""
    largest = 0.0
    for k in range(moved.shape[0]):
        largest = max(largest, abs(moved[k]))
    return largest > most


@kernel(
    arrays="int64[:,::1], int64[:,::1], float64[:,::1], int64[::1], float64[:,::1], float64[::1], float64[:,:,::1], "
    "float64[:,:,:,::1], float64[:,:,:,::1], float64[:,:,::1], float64[:,:,::1], float64[:,::1], float64[::1], "
    "float64[::1], float64[:,:,:,::1], float64[:,::1], float64[:,:,:,::1], int8[::1], float64[:,::1], float64[:,::1]"
)
def loops_closed(
    tree: Any,
    shut: Any,
    numbers: Any,
    free: Any,
    held: Any,
    start: Any,
    turns: Any,
    base: Any,
    child: Any,
    nominal_base: Any,
    nominal_child: Any,
    given: Any,
    scale: Any,
    lengths: Any,
    poses: Any,
    coordinates: Any,
    turned: Any,
    codes: Any,
    found: Any,
    jacobian: Any,
) -> None:
    """Close loops in many trials.

    Args:
        tree: joints that place bodies (joints, 6): kind, body before, body after, first coordinate, frame, carrier;
            -1 for a placed body.
        shut: joints that shut loops (joints, 5): kind, body before, body after, first coordinate, frame.
        numbers: of each frame (frames, 10), see `motion`.
        free: of each coordinate its column, -1 where it is given.
        held: motions that stay as they are (motions, free).
        start: nominal coordinates.
        turns: nominal rotations of balls (frames, 3, 3).
        base, child: frames of joints, on the body before, and of the body after seen from its frame in a tree, else on
            that body (n or 1, frames, 3, 4).
        nominal_base, nominal_child: the same nominally (frames, 3, 4).
        given: coordinates (n or 1, coordinates) of which those count that are not free.
        scale: of each free coordinate what makes a length of it a share of the loop's (free,).
        lengths: the loop's; then the sign of the determinant at the nominal pose, 0 where any will do.
        poses: of the bodies (n, bodies, 3, 4), found.
        coordinates: (n, coordinates), found.
        turned: of balls (n, frames, 3, 3), found.
        codes: (n,), found.
        found: steps of Newton, sign of the determinant, least singular value or more (n, 3), found.
        jacobian: of the last trial (free, free), found.
    """
    frames, count = nominal_base.shape[0], scale.shape[0]
    q, own_turns = np.empty(start.shape[0]), np.empty((frames, 3, 3))
    own_base, own_child = np.empty((frames, 3, 4)), np.empty((frames, 3, 4))
    twists, none = np.zeros((poses.shape[1], 6, count)), np.zeros((6, count))
    places = np.empty((poses.shape[1], 3, 4))
    matrix, square = np.zeros((count, count)), np.zeros((count, count))
    right, moved, vector = np.zeros(count), np.zeros(count), np.zeros(count)
    room = (
        np.empty((3, 4)),
        np.empty((3, 4)),
        np.empty((3, 4)),
        (np.empty(3), np.empty(3), np.empty(3)),
        none,
        np.empty(6),
        np.empty(6),
    )
    model = (tree, shut, numbers, free, held)
    state = (q, own_turns, own_base, own_child, places, twists)
    work = (matrix, right, square, moved, vector)
    given_frames = (base, child, nominal_base, nominal_child)
    length, nominal = lengths[0], lengths[1]
    for i in range(poses.shape[0]):
        code, part, steps, sign, least = OK, 0, 0, 0.0, 0.0
        at_start(start, turns, state, moved)
        while part <= PARTS:  # first at once, then, where that leads astray, part by part
            begin(start, given_frames, given, free, i, 1.0 if part == 0 else part / PARTS, state)
            steps, sign, least = newton(model, state, scale, length, work, room)
            reached = steps >= 0 and (nominal == 0.0 or sign * nominal > 0.0)
            if part > 0 and not reached:
                break
            if part == 0:
                code = DOES_NOT_CLOSE if steps < 0 else OTHER_BRANCH
                if nominal == 0.0 or (reached and steps <= QUICK and not far_off(moved, SMALL)):
                    code = OK if steps >= 0 else DOES_NOT_CLOSE
                    break
                at_start(start, turns, state, moved)
            part += 1
        if part > PARTS:
            code = OK
        if code == OK and least < SUSPECT:
            least = least_singular(matrix, square, vector)
            if least < FLAT:
                code = SINGULAR
        if code != OK:
            at_start(start, turns, state, moved)
            for f in range(frames):
                copy_matrix(own_base[f], nominal_base[f])
                copy_matrix(own_child[f], nominal_child[f])
            forward(model, state, room)
        codes[i] = code
        found[i, 0], found[i, 1], found[i, 2] = steps, sign, least
        for k in range(start.shape[0]):
            coordinates[i, k] = q[k]
        for b in range(poses.shape[1]):
            copy_matrix(poses[i, b], places[b])
        for f in range(frames):
            copy_matrix(turned[i, f], own_turns[f])
    copy_matrix(jacobian, matrix)
