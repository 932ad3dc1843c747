"""Round features in contact: the finite pose, trial by trial.

Unknowns are amounts of nominal steps, of which the pose is made by one turn (Cayley's formula) and one shift. Newton's
method from the nominal pose; if its steps do not fall, or it ends on the other side of a fold, contacts are followed
from nominal to the trial instead, by fractions of the nominal residuals and deviations small enough for Newton's method
(Newton's homotopy). A path that ends before has come to a fold: no contact beyond.
"""

from typing import Any, Final

import numpy as np

from tol3d.assembly.model.statuses import NO_CONTACT, OK, SINGULAR
from tol3d.assembly.placing.contact_equations import asked_of, count_of, equations, new_sides
from tol3d.assembly.placing.one_sided_gaps import turned_by
from tol3d.numerics.compiled import kernel, nested
from tol3d.numerics.loops import copy, copy_matrix, eliminated, fill

STEPS: Final = 60
MET: Final = 1e-13
"""Step [rad, and mm per mm of reach] at which a trial is done."""
LAST: Final = 1e-15
"""The same for the predicted next step: a hundredth, for the prediction is rough."""
ROUNDING: Final = 1e-13
"""Error [mm per mm of reach] that is rounding if steps do not get shorter, near a fold."""
FALLING: Final = 0.75
"""Largest ratio of a step to the one before; towards a double root it is 0.5."""
FOLLOWING: Final = 0.25
"""The same for steps from nominal, which are to stay near the path."""
FIRST_SHARE: Final = 0.25
LEAST_SHARE: Final = 1e-6
"""Fraction of the path from nominal; shorter steps are not tried."""
NOWHERE: Final = 2.0
"""Side of the folds for a pose that is not found; else 1, -1, or 0 on a fold."""


@nested
def posed(start: Any, basis: Any, reach: float, amounts: Any, pose: Any, moves: Any) -> None:
    """The pose (3, 4) by amounts (k,) of steps (6, k), shift and turn times reach; `moves`: its changes with them."""
    for r in range(6):
        moves[r, 0] = 0.0
        for s in range(basis.shape[1]):
            moves[r, 0] += basis[r, s] * amounts[s]
    a, b, c = moves[3, 0] / reach, moves[4, 0] / reach, moves[5, 0] / reach
    x, y, z = moves[0, 0], moves[1, 0], moves[2, 0]
    copy_matrix(pose, start)
    turned_by(pose, a, b, c)
    pose[0, 3] += x
    pose[1, 3] += y
    pose[2, 3] += z
    share = 1.0 / (reach * (1.0 + (a * a + b * b + c * c) / 4))
    for s in range(basis.shape[1]):
        u, v, w = basis[3, s], basis[4, s], basis[5, s]
        moves[0, s], moves[1, s], moves[2, s] = basis[0, s], basis[1, s], basis[2, s]
        moves[3, s] = share * (u + (b * w - c * v) / 2)
        moves[4, s] = share * (v + (c * u - a * w) / 2)
        moves[5, s] = share * (w + (a * v - b * u) / 2)


@nested
def systems(rows: Any, moves: Any, count: int, matrix: Any) -> None:
    """Change of errors per amount (count, count)."""
    for e in range(count):
        for s in range(count):
            total = 0.0
            for k in range(6):
                total += rows[e, k] * moves[k, s]
            matrix[e, s] = total


