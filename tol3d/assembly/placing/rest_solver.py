"""Parts on one-sided contacts under a force, trial by trial: the finite pose by the nominal lever arms.

Each step solves a linear programme about the pose reached: the farthest motion along the force with no gap below 0, by
the dual simplex method with the nominal lever arms; then gaps are evaluated again. If several motions go equally far, a
second direction chooses among them (a lexicographic programme). A pose is accepted if the force presses all loaded
contacts by the lever arms of the pose, too; other trials are left to `tilted_rest_solver`. Each trial begins with the
same contacts, so that it has the same bits alone and among thousands.
"""

from typing import Any, Final

import numpy as np

from tol3d.assembly.placing.one_sided_gaps import MET, gap_of, kept_at, pull_at, rows_at, stepped, tangents_at, undoing
from tol3d.numerics.compiled import kernel, nested
from tol3d.numerics.loops import copy, copy_matrix, eliminated, fill
from tol3d.numerics.programme import NO_ROOM, OK, exchanged, new_rooms

TIED: Final = 1e-9
"""Fraction of the force below which a contact carries nothing."""
STEPS: Final = 60
"""Most programmes of a trial."""

RESTS: Final = 0
CLASHES: Final = 1
"""No motion opens all gaps: the part does not fit."""
LOST: Final = 2
"""Not decided by the nominal lever arms."""
TIPS: Final = 3
"""Nothing stops the part: it tips off its contacts, or slides."""
BETWEEN: Final = 4
"""Near a tilt that balances the force on fewer contacts than freedoms."""


@nested
def settled(
    pose: Any, contacts: Any, i: int, on_part: bool, kept: Any, programme: Any, begun: Any, rooms: Any, reach: float
) -> int:
    """Move a part along the force from a pose to rest, by the nominal rows; returns RESTS, CLASHES or LOST."""
    all_rows, rows, steps = programme
    basis, (_, inverse, sides, loads, shares) = begun
    lower, upper, step, motion = rooms
    for n in range(STEPS):
        undoing(pose, kept, i, step)
        for k in range(lower.shape[0]):
            lower[k] = -gap_of(pose, contacts, k, i, on_part)
            for r in range(6):
                lower[k] -= all_rows[k, r] * step[r]
        solved, _, _ = exchanged(rows, lower, upper, basis, inverse, sides, loads, shares, motion)
        if solved != OK:
            return CLASHES if solved == NO_ROOM and n == 0 else LOST
        for r in range(6):
            for j in range(rows.shape[1]):
                step[r] += steps[r, j] * motion[j]
        length = stepped(pose, step, reach)
        if length <= MET:
            return RESTS
        if not length < np.inf:
            return LOST
    return LOST


@nested
def pressed(
    pose: Any, contacts: Any, i: int, on_part: bool, kept: Any, force: Any, steps: Any, begun: Any, rooms: Any,
    reach: float,
) -> bool:  # fmt: skip
    """True if the force presses all loaded contacts by the lever arms of the pose, too."""
    basis, (matrix, _, _, loads, right) = begun
    all_rows, pull, tangents = rooms
    rows_at(pose, contacts, i, on_part, reach, all_rows)
    pull_at(pose, force, reach, pull)
    tangents_at(pose, kept, i, steps, reach, tangents)
    count = basis.shape[0]
    for j in range(count):
        right[j] = 0.0
        for r in range(6):
            right[j] -= tangents[r, j] * pull[r]
        for b in range(count):
            matrix[j, b] = 0.0
            for r in range(6):
                matrix[j, b] += tangents[r, j] * all_rows[basis[b], r]
    if eliminated(matrix, right, count)[0] == 0.0:
        return False
    held = True
    for b in range(count):
        held = held and (loads[0, b] <= TIED or right[b] >= 0.0)
    return held


@nested
def begin(pose: Any, first: Any, start: Any, i: int, kept: Any) -> None:
    """Set the first pose, and store its constraints."""
    vectors, normals, shifts, _, _ = kept
    at = min(i, start.shape[2] - 1)
    for r in range(3):
        for c in range(4):
            pose[r, c] = start[r, c, at]
    for e in range(first.shape[0]):
        first[e] = kept_at(pose, (vectors, normals, shifts), e, i)


