"""Parts on one-sided contacts under a force, trial by trial: the finite pose by the lever arms of the pose itself.

The least potential of the force subject to gaps of 0 or more, by successive linear programmes about the pose reached:
each motion stays in a box where linear rows hold, and a gap below 0 costs more than any contact carries (an exact
penalty, Fletcher and Sainz de la Maza 1989), so that the potential and the deepest gap together fall from step to step.
Where contacts alone decide, the last steps are Newton's; the others, where a tilt balances the force on fewer contacts
than freedoms, are left to `balances`.
"""

from typing import Any, Final

import numpy as np

from tol3d.assembly.placing.one_sided_gaps import MET, gap_of, pull_at, restored, rows_at, stepped, tangents_at
from tol3d.assembly.placing.rest_solver import BETWEEN, CLASHES, LOST, RESTS, TIED, TIPS, begin, note
from tol3d.numerics.compiled import kernel, nested
from tol3d.numerics.loops import copy_matrix, fill, fill_matrix
from tol3d.numerics.programme import OK, exchanged, new_rooms


@nested
def motion_rows(pose: Any, trial: Any, reach: float, pull: Any, found: Any) -> None:
    """Change of gaps per motion that keeps the constraints (contacts, motions), and the force along each (motions,).

    Args:
        pull: of the force at the pose (6,).
        found: rows by motions, by turn by reach and shift (contacts, 6), the motions (6, motions), and the pull.
    """
    contacts, i, on_part, kept, _, steps = trial
    rows, all_rows, tangents, motion_pull = found
    rows_at(pose, contacts, i, on_part, reach, all_rows)
    tangents_at(pose, kept, i, steps, reach, tangents)
    for j in range(tangents.shape[1]):
        motion_pull[j] = 0.0
        for r in range(6):
            motion_pull[j] += tangents[r, j] * pull[r]
        for k in range(all_rows.shape[0]):
            rows[k, j] = 0.0
            for r in range(6):
                rows[k, j] += all_rows[k, r] * tangents[r, j]


@nested
def shifted(pose: Any, trial: Any, reach: float, motion: Any, tangents: Any, step: Any) -> Any:
    """Move a pose along its motions (motions,); returns the length of the step."""
    _, i, _, kept, _, _ = trial
    for r in range(6):
        step[r] = 0.0
        for j in range(tangents.shape[1]):
            step[r] += tangents[r, j] * motion[j]
    length = stepped(pose, step, reach)
    restored(pose, kept, i, reach, step)
    return length


STEPS: Final = 300
SEARCH: Final = 0.05
"""Fraction of the reach: the largest box."""
TRIES: Final = 2
"""Boxes are made ever smaller: in a large one a part may pass over the pose that holds it."""
NEAR: Final = 1e-5
"""Fraction of the reach: a side of this box that still carries shows that a balance is near."""
FAR: Final = 0.5
"""Turn [rad], and shift per mm of reach, beyond which a part is not held."""
DEAR: Final = 10.0
"""First cost of a gap of -1 mm, in forces times 1 mm."""
DEAREST: Final = 1e5
ROUNDING: Final = 1e-13
"""Change of a cost, per mm of reach, that counts as none."""
PIERCED: Final = 1e-10
"""mm; a gap below minus that is one."""


@nested
def cost_of(pose: Any, trial: Any, reach: float, dear: float, rooms: Any) -> Any:
    """The potential of the force and the price of the deepest gap [mm], that gap as an amount, and gaps and pull."""
    contacts, i, on_part, _, force, _ = trial
    gaps, pull = rooms
    deepest = 0.0
    for k in range(gaps.shape[0]):
        gaps[k] = gap_of(pose, contacts, k, i, on_part)
        deepest = max(deepest, -gaps[k])
    return dear * deepest - pull_at(pose, force, reach, pull), deepest


@nested
def boxed_rows(rows: Any, contacts: int) -> None:
    """Rows of a box, and of a last motion that opens all gaps, beside those of contacts."""
    motions = rows.shape[1] - 1
    for k in range(rows.shape[0]):
        for j in range(motions + 1):
            rows[k, j] = 0.0
    for k in range(contacts):
        rows[k, motions] = 1.0
    for j in range(motions + 1):
        rows[contacts + j, j] = 1.0


@nested
def boxed(programme: Any, gaps: Any, box: float, dear: float, begun: Any, own: Any) -> int:
    """Find the best motion in a box; see `programme.solve_lp`."""
    rows, all_rows, _, pull = programme
    basis, solving = begun
    lower, upper, motion = own
    _, inverse, sides, loads, shares = solving
    count, motions = all_rows.shape[0], pull.shape[0]
    fill_matrix(inverse, 0.0)
    for k in range(count):
        lower[k] = -gaps[k]
    for j in range(motions + 1):
        lower[count + j], upper[count + j] = -box, box
        basis[j], inverse[j, j], sides[j], loads[1, j] = count + j, 1.0, -1.0, 1.0 + j
        if j < motions:
            sides[j], loads[0, j] = (1.0 if pull[j] > 0.0 else -1.0), abs(pull[j])
    lower[count + motions], upper[count + motions] = 0.0, np.inf
    loads[0, motions], loads[1, motions] = dear, 1.0
    return exchanged(rows, lower, upper, basis, inverse, sides, loads, shares, motion)[0]


