"""Parts on fewer one-sided contacts than freedoms, trial by trial: the tilt that balances the force on them.

Like a ball in a trough: the force turns the part one way beside some contacts, the other way beside the others, and is
balanced in between. Newton's method for the contacts and the balance at once, from a pose near by.
"""

from typing import Any, Final

import numpy as np

from tol3d.assembly.placing.one_sided_gaps import MET, gap_of, pull_at
from tol3d.assembly.placing.rest_solver import LOST, RESTS, begin
from tol3d.assembly.placing.tilted_rest_solver import PIERCED, motion_rows, shifted
from tol3d.numerics.compiled import kernel, nested
from tol3d.numerics.loops import copy_matrix, eliminated, fill_matrix

STEPS: Final = 30
WAY: Final = 0.02
"""Turn [rad], and shift per mm of reach, beyond which a balance is a different one."""
NUDGE: Final = 1e-4
"""Fraction of the reach, the step of the rows' differences; the error is that squared."""


@nested
def lacking(pose: Any, trial: Any, reach: float, chosen: Any, shares: Any, programme: Any, found: Any) -> None:
    """Residuals of the force balance on chosen contacts along the motions, then gaps of these contacts."""
    contacts, i, on_part, _, force, _ = trial
    rows, _, _, pull, all_pull = programme
    pull_at(pose, force, reach, all_pull)
    motion_rows(pose, trial, reach, all_pull, programme[:4])
    motions = pull.shape[0]
    for j in range(motions):
        found[j] = pull[j]
    for c in range(shares.shape[0]):
        for j in range(motions):
            found[j] += shares[c] * rows[chosen[c], j]
        found[motions + c] = gap_of(pose, contacts, chosen[c], i, on_part)


@nested
def linearised(pose: Any, trial: Any, reach: float, chosen: Any, shares: Any, programme: Any, system: Any) -> None:
    """The equations of the contacts and the balance at a pose: residuals, and their changes by differences."""
    right, matrix, ends, motion, step, near, base = system
    rows, _, tangents, pull, _ = programme
    motions, by = pull.shape[0], NUDGE * reach
    for n in range(2 * motions + 1):
        j, side = (n - 1) // 2, (n - 1) % 2
        copy_matrix(near, pose)
        if n > 0:
            for k in range(motions):
                motion[k] = 0.0
            motion[j] = by if side else -by
            shifted(near, trial, reach, motion, base, step)
        lacking(near, trial, reach, chosen, shares, programme, ends[side])
        if n == 0:
            fill_matrix(matrix, 0.0)
            copy_matrix(base, tangents)
            for r in range(right.shape[0]):
                right[r] = -ends[side, r]
            for c in range(shares.shape[0]):
                for k in range(motions):
                    matrix[k, motions + c] = rows[chosen[c], k]
        elif side:
            for r in range(right.shape[0]):
                matrix[r, j] = (ends[1, r] - ends[0, r]) / (2.0 * by)


@nested
def balanced(pose: Any, trial: Any, reach: float, chosen: Any, shares: Any, programme: Any, system: Any) -> bool:
    """Find a nearby pose at which chosen contacts touch and balance the force, and their loads; True if found."""
    right, matrix, _, motion, step, _, base = system
    motions, gone = motion.shape[0], 0.0
    for _ in range(STEPS):
        linearised(pose, trial, reach, chosen, shares, programme, system)
        if eliminated(matrix, right, right.shape[0])[0] == 0.0:
            return False
        for j in range(motions):
            motion[j] = right[j]
        for c in range(shares.shape[0]):
            shares[c] += right[motions + c]
        length = shifted(pose, trial, reach, motion, base, step)
        gone += length
        if length <= MET:
            return True
        if not gone < WAY:
            return False
    return False


@nested
def keeps(pose: Any, contacts: Any, i: int, on_part: bool, shares: Any) -> bool:
    """True if no contact interferes and none would have to pull."""
    for k in range(contacts[0].shape[0]):
        if gap_of(pose, contacts, k, i, on_part) < -PIERCED:
            return False
    return bool(shares.min() >= 0.0)


@kernel(
    arrays="float64[:,:,::1], float64[:,:,::1], float64[:,::1], boolean, float64[:,:,::1], float64[:,:,::1], "
    "float64[::1], float64[:,::1], float64[::1], float64[::1], float64[:,::1], float64[:,:,::1], float64, "
    "float64[:,:,::1], float64[:,::1], float64[:,::1], int8[::1]"
)
def balances_found(
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
    """Poses of parts that are balanced; see `tilted_rests_found`.

    Args:
        points, normals, heights, on_part, kept_vectors, kept_normals, kept_shifts, kept_steps, force, at, steps, start,
            reach: as there.
        turns, shifts, carried: poses near by, and what carries there; then those of the balance.
        outcomes: RESTS or LOST (n,).
    """
    count, motions = points.shape[0], steps.shape[1]
    pose, first = np.empty((3, 4)), np.empty(kept_shifts.shape[0])
    kept = (kept_vectors, kept_normals, kept_shifts, kept_steps, first)
    chosen, all_shares = np.empty(count, np.int64), np.empty(count)
    rows, pull = (np.empty((count, motions)), np.empty((count, 6)), np.empty((6, motions))), np.empty(motions)
    programme = (*rows, pull, np.empty(6))
    rooms = (np.empty(motions), np.empty(6), np.empty((3, 4)), np.empty((6, motions)))
    for i in range(outcomes.shape[0]):
        begin(pose, first, start, i, kept)
        for r in range(3):
            pose[r, 3] = shifts[r, i]
            for c in range(3):
                pose[r, c] = turns[r, c, i]
        carriers = 0
        for k in range(count):
            if carried[k, i] > 0.0:
                chosen[carriers], all_shares[carriers] = k, carried[k, i]
                carriers += 1
            carried[k, i] = 0.0
        shares, size = all_shares[:carriers], motions + carriers
        system = (np.empty(size), np.empty((size, size)), np.empty((2, size)), *rooms)
        trial = ((points, normals, heights), i, on_part, kept, (force, at), steps)
        found = balanced(pose, trial, reach, chosen, shares, programme, system)
        found = found and keeps(pose, trial[0], i, on_part, shares)
        outcomes[i] = RESTS if found else LOST
        for c in range(carriers):
            carried[chosen[c], i] = shares[c] if found else 0.0
        for r in range(3):
            shifts[r, i] = pose[r, 3] if found else np.nan
            for c in range(3):
                turns[r, c, i] = pose[r, c] if found else np.nan