@nested
def note(outcome: int, pose: Any, basis: Any, loads: Any, i: int, results: Any) -> None:
    """Store the pose of a part, and the loads of its contacts if it rests."""
    turns, shifts, carried = results
    rests = outcome in (RESTS, BETWEEN)
    for k in range(carried.shape[0]):
        carried[k, i] = 0.0
    for b in range(basis.shape[0]):
        if loads[0, b] > TIED and rests:
            carried[basis[b], i] = loads[0, b]
    for r in range(3):
        for c in range(3):
            turns[r, c, i] = pose[r, c]
        shifts[r, i] = pose[r, 3]


@kernel(
    arrays="float64[:,:,::1], float64[:,:,::1], float64[:,::1], boolean, float64[:,:,::1], float64[:,:,::1], "
    "float64[::1], float64[:,::1], float64[::1], float64[::1], float64[:,::1], float64[:,::1], float64[:,::1], "
    "int64[::1], float64[:,::1], float64[:,::1], float64[:,:,::1], float64, float64[:,:,::1], float64[:,::1], "
    "float64[:,::1], int8[::1]"
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
    force: Any,
    at: Any,
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
    """Poses of parts at rest: of the middle of the touching features, about its nominal place.

    Points and normals of the part are about the middle, along the part's axes; those of the world about its nominal
    place.

    Args:
        points, normals, heights: of the contacts (contacts, 3, n) and (contacts, n), see `one_sided_gaps.gap_of`;
            (..., 1) if they do not vary.
        on_part: True if the points are on the part.
        kept_vectors, kept_normals: p and n of constraints n . (R p + s t), which stay as they begin (kept, 3, n).
        kept_shifts: s (kept,).
        kept_steps: steps (turn times reach, shift) that undo a change of each constraint (6, kept).
        force, at: direction (3,) in the world; a point of the part on its line (3,) [mm].
        all_rows: changes of nominal gaps per turn times reach and shift (contacts, 6) [mm/mm].
        rows: changes of nominal gaps per motion (contacts, motions) [mm/mm].
        steps: the motions, turn times reach and shift (6, motions).
        first_basis, first_inverse: contacts that would carry if all touched, one per motion, and the inverse of their
            rows.
        first_loads: loads on them of the force and of the second direction (2, motions).
        start: the pose before contacts are met (3, 4, n).
        reach: largest distance of the points from the middle [mm].
        turns, shifts: written: the rotation (3, 3, n) and the middle's shift (3, n) [mm]; meaningless unless it rests.
        carried, outcomes: written: part of the force on each contact (contacts, n), and RESTS, CLASHES, or LOST where
            the lever arms of the pose decide (n,).
    """
    contacts, programme = (points, normals, heights), (all_rows, rows, steps)
    count, motions = rows.shape
    pose, first = np.empty((3, 4)), np.empty(kept_shifts.shape[0])
    kept = (kept_vectors, kept_normals, kept_shifts, kept_steps, first)
    basis, solving = np.empty(motions, np.int64), new_rooms(motions)
    begun, rooms = (basis, solving), (np.empty(count), np.empty(count), np.empty(6), np.empty(motions))
    at_pose = (np.empty((count, 6)), np.empty(6), np.empty((6, motions)))
    fill(rooms[1], np.inf)
    for i in range(outcomes.shape[0]):
        begin(pose, first, start, i, kept)
        copy(basis, first_basis)
        copy_matrix(solving[1], first_inverse)
        fill(solving[2], -1.0)
        copy_matrix(solving[3], first_loads)
        outcome = settled(pose, contacts, i, on_part, kept, programme, begun, rooms, reach)
        if outcome == RESTS:
            held = pressed(pose, contacts, i, on_part, kept, (force, at), steps, begun, at_pose, reach)
            outcome = RESTS if held else LOST
        outcomes[i] = outcome
        note(outcome, pose, basis, solving[3], i, (turns, shifts, carried))
