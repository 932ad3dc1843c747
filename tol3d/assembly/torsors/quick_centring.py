"""The largest common slack of a part with play, trial by trial in a kernel, where its optimum is smooth.

Newton's steps on the conditions of `meeting`, with z_k w_k = mu in place of w_k = 0 and mu that falls faster the nearer
it is (Nocedal, Wright: Numerical Optimization, 19.3), show the places that decide. If a place ends in the middle of its
clearance, u_k has no direction: such trials, and the few for which no start succeeds, are left to `interior_points`.
"""

from typing import Any, Final

import numpy as np

from tol3d.numerics.compiled import FULL, kernel, nested
from tol3d.numerics.loops import fill

MIDDLE: Final = 1e-6
"""Fraction of its clearance, below which a place is in the middle of it."""
STIFF: Final = 1e5
"""Stiffness of the deciding places over the scale: each of the last steps leaves about 1e-5 of their residual."""
LAST: Final = 12
"""Last steps at most, 2 or 3 in practice."""
MET: Final = 1e-13
"""Largest residual of deciding places, over the size of their clearances."""
BALANCED: Final = 1e-9
"""Largest imbalance of multipliers."""
UNDECIDED: Final = 1e-14
"""Part of a pivot that is rounding."""
HUGE: Final = 1e200
"""A pivot that nothing moves by."""


@nested
def solved(system: Any, right: Any, size: int) -> None:
    """Solve positive definite equations in place, by L D L'; what they do not decide stays 0."""
    for j in range(size):
        whole = system[j, j]
        for k in range(j):
            system[j, j] -= system[j, k] * system[j, k] * system[k, k]
        if not system[j, j] > UNDECIDED * whole:
            system[j, j] = HUGE
        for i in range(j + 1, size):
            for k in range(j):
                system[i, j] -= system[i, k] * system[j, k] * system[k, k]
            system[i, j] /= system[j, j]
    for i in range(size):
        for k in range(i):
            right[i] -= system[i, k] * right[k]
    for i in range(size - 1, -1, -1):
        right[i] /= system[i, i]
        for k in range(i + 1, size):
            right[i] -= system[k, i] * right[k]


@nested
def equations(trial: Any, state: Any, system: Any, right: Any) -> None:
    """Those of a step (q, s), after which multipliers are back + stiff (u . B q + s)."""
    rows, counts, closed = trial
    y, z, _, stiff, back, pulls = state
    size = rows.shape[2]
    for i in range(size):
        right[i], system[size, i] = 0.0, 0.0
        for j in range(i + 1):
            system[i, j] = closed[i, j]
    right[size], system[size, size] = 1.0, 0.0
    for k in range(rows.shape[0]):
        if not counts[k] or stiff[k] == 0.0:
            continue
        length = np.sqrt(y[k, 0] * y[k, 0] + y[k, 1] * y[k, 1])
        a, b, bend = y[k, 0] / length, y[k, 1] / length, max(z[k], 0.0) / length
        for i in range(size):
            own, across = a * rows[k, 0, i] + b * rows[k, 1, i], bend * (a * rows[k, 1, i] - b * rows[k, 0, i])
            pulls[k, i] = own
            right[i] -= back[k] * own
            own *= stiff[k]
            system[size, i] += own
            for j in range(i + 1):
                system[i, j] += own * pulls[k, j] + across * (a * rows[k, 1, j] - b * rows[k, 0, j])
        right[size] -= back[k]
        system[size, size] += stiff[k]


@nested
def balance(trial: Any, goal: Any, lifts: int, state: Any) -> Any:
    """The largest amount of sum z_k B_k' u_k, less the goal, and of sum z_k - 1 where it lifts."""
    rows, counts, _ = trial
    y, z = state[0], state[1]
    total = -1.0
    for k in range(rows.shape[0]):
        total += z[k] if counts[k] else 0.0
    largest = abs(total) if lifts else 0.0
    for i in range(rows.shape[2]):
        pull = -goal[i]
        for k in range(rows.shape[0]):
            if counts[k]:
                length = np.sqrt(y[k, 0] * y[k, 0] + y[k, 1] * y[k, 1])
                pull += z[k] * (y[k, 0] * rows[k, 0, i] + y[k, 1] * rows[k, 1, i]) / length
        largest = max(largest, abs(pull))
    return largest


