"""The room of a bolt in its two holes: how far a part may go until the bolt has no place, in a kernel.

The largest slack f(t) that the bolt's two shifts and two leans leave at all four ends of its holes is concave in the
way t that the part goes. Beyond its root it falls by sum m_k u_k . B_k d, the multipliers m_k of its programme, so that
Newton's steps lead to the root from one side.
"""

from typing import Any, Final

import numpy as np

from tol3d.assembly.placing.rooms import at_step, new_rooms, reached, started
from tol3d.numerics.compiled import nested
from tol3d.numerics.loops import fill

ENDS: Final = 4
"""Of both holes of a bolt; and its unknowns."""
STEPS: Final = 60
"""Of Newton and of doublings, 3 to 6 in practice."""
MET: Final = 1e-13
"""Of clearances, slack that is none."""
STILL: Final = 1e-9
"""Change of all offsets by a way of length 1 that is none."""


@nested
def bolt_slack(own: Any, t: float, rooms: Any) -> Any:
    """The largest slack of a bolt after a way t, and its change; not a number if it is not found."""
    offsets, clearances, rows, gone, at, q = own
    _, used, y, z, found, _, inner = rooms
    fill(used, True)
    fill(q, 0.0)
    for k in range(ENDS):
        for c in range(2):
            at[k, c] = offsets[k, c] + t * gone[k, c]
    started((at, clearances, rows), q, used, y, z, ENDS, 1, 1.0)
    if not reached((at, clearances, rows), q, (y, z, rows, used), ENDS, 1, 1.0, q, found, inner):
        return np.nan, np.nan
    for r in range(ENDS):
        q[r] = found[r]
    slack, slope = np.inf, 0.0
    for k in range(ENDS):
        a, b = at_step(at, rows, q, k)
        length = np.sqrt(a * a + b * b)
        slack = min(slack, clearances[k] - length)
        if length > 0.0:
            slope -= z[k, 0] * (a * gone[k, 0] + b * gone[k, 1]) / length
    return slack, slope


@nested
def bolt_way(place: Any, bolt_of: Any, bolt: int, drawn: Any, i: int, most: float, rooms: Any) -> Any:
    """How far a part may go along a direction until a bolt has no place; `most` where that is farther.

    Args:
        place: offsets (cones, 2), clearances (cones,) and rows (cones, 2, freedoms + 4 bolts) where it is.
        bolt_of: which bolt each cone is of (cones,).
        bolt: which.
        drawn: directions, and shares of the way (freedoms + 1, n).
        i: which trial.
        most: [mm].
        rooms: see `bolt_rooms`.
    """
    own, inner = rooms
    offsets, clearances, rows, gone, _, _ = own
    parts, n, fastest, widest = drawn.shape[0] - 1, 0, 0.0, 0.0
    for k in range(bolt_of.shape[0]):
        if bolt_of[k] != bolt:
            continue
        clearances[n] = place[1][k]
        widest = max(widest, abs(clearances[n]))
        for c in range(2):
            offsets[n, c], gone[n, c] = place[0][k, c], 0.0
            for f in range(parts):
                gone[n, c] += place[2][k, c, f] * drawn[f, i]
            for r in range(ENDS):
                rows[n, c, r] = place[2][k, c, parts + ENDS * bolt + r]
            fastest = max(fastest, abs(gone[n, c]))
        n += 1
    if not fastest > STILL:
        return most
    t, ahead, slack = 0.0, 2.0 * widest / fastest, np.nan  # ways are doubled until one is too long
    for _ in range(2 * STEPS):
        slack, slope = bolt_slack(own, t, inner)
        if slack > 0.0 and ahead > 0.0:
            if t >= most:
                return most
            t, ahead = min(ahead, most), 2.0 * ahead
            continue
        ahead = 0.0
        if slack >= -MET * widest or not slope < 0.0:
            break
        t -= slack / slope
    return t if np.isfinite(slack) else np.nan


@nested
def bolt_rooms() -> Any:
    """What it works with."""
    own = (
        np.empty((ENDS, 2)), np.empty(ENDS), np.empty((ENDS, 2, ENDS)), np.empty((ENDS, 2)), np.empty((ENDS, 2)),
        np.empty(ENDS),
    )  # fmt: skip
    return own, new_rooms(ENDS, ENDS)
