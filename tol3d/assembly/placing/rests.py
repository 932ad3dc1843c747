"""Parts on one-sided contacts under a force: the finite pose, trial by trial.

Each step solves a linear programme about the pose reached: the farthest motion along the force with no gap below 0, by
the dual simplex method with the nominal lever arms; then gaps are found again. Where that does not end, for turns are
large or contacts hold the part barely, gaps are linearised anew at each pose; what carries is judged by the nominal
loads all the same. Several motions may go as far: a second
direction, which counts where the first one is met alike, chooses among them (a lexicographic programme). Each trial
begins with the same contacts, so that it has the same bits alone and among thousands.
"""

from typing import Any, Final

import numpy as np

from tol3d.assembly.placing.pose_steps import solved, stepped
from tol3d.numerics.compiled import kernel, part

STEPS: Final = 60
MET: Final = 1e-13
"""Step [rad, and mm a mm of reach] after which a trial is done."""
OPEN: Final = -1e-11
"""Gap [mm] under which a contact is pierced."""
PIVOTS: Final = 400
"""Exchanges of contacts in one trial; in practice as many as contacts."""
ACTS: Final = 1e-9
"""How far a gap closes as another one opens, under which it does not."""
TIED: Final = 1e-9
"""Part of the force under which a contact carries nothing."""
RESTS: Final = 0
CLASHES: Final = 1
"""No motion opens all gaps: the part finds no room."""
LOST: Final = 2


@part
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


@part
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


@part
def leaving(inverse: Any, loads: Any, row: Any, closes: Any) -> int:
    """Which contact of the basis a new one relieves first; -1 if none. `closes` becomes row . inverse."""
    count = loads.shape[1]
    best = -1
    least, second = np.inf, np.inf
    for b in range(count):
        total = 0.0
        for j in range(count):
            total += row[j] * inverse[j, b]
        closes[b] = total
        if total > ACTS:
            first, other = max(loads[0, b], 0.0) / total, loads[1, b] / total
            if first < least - 1e-12 or (first < least + 1e-12 and other < second):
                best, least, second = b, min(first, least), other
    return best


@part
def exchange(inverse: Any, loads: Any, closes: Any, out: int) -> None:
    """Let a new contact take the place of one: the inverse of the basis, and the loads on it."""
    count = loads.shape[1]
    pivot = closes[out]
    for j in range(count):
        inverse[j, out] /= pivot
    for b in range(count):
        if b != out:
            for j in range(count):
                inverse[j, b] -= inverse[j, out] * closes[b]
    for level in range(2):
        share = loads[level, out] / pivot
        for b in range(count):
            loads[level, b] -= share * closes[b]
        loads[level, out] = share


@part
def farthest(rows: Any, gaps: Any, basis: Any, inverse: Any, loads: Any, rooms: Any, pivots: int) -> int:
    """Motion z, into the first room, that goes farthest with rows z + gaps >= 0; the exchanges made, or below 0.

    Returns:
        -1: gaps contradict each other. -2: too many exchanges.
    """
    z, closes = rooms
    count = loads.shape[1]
    while True:
        for j in range(count):
            total = 0.0
            for b in range(count):
                total -= inverse[j, b] * gaps[basis[b]]
            z[j] = total
        entering, deepest = -1, OPEN
        for k in range(rows.shape[0]):
            total = gaps[k]
            for j in range(count):
                total += rows[k, j] * z[j]
            if total < deepest:
                among = False
                for b in range(count):
                    among = among or basis[b] == k
                if not among:
                    entering, deepest = k, total
        if entering < 0:
            return pivots
        if pivots == PIVOTS:
            return -2
        out = leaving(inverse, loads, rows[entering], closes)
        if out < 0:
            return -1
        exchange(inverse, loads, closes, out)
        basis[out] = entering
        pivots += 1