@nested
def by_steps(amounts: Any, asked: Any, i: int, share: float, falling: float, about: Any, rooms: Any) -> Any:
    """Find the amounts by Newton's method, with steps each at most `falling` of the one before; True if found."""
    start, basis, reach, lacking = about
    pose, moves, errors, rows, matrix, right, sides = rooms
    count, before = basis.shape[1], np.inf
    if not asked_of(asked, i, share, sides):
        return False
    for _ in range(STEPS):
        posed(start, basis, reach, amounts, pose, moves)
        equations(pose, asked, errors, rows, sides)
        worst = 0.0
        for e in range(count):
            right[e] = (1.0 - share) * lacking[e] - errors[e] if share != 1.0 else -errors[e]
            worst = max(worst, abs(right[e]))
        systems(rows, moves, count, matrix)
        if eliminated(matrix, right, count)[0] == 0.0:
            return False
        length = 0.0
        for s in range(count):
            amounts[s] += right[s]
            length = max(length, abs(right[s]))
        # quadratic convergence: the next step is shorter by about the square of the ratio
        if length <= MET * reach or (before < np.inf and length * (length / before) ** 2 <= LAST * reach):
            return True
        if not length <= falling * before:
            return worst <= ROUNDING * reach
        before = length
    return False


@nested
def end_of(amounts: Any, kept: Any, asked: Any, i: int, side: float, about: Any, rooms: Any) -> Any:
    """The side of the folds on which the pose of a trial is found, with its rows and moves left in the rooms.

    In one step, else by fractions from nominal, each from the pose before.
    """
    start, basis, reach, _ = about
    pose, moves, _, rows, matrix, right, _ = rooms
    done, share, falling = 0.0, 1.0, FALLING
    fill(amounts, 0.0)
    fill(kept, 0.0)
    while share >= LEAST_SHARE:
        following = min(1.0, done + share)
        met = by_steps(amounts, asked, i, following, falling, about, rooms)
        if met and following == 1.0:
            posed(start, basis, reach, amounts, pose, moves)
            systems(rows, moves, basis.shape[1], matrix)
            found, _ = eliminated(matrix, right, basis.shape[1])
            if found == side or falling == FOLLOWING:
                return found
            met = False
        if met:
            done, share = following, 2 * share
            copy(kept, amounts)
        else:
            share = FIRST_SHARE if falling == FALLING else share / 2
            falling = FOLLOWING
            copy(amounts, kept)
    return NOWHERE


@nested
def held(asked: Any, i: int, about: Any, rooms: Any, force: Any, inner: Any) -> Any:
    """True if no contact has to pull, under a force through the mean of the moving origins; SINGULAR in doubt."""
    kinds, _, _, moving, _, _, _ = asked
    pose, moves, _, rows, matrix, right, _ = rooms
    count, at = about[1].shape[1], min(i, moving.shape[2] - 1)
    f = min(i, force.shape[1] - 1)
    x, y, z = force[0, f], force[1, f], force[2, f]
    a, b, c = 0.0, 0.0, 0.0
    for k in range(kinds.shape[0]):
        u, v, w = moving[k, 0, at], moving[k, 1, at], moving[k, 2, at]
        a += (pose[0, 0] * u + pose[0, 1] * v + pose[0, 2] * w) / kinds.shape[0]
        b += (pose[1, 0] * u + pose[1, 1] * v + pose[1, 2] * w) / kinds.shape[0]
        c += (pose[2, 0] * u + pose[2, 1] * v + pose[2, 2] * w) / kinds.shape[0]
    for s in range(count):
        work = x * moves[0, s] + y * moves[1, s] + z * moves[2, s]
        work += (b * z - c * y) * moves[3, s] + (c * x - a * z) * moves[4, s] + (a * y - b * x) * moves[5, s]
        right[s] = -work
        for e in range(count):
            total = 0.0
            for k in range(6):
                total += rows[e, k] * moves[k, s]
            matrix[s, e] = total
    if eliminated(matrix, right, count)[0] == 0.0:
        return False
    e = 0
    for k in range(kinds.shape[0]):
        push = -right[e] if inner[k] else right[e]
        if not push > 0.0:
            return False
        e += count_of(kinds[k])
    return True


@nested
def new_rooms(count: int, contacts: int) -> Any:
    """Work arrays for the steps."""
    return (
        np.empty((3, 4)),
        np.empty((6, count)),
        np.empty(count),
        np.empty((count, 6)),
        np.empty((count, count)),
        np.empty(count),
        new_sides(contacts),
    )