@nested
def lengths_of(place: Any, trial: Any, q: Any, s: float, state: Any) -> bool:
    """Offsets and remaining clearances after a step; True if all have a direction."""
    offsets, clearances = place
    rows, counts, _ = trial
    y, w = state[0], state[2]
    for k in range(rows.shape[0]):
        if counts[k]:
            y[k, 0], y[k, 1] = offsets[k, 0], offsets[k, 1]
            for i in range(rows.shape[2]):
                y[k, 0] += rows[k, 0, i] * q[i]
                y[k, 1] += rows[k, 1, i] * q[i]
            length = np.sqrt(y[k, 0] * y[k, 0] + y[k, 1] * y[k, 1])
            w[k] = clearances[k] - s - length
            if not length > MIDDLE * abs(clearances[k] - s):
                return False
    return True


@nested
def finished(
    place: Any, trial: Any, goal: Any, lifts: int, q: Any, s: float, scale: float, state: Any, system: Any, step: Any
) -> bool:
    """True if the optimum is reached: the places that decide, by their multipliers, meet exactly."""
    rows, counts, _ = trial
    _, z, w, stiff, back, pulls = state
    size = rows.shape[2]
    for k in range(rows.shape[0]):
        decides = counts[k] and z[k] * scale > w[k]
        stiff[k] = STIFF / scale if decides else 0.0
        z[k] = z[k] if decides else 0.0
    for _ in range(LAST):
        off = 0.0
        for k in range(rows.shape[0]):
            back[k] = z[k] - stiff[k] * w[k]
            off = max(off, abs(w[k]) if stiff[k] > 0.0 else 0.0)
        if off <= MET * scale and balance(trial, goal, lifts, state) <= BALANCED:
            worst = -1
            for k in range(rows.shape[0]):  # one of the negative multipliers and of the places beyond the others
                if counts[k] and (z[k] < 0.0 or w[k] < -MET * scale):
                    worst = k
            if worst < 0:
                return True
            stiff[worst] = STIFF / scale if stiff[worst] == 0.0 else 0.0
            z[worst] = 0.0
            back[worst] = -stiff[worst] * w[worst]
        equations(trial, state, system, step)
        for i in range(size):
            step[i] += goal[i]
        step[size] *= lifts
        solved(system, step, size + lifts)
        s += step[size]
        for i in range(size):
            q[i] += step[i]
        for k in range(rows.shape[0]):
            if stiff[k] > 0.0:
                z[k] = back[k] + stiff[k] * step[size]
                for i in range(size):
                    z[k] += stiff[k] * pulls[k, i] * step[i]
        if not lengths_of(place, trial, q, s, state):
            return False
    return False


STEPS: Final = 20
"""Newton steps at most, 6 to 10 in practice; trials that need more are left to the slower method."""
UNDER: Final = 0.5, 0.2
"""Start below the feasible slack, over the largest offset; one after the other until one succeeds."""
FALLS: Final = 0.1
"""Most of mu that is left by a step."""
INSIDE: Final = 0.98
"""Least fraction of the distance to the limit of the clearance that a step may go."""
NEAR: Final = 1e-3
"""Gap and imbalance, below which the deciding places are known."""


@nested
def max_step(w: float, length: float, a: float, b: float, up: float, u: float, v: float) -> Any:
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
            ahead = min(ahead, max_step(w[k], length, y[k, 0], y[k, 1], -step[size], u, v))
            back[k] += stiff[k] * along - z[k]
            if back[k] < 0.0:
                behind = min(behind, -z[k] / back[k])
    behind = min(1.0, near * behind)
    for k in range(rows.shape[0]):
        if counts[k]:
            z[k] += behind * back[k]
    return min(1.0, near * ahead)


@nested
def try_solve(place: Any, trial: Any, goal: Any, under: float, q: Any, state: Any, system: Any, step: Any) -> bool:
    """Find the largest slack, q and multipliers in the state, from a feasible one below it, goal 0; True if found."""
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
    """Reach the optimum from q and multipliers near it; True if reached."""
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
        found: flags of trials in which they are found (trials,); on input, of those near the optimum, to be improved.
            Trials not found are left unchanged.
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
                found[n] = try_solve(place, trial, way, under, q, state, system, step)
                if found[n]:
                    break
        if found[n]:
            for i in range(size):
                steps[i, n] = q[i]
            for k in range(places):
                multipliers[k, n] = state[1][k]