@nested
def far_from(pose: Any, start: Any, reach: float) -> bool:
    """True if a pose has left another one for good."""
    shift, trace = 0.0, 0.0
    for r in range(3):
        shift = max(shift, abs(pose[r, 3] - start[r, 3]))
        for c in range(3):
            trace += pose[r, c] * start[r, c]
    return not (shift < FAR * reach and trace > 1.0 + 2.0 * np.cos(FAR))


@nested
def boxed_in(basis: Any, loads: Any, contacts: int, motions: int) -> bool:
    """True if a side of the box carries load."""
    found = False
    for b in range(basis.shape[0]):
        found = found or (contacts <= basis[b] < contacts + motions and loads[0, b] > TIED)
    return found


@nested
def found_rest(
    pose: Any, start: Any, trial: Any, reach: float, most: float, begun: Any, programme: Any, rooms: Any, own: Any
) -> int:
    """Follow a part along the force from a pose, by the lever arms of each pose; returns its status."""
    motions, contacts = programme[3].shape[0], programme[1].shape[0]
    basis, loads, motion = begun[0], begun[1][3], own[2]
    boxed_rows(programme[0], contacts)
    step, there, dear, box = np.empty(6), np.empty((3, 4)), DEAR, most
    for _ in range(STEPS):
        cost, deepest = cost_of(pose, trial, reach, dear, rooms)
        motion_rows(pose, trial, reach, rooms[1], programme)
        if boxed(programme, rooms[0], box, dear, begun, own) != OK:
            return LOST
        gain = dear * (deepest - motion[motions])
        for j in range(motions):
            gain += programme[3][j] * motion[j]
        copy_matrix(there, pose)
        length = shifted(there, trial, reach, motion, programme[2], step)
        bounded = boxed_in(basis, loads, contacts, motions)
        if length <= MET and not bounded:
            if deepest <= PIERCED:
                return RESTS
            if dear >= DEAREST:
                return CLASHES
            dear, box = 10.0 * dear, most
            continue
        its_cost, _ = cost_of(there, trial, reach, dear, rooms)
        if cost - its_cost >= 0.1 * gain - ROUNDING * reach:
            copy_matrix(pose, there)
            if bounded and cost - its_cost > 0.75 * gain:
                box = min(2.0 * box, most)
            if far_from(pose, start, reach):
                return TIPS
        else:
            box = 0.5 * min(box, length * reach)
        if bounded and box < NEAR * reach and deepest <= NEAR * reach:
            return BETWEEN
        if box < MET * reach:
            return LOST if deepest <= PIERCED else CLASHES
    return LOST


@kernel(
    arrays="float64[:,:,::1], float64[:,:,::1], float64[:,::1], boolean, float64[:,:,::1], float64[:,:,::1], "
    "float64[::1], float64[:,::1], float64[::1], float64[::1], float64[:,::1], float64[:,:,::1], float64, "
    "float64[:,:,::1], float64[:,::1], float64[:,::1], int8[::1]"
)
def tilted_rests_found(
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
    steps: Any,
    start: Any,
    reach: float,
    turns: Any,
    shifts: Any,
    carried: Any,
    outcomes: Any,
) -> None:
    """Poses of parts at rest; see `rests_found`.

    Args:
        points, normals, heights, on_part, kept_vectors, kept_normals, kept_shifts, kept_steps, force, at, steps, start,
            reach, turns, shifts, carried: as there.
        outcomes: RESTS, CLASHES, TIPS, LOST, or BETWEEN of what is near a balance of those that carry (n,).
    """
    count, motions = points.shape[0], steps.shape[1]
    pose, begin_at, first = np.empty((3, 4)), np.empty((3, 4)), np.empty(kept_shifts.shape[0])
    kept = (kept_vectors, kept_normals, kept_shifts, kept_steps, first)
    size, all_rows = motions + 1, count + motions + 1
    begun = (np.empty(size, np.int64), new_rooms(size))
    programme = (np.empty((all_rows, size)), np.empty((count, 6)), np.empty((6, motions)), np.empty(motions))
    rooms, own = (np.empty(count), np.empty(6)), (np.empty(all_rows), np.empty(all_rows), np.empty(size))
    fill(own[1], np.inf)
    for i in range(outcomes.shape[0]):
        trial, outcome, box = ((points, normals, heights), i, on_part, kept, (force, at), steps), TIPS, SEARCH * reach
        for _ in range(TRIES):
            if outcome == TIPS:
                begin(pose, first, start, i, kept)
                copy_matrix(begin_at, pose)
                outcome = found_rest(pose, begin_at, trial, reach, box, begun, programme, rooms, own)
                box = box / 8.0
        outcomes[i] = outcome
        basis, loads = begun[0], begun[1][3]
        for b in range(size):
            if basis[b] >= count:
                basis[b], loads[0, b] = 0, 0.0
        note(outcomes[i], pose, basis, loads, i, (turns, shifts, carried))