@part
def rows_now(pose: Any, contacts: Any, i: int, on_part: bool, steps: Any, reach: float, now: Any) -> None:
    """How gaps change at a pose, into the first room by turn by reach and shift, into the second by the motions."""
    points, normals, _ = contacts
    all_rows, rows = now
    arm, normal = np.empty(3), np.empty(3)
    for k in range(all_rows.shape[0]):
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
        all_rows[k, 0] = (arm[1] * normal[2] - arm[2] * normal[1]) / reach
        all_rows[k, 1] = (arm[2] * normal[0] - arm[0] * normal[2]) / reach
        all_rows[k, 2] = (arm[0] * normal[1] - arm[1] * normal[0]) / reach
        for r in range(3):
            all_rows[k, 3 + r] = normal[r]
        for j in range(rows.shape[1]):
            total = 0.0
            for r in range(6):
                total += all_rows[k, r] * steps[r, j]
            rows[k, j] = total


@part
def inverted(rows: Any, basis: Any, inverse: Any, matrix: Any, right: Any) -> bool:
    """Whether the rows of a basis have an inverse, and that."""
    count = basis.shape[0]
    for b in range(count):
        for j in range(count):
            right[j] = 1.0 if j == b else 0.0
            for c in range(count):
                matrix[j, c] = rows[basis[j], c]
        if not solved(matrix, right, count):
            return False
        for j in range(count):
            inverse[j, b] = right[j]
    return True


@part
def settled(
    pose: Any, contacts: Any, i: int, on_part: bool, kept: Any, programme: Any, begun: Any, rooms: Any, reach: float,
    anew: bool,
) -> int:  # fmt: skip
    """What becomes of a part that goes along the force from a pose; by nominal rows, or by those of each pose."""
    vectors, normals, shifts, kept_steps, first = kept
    all_rows, rows, steps = programme
    basis, inverse, loads = begun
    gaps, step, moves, matrix, right = rooms
    pivots = 0
    for _ in range(STEPS):
        if anew:
            rows_now(pose, contacts, i, on_part, steps, reach, (all_rows, rows))
            if not inverted(rows, basis, inverse, matrix, right):
                return LOST
        step[:] = 0.0
        for e in range(first.shape[0]):
            change = kept_at(pose, (vectors, normals, shifts), e, i) - first[e]
            for r in range(6):
                step[r] -= kept_steps[r, e] * change
        for k in range(gaps.shape[0]):
            gaps[k] = gap_of(pose, contacts, k, i, on_part)
            for r in range(6):
                gaps[k] += all_rows[k, r] * step[r]
        pivots = farthest(rows, gaps, basis, inverse, loads, moves, pivots)
        if pivots < 0:
            return CLASHES if pivots == -1 else LOST
        for r in range(6):
            for j in range(rows.shape[1]):
                step[r] += steps[r, j] * moves[0][j]
        length = stepped(pose, step, reach)
        if length <= MET:
            return RESTS
        if not length < np.inf:
            return LOST
    return LOST


@part
def pressed(rows: Any, basis: Any, inverse: Any, loads: Any, firsts: Any, rooms: Any) -> bool:
    """Whether the force presses all contacts of a basis by the nominal rows; and the loads on them."""
    first_basis, first_loads = firsts
    _, _, (pull, _), matrix, right = rooms
    if not inverted(rows, basis, inverse, matrix, right):
        return False
    for j in range(pull.shape[0]):
        pull[j] = 0.0
        for b in range(pull.shape[0]):
            pull[j] -= first_loads[0, b] * rows[first_basis[b], j]
    for b in range(pull.shape[0]):
        loads[0, b] = 0.0
        for j in range(pull.shape[0]):
            loads[0, b] -= pull[j] * inverse[j, b]
        if loads[0, b] < -TIED:
            return False
    return True


@part
def begin(pose: Any, first: Any, start: Any, i: int, kept: Any, begun: Any, firsts: Any) -> None:
    """Put the pose and the basis as they begin, and note what is kept there."""
    begun[0][:], begun[1][:], begun[2][:] = firsts
    vectors, normals, shifts, _, _ = kept
    pose[:] = start[:, :, min(i, start.shape[2] - 1)]
    for e in range(first.shape[0]):
        first[e] = kept_at(pose, (vectors, normals, shifts), e, i)


