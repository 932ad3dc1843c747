"""How the largest common slack of a part with play ends, in a kernel: places that decide meet exactly, and balance.

Newton's steps on the conditions of the optimum, in q, s and one multiplier z_k of each place that decides (the farthest
way along a goal ends alike, without s and the first of them, with the goal in place of the second's 0):

    sum z_k = 1,    sum z_k B_k' u_k = 0,    w_k = c_k - s - |y_k| = 0,    y_k = b_k + B_k q,    u_k = y_k / |y_k|.

A place with a multiplier below 0 is let go, one that is beyond the others is taken in; what is reached has neither.
"""

from typing import Any, Final

import numpy as np

from tol3d.numerics.compiled import nested

MIDDLE: Final = 1e-6
"""Share of its clearance, under which a place is in the middle of it."""
STIFF: Final = 1e5
"""Of the places that decide, as the scale goes: each of the last steps leaves about 1e-5 of what they are off."""
LAST: Final = 12
"""Of the last steps, 2 or 3 in practice."""
MET: Final = 1e-13
"""What places that decide may be apart, of the size of their clearances."""
BALANCED: Final = 1e-9
"""What multipliers may lack of balance."""
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
    """Offsets and what is left of the clearances after a step; whether all have a direction."""
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
    """Whether the optimum is reached where the places that decide, by their multipliers, meet exactly."""
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
            for k in range(rows.shape[0]):  # of multipliers under 0 and of places beyond the others, one
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
