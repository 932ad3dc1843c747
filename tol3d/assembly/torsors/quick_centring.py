"""The largest common slack of a part with play, trial by trial in a kernel, where its optimum is smooth.

Newton's steps on the conditions of `meeting`, with z_k w_k = mu in place of w_k = 0 and mu that falls faster the nearer
it is (Nocedal, Wright: Numerical Optimization, 19.3), show which places decide. Where a place ends in the middle of its
clearance u_k has no direction: such trials, and the few that no start leads to, are left to `interior_points`.
"""

from typing import Any, Final

import numpy as np

from tol3d.assembly.torsors.meeting import balance, equations, finished, lengths_of, solved
from tol3d.numerics.compiled import FULL, kernel, nested
from tol3d.numerics.loops import fill

STEPS: Final = 20
"""Of Newton, 6 to 10 in practice; what takes more is left."""
UNDER: Final = 0.5, 0.2
"""How far it starts under the slack that there is, of the largest offset; one after the other until one leads to it."""
FALLS: Final = 0.1
"""Most of mu that is left by a step."""
INSIDE: Final = 0.98
"""Least share of the way to the end of the room that a step may go."""
NEAR: Final = 1e-3
"""Gap and balance, under which it shows which places decide."""


@nested
def way_out(w: float, length: float, a: float, b: float, up: float, u: float, v: float) -> Any:
    """The share of a step after which |y + t (u, v)| = w + |y| + t up, that has w to go at first."""
    inside, slope = w * (w + 2.0 * length), (w + length) * up - a * u - b * v
    bend = up * up - u * u - v * v
    rest = slope * slope - bend * inside
    if bend < 0.0:
        return (-slope - np.sqrt(max(rest, 0.0))) / bend if slope < 0.0 else inside / (np.sqrt(max(rest, 0.0)) - slope)
    if slope < 0.0 and rest > 0.0:
        return inside / (np.sqrt(rest) - slope)
    return 1e30


@nested
def moved(trial: Any, state: Any, step: Any, near: float) -> Any:
    """Change multipliers by a step, as far as they stay over 0; how far the room allows it."""
    rows, counts, _ = trial
    y, z, w, stiff, back, pulls = state
    size = rows.shape[2]
    ahead, behind = 1e30, 1e30
    for k in range(rows.shape[0]):
        if counts[k]:
            u, v, along = 0.0, 0.0, step[size]
            for i in range(size):
                u += rows[k, 0, i] * step[i]
                v += rows[k, 1, i] * step[i]
                along += pulls[k, i] * step[i]
            length = np.sqrt(y[k, 0] * y[k, 0] + y[k, 1] * y[k, 1])
            ahead = min(ahead, way_out(w[k], length, y[k, 0], y[k, 1], -step[size], u, v))
            back[k] += stiff[k] * along - z[k]
            if back[k] < 0.0:
                behind = min(behind, -z[k] / back[k])
    behind = min(1.0, near * behind)
    for k in range(rows.shape[0]):
        if counts[k]:
            z[k] += behind * back[k]
    return min(1.0, near * ahead)


@nested
def sought(place: Any, trial: Any, goal: Any, under: float, q: Any, state: Any, system: Any, step: Any) -> bool:
    """Whether the largest slack is found: q, and multipliers in the state; from one under that there is, goal 0."""
    offsets, clearances = place
    rows, counts, _ = trial
    _, z, w, stiff, back, _ = state
    size, count, least, widest = rows.shape[2], 0, 1e30, 0.0
    fill(q, 0.0)
    for k in range(rows.shape[0]):
        if counts[k]:
            length = np.sqrt(offsets[k, 0] * offsets[k, 0] + offsets[k, 1] * offsets[k, 1])
            least, widest, count = min(least, clearances[k] - length), max(widest, length), count + 1
    s, scale = least - under * (widest + 1e-3), 0.0
    for k in range(rows.shape[0]):
        z[k] = 1.0 / count if counts[k] else 0.0
        scale = max(scale, clearances[k] - s if counts[k] else 0.0)
    for _ in range(STEPS):
        if not lengths_of(place, trial, q, s, state):
            return False
        gap = 0.0
        for k in range(rows.shape[0]):
            gap += z[k] * w[k] if counts[k] else 0.0
        share = max(gap / scale, balance(trial, goal, 1, state))
        if share <= NEAR:
            return finished(place, trial, goal, 1, q, s, scale, state, system, step)
        mu = min(FALLS, share) * share * scale / count
        for k in range(rows.shape[0]):
            if counts[k]:
                if not w[k] > 0.0:
                    return False
                stiff[k], back[k] = z[k] / w[k], mu / w[k]
        equations(trial, state, system, step)
        solved(system, step, size + 1)
        ahead = moved(trial, state, step, max(INSIDE, 1.0 - share))
        s += ahead * step[size]
        for i in range(size):
            q[i] += ahead * step[i]
    return False