SIDES: Final = (
    "int64[::1], float64[::1], float64, float64[:,:,::1], float64[:,:,::1], float64[:,::1], float64[:,::1], "
    "float64[:,::1], float64[::1], "
)


@kernel(arrays=f"{SIDES}float64[:,::1], float64[::1], float64[:,::1]")
def lacking_at(
    kinds: Any,
    signs: Any,
    length: float,
    moving: Any,
    targets: Any,
    sums: Any,
    nominal_moving: Any,
    nominal_targets: Any,
    nominal_sums: Any,
    start: Any,
    errors: Any,
    rows: Any,
) -> None:
    """Errors (equations,) and rows (equations, 6) of the first trial at a pose (3, 4); see `touching_poses`."""
    asked = (kinds, signs, length, moving, targets, sums, (nominal_moving, nominal_targets, nominal_sums))
    sides = new_sides(kinds.shape[0])
    asked_of(asked, 0, 1.0, sides)
    equations(start, asked, errors, rows, sides)


@kernel(
    arrays=f"{SIDES}float64[:,::1], float64[:,::1], float64, float64[::1], float64, float64[:,::1], boolean[::1], "
    "float64[:,:,::1], float64[:,::1], int8[::1]"
)
def touching_poses(
    kinds: Any,
    signs: Any,
    length: float,
    moving: Any,
    targets: Any,
    sums: Any,
    nominal_moving: Any,
    nominal_targets: Any,
    nominal_sums: Any,
    start: Any,
    basis: Any,
    reach: float,
    lacking: Any,
    side: float,
    force: Any,
    inner: Any,
    turns: Any,
    shifts: Any,
    codes: Any,
) -> None:
    """Poses of contacts: of the middle of the part's features that touch, from where it lies nominally.

    Args:
        kinds: of the contacts (contacts,), see contact_equations.
        signs: of the distances of lines that cross (contacts,).
        length: by which the slope of a line counts [mm].
        moving: origin and direction of the part's sides (contacts, 6, n), [mm] and 1: from the middle, along the
            axes of the part.
        targets: the same of the others: from the nominal place of the middle, along the axes of the world.
        sums: distances at which they touch (contacts, n) [mm]; (..., 1) of what does not vary.
        nominal_moving, nominal_targets, nominal_sums: the same, nominally (contacts, 6), (contacts,).
        start: the nominal pose (3, 4): the part's turn, no shift.
        basis: steps, shift and turn about the middle times reach (6, k).
        reach: of the contacts about the middle [mm].
        lacking: errors at the nominal pose (k,) [mm].
        side: of the folds, on which the nominal pose lies: 1 or -1.
        force: direction in which the part is pressed (3, n) in the world; (3, 0) where that is not asked.
        inner: which contacts have one inside the other (contacts,).
        turns, shifts: found (3, 3, n), (3, n) [mm], the middle's shift; NaN where they are not.
        codes: status codes (n,).
    """
    asked = (kinds, signs, length, moving, targets, sums, (nominal_moving, nominal_targets, nominal_sums))
    about, rooms = (start, basis, reach, lacking), new_rooms(basis.shape[1], kinds.shape[0])
    amounts, kept, pose = np.empty(basis.shape[1]), np.empty(basis.shape[1]), rooms[0]
    for i in range(codes.shape[0]):
        found = end_of(amounts, kept, asked, i, side, about, rooms)
        code = OK if found == side else SINGULAR if found == 0.0 else NO_CONTACT
        if code == OK and force.shape[1] > 0 and not held(asked, i, about, rooms, force, inner):
            code = NO_CONTACT
        codes[i] = code
        for r in range(3):
            for c in range(3):
                turns[r, c, i] = pose[r, c] if code == OK else np.nan
            shifts[r, i] = pose[r, 3] if code == OK else np.nan
