"""Loops closed trial by trial, in a kernel: Newton on the equations of the joints, with exact Jacobians.

Joints that span a tree from the placed bodies place all others by their coordinates: turns, slides, tilts. Each joint
beside the tree shuts a loop, and asks for what its kind keeps: equations of its two frames. The Jacobian follows from
the twists of the bodies, a column for each coordinate that is free.

A trial begins at the nominal pose. Where the root that Newton finds from there is far, on the other side of a singular
pose, or none, the deviations are brought in step by step, so that the branch of the nominal pose is followed.
"""

from typing import Any, Final

import numpy as np

from tol3d.assembly.linkage.joint_equations import equations, forward
from tol3d.assembly.linkage.joint_motions import BALL, CYLINDRICAL, ROLLING, SWING, UNIVERSAL, rotation_of
from tol3d.assembly.model.statuses import DOES_NOT_CLOSE, OK, OTHER_BRANCH, SINGULAR
from tol3d.numerics.compiled import kernel, nested
from tol3d.numerics.loops import copy, copy_matrix, eliminated, fill

STEPS: Final = 24
"""Largest number of Newton steps; most trials take 2."""
MET: Final = 1e-11
"""Last step, as a share of the loop's length, or rad: the remaining error is its square."""
LEFT: Final = 1e-15
"""Size of the next step, estimated from the last two, below which it is not taken."""
NEARLY: Final = 1e-8
"""Last step where rounding lets none be shorter, near a singular pose."""
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
        sign, _ = eliminated(square, vector, count)
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
    held, sign, least, before = model[4], 0.0, 0.0, np.inf
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
        sign, least = eliminated(square, vector, count)
        if sign == 0.0:
            return -1, sign, least
        taken = stepped(model, state, scale, vector, moved, room)
        if not taken < np.inf:
            return -1, sign, least
        next_step = taken * (taken / before) ** 2 if n > 0 else np.inf
        if taken <= MET or next_step <= LEFT or NEARLY >= taken >= before / 2:
            forward(model, state, room)
            return n + 1, sign, least
        before = taken
    return -1, sign, least


@nested
def begin(start: Any, frames: Any, given: Any, free: Any, i: int, share: float, state: Any) -> None:
    """The coordinates and frames of a trial whose deviations are scaled by a fraction."""
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
    """True if coordinates have moved by more than `most`."""
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
        free: column of each coordinate, -1 if it is given.
        held: motions that stay as they are (motions, free).
        start: nominal coordinates.
        turns: nominal rotations of balls (frames, 3, 3).
        base, child: frames of joints, on the body before, and of the body after seen from its frame in a tree, else on
            that body (n or 1, frames, 3, 4).
        nominal_base, nominal_child: the same nominally (frames, 3, 4).
        given: coordinates (n or 1, coordinates); only those that are not free count.
        scale: factor that makes each free coordinate a fraction of the loop's length (free,).
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