@nested
def improved(place: Any, trial: Any, goal: Any, lifts: int, q: Any, state: Any, system: Any, step: Any) -> bool:
    """Whether the optimum is reached from q and multipliers that are near it."""
    clearances = place[1]
    rows, counts, _ = trial
    w, scale, s = state[2], 0.0, 1e30
    if not lengths_of(place, trial, q, 0.0, state):
        return False
    for k in range(rows.shape[0]):
        if counts[k]:
            s, scale = min(s, w[k]), max(scale, clearances[k])
    s = s if lifts else 0.0
    scale = max(scale, scale - s)
    for k in range(rows.shape[0]):
        w[k] -= s
    return finished(place, trial, goal, lifts, q, s, scale, state, system, step)


@kernel(
    arrays="float64[:,:,::1], float64[:,::1], float64[:,:,:,::1], boolean[:,::1], float64[:,:,::1], float64[:,::1], "
    "int64, float64[:,::1], float64[:,::1], boolean[::1]",
    level=FULL,
)
def quickly_centred(
    offsets: Any, clearances: Any, rows: Any, counts: Any, closed: Any, goal: Any, lifts: Any, steps: Any,
    multipliers: Any, found: Any,
) -> None:  # fmt: skip
    """Steps to the largest common slack, or, from near by, as far as a goal can be reached.

    Args:
        offsets, clearances, rows, counts, closed: see centring.largest_slack.
        goal: (freedoms, trials), of length 1; 0 where it lifts.
        lifts: 1 for the slack, 0 for the goal.
        steps: (freedoms, trials) [mm].
        multipliers: of the places, 1 in all (places, trials).
        found: in which trials they are (trials,); before, in which they are near it, to be improved. What is not found
            is left as it was.
    """
    places, size = rows.shape[0], rows.shape[2]
    own, clear, turned = np.empty((places, 2)), np.empty(places), np.empty((places, 2, size))
    used, shut, q = np.empty(places, dtype=np.bool_), np.empty((size, size)), np.empty(size)
    way = np.empty(size)
    state = (
        np.empty((places, 2)), np.empty(places), np.empty(places), np.empty(places), np.empty(places),
        np.empty((places, size)),
    )  # fmt: skip
    system, step = np.empty((size + 1, size + 1)), np.empty(size + 1)
    for n in range(found.shape[0]):
        for k in range(places):
            used[k], clear[k] = counts[k, n], clearances[k, n]
            for r in range(2):
                own[k, r] = offsets[k, r, n]
                for i in range(size):
                    turned[k, r, i] = rows[k, r, i, n]
        for i in range(size):
            way[i] = goal[i, n]
            for j in range(size):
                shut[i, j] = closed[i, j, n]
        place, trial = (own, clear), (turned, used, shut)
        if found[n]:
            for i in range(size):
                q[i] = steps[i, n]
            for k in range(places):
                state[1][k] = multipliers[k, n]
            found[n] = improved(place, trial, way, lifts, q, state, system, step)
        else:
            for under in UNDER:
                found[n] = sought(place, trial, way, under, q, state, system, step)
                if found[n]:
                    break
        if found[n]:
            for i in range(size):
                steps[i, n] = q[i]
            for k in range(places):
                multipliers[k, n] = state[1][k]