@part
def note(outcome: int, pose: Any, basis: Any, loads: Any, i: int, found: Any) -> None:
    """Write down where a part rests and what its contacts carry; nothing of one that does not."""
    turns, shifts, carried = found
    for k in range(carried.shape[0]):
        carried[k, i] = 0.0
    for b in range(basis.shape[0]):
        if loads[0, b] > TIED and outcome == RESTS:
            carried[basis[b], i] = loads[0, b]
    for r in range(3):
        for c in range(3):
            turns[r, c, i] = pose[r, c] if outcome == RESTS else np.nan
        shifts[r, i] = pose[r, 3] if outcome == RESTS else np.nan


@kernel(
    arrays="float64[:,:,::1], float64[:,:,::1], float64[:,::1], boolean, float64[:,:,::1], float64[:,:,::1], "
    "float64[::1], float64[:,::1], float64[:,::1], float64[:,::1], float64[:,::1], int64[::1], float64[:,::1], "
    "float64[:,::1], float64[:,:,::1], float64, float64[:,:,::1], float64[:,::1], float64[:,::1], int8[::1]"
)
def rests_found(
    points: Any,
    normals: Any,
    heights: Any,
    on_part: bool,
    kept_vectors: Any,
    kept_normals: Any,
    kept_shifts: Any,
    kept_steps: Any,
    all_rows: Any,
    rows: Any,
    steps: Any,
    first_basis: Any,
    first_inverse: Any,
    first_loads: Any,
    start: Any,
    reach: float,
    turns: Any,
    shifts: Any,
    carried: Any,
    outcomes: Any,
) -> None:
    """Poses of parts at rest.

    Args:
        points, normals, heights: of the contacts (contacts, 3, n) and (contacts, n), see gap_of; (..., 1) of what does
            not vary.
        on_part: whether the points are on the part.
        kept_vectors, kept_normals: of what stays as it begins, n . (R p + s t), p and n (kept, 3, n).
        kept_shifts: s (kept,).
        kept_steps: turn by reach and shift, that undo a change of it (6, kept).
        all_rows: how nominal gaps change with turn by reach and shift (contacts, 6).
        rows: how nominal gaps change with the motions (contacts, motions) [mm/mm].
        steps: of the motions, turn by reach and shift (6, motions).
        first_basis: contacts that would carry if all were touched, one for each motion.
        first_inverse: of their rows (motions, motions).
        first_loads: on them, of the force and of the second direction (2, motions).
        start: the pose before contacts count (3, 4, n).
        reach: of the points about its origin [mm].
        turns, shifts: found (3, 3, n), (3, n) [mm]; not a number where there is none.
        carried, outcomes: part of the force on each contact (contacts, n); RESTS, CLASHES or LOST (n,).
    """
    contacts, programme = (points, normals, heights), (all_rows, rows, steps)
    count, motions = rows.shape
    pose, first = np.empty((3, 4)), np.empty(kept_shifts.shape[0])
    kept = (kept_vectors, kept_normals, kept_shifts, kept_steps, first)
    basis, inverse, loads = np.empty(motions, np.int64), np.empty((motions, motions)), np.empty((2, motions))
    anew = (np.empty((count, 6)), np.empty((count, motions)), steps)
    moves, square = (np.empty(motions), np.empty(motions)), np.empty((motions, motions))
    rooms = (np.empty(count), np.empty(6), moves, square, np.empty(motions))
    for i in range(outcomes.shape[0]):
        begin(pose, first, start, i, kept, (basis, inverse, loads), (first_basis, first_inverse, first_loads))
        outcome = settled(pose, contacts, i, on_part, kept, programme, (basis, inverse, loads), rooms, reach, False)
        if outcome == LOST:
            begin(pose, first, start, i, kept, (basis, inverse, loads), (first_basis, first_inverse, first_loads))
            outcome = settled(pose, contacts, i, on_part, kept, anew, (basis, inverse, loads), rooms, reach, True)
            if outcome == RESTS and not pressed(rows, basis, inverse, loads, (first_basis, first_loads), rooms):
                outcome = LOST
        outcomes[i] = outcome
        note(outcome, pose, basis, loads, i, (turns, shifts, carried))
