"""Convex programmes of cones for a part with play, trial by trial in a kernel: primal and dual interior points.

Steps go along scaled directions, in which each cone and its multiplier look alike (Nesterov, Todd: Self-scaled barriers
and interior-point methods for convex programming).
"""

from typing import Any, Final

import numpy as np

from tol3d.assembly.torsors.quick_centring import solved
from tol3d.numerics.compiled import FULL, kernel, nested
from tol3d.numerics.loops import fill

GAP: Final = 1e-12
"""Final gap over the largest clearance: the slack may be better by so much."""
OWED: Final = 1e-9
"""Fraction of the multipliers' initial imbalance with the goal that may be left."""
MOST_STEPS: Final = 80
TARGET: Final = 0.1
"""Factor of the gap from one step to the next."""
NEAR: Final = 0.98
"""Fraction of the distance to the end of a cone."""
LEAST: Final = 1e-300
"""Square of a point that is inside its cone but for rounding."""


@nested
def square_in(a: float, b: float, c: float) -> Any:
    """Squared distance of a point from the surface of its cone, positive inside."""
    return a * a - b * b - c * c


@nested
def way_in(a: float, b: float, c: float, u: float, v: float, w: float) -> Any:
    """The share of a change (u, v, w) that takes a point (a, b, c) to the end of its cone."""
    inside, slope, bend = square_in(a, b, c), a * u - b * v - c * w, square_in(u, v, w)
    rest = np.sqrt(max(slope * slope - bend * inside, 0.0))
    if bend < 0.0:
        return -(slope + rest) / bend
    return inside / (rest - slope) if slope < 0.0 else np.inf


@nested
def scaled(cones: Any, trial: Any, target: float, state: Any) -> None:
    """The points at which cones and multipliers look alike, their weights, and the pull to the middle."""
    y, z = cones
    _, counts, _ = trial
    points, weights, back = state[0], state[1], state[2]
    for k in range(y.shape[0]):
        if not counts[k]:
            continue
        inside = max(square_in(y[k, 0], y[k, 1], y[k, 2]), LEAST)
        a, b = 1.0 / np.sqrt(inside), 1.0 / np.sqrt(max(square_in(z[k, 0], z[k, 1], z[k, 2]), LEAST))
        joint = (y[k, 0] * z[k, 0] + y[k, 1] * z[k, 1] + y[k, 2] * z[k, 2]) * a * b
        half = 0.5 / np.sqrt(0.5 * (1.0 + joint))
        points[k, 0] = (a * y[k, 0] + b * z[k, 0]) * half
        points[k, 1] = (a * y[k, 1] - b * z[k, 1]) * half
        points[k, 2] = (a * y[k, 2] - b * z[k, 2]) * half
        weights[k], back[k] = a / b, target / inside


@nested
def equations(cones: Any, trial: Any, goal: Any, lifts: int, state: Any, system: Any, step: Any) -> None:
    """Those of a step of the freedoms, and of the slack where it lifts."""
    y = cones[0]
    rows, counts, closed = trial
    points, weights, back, seen = state[0], state[1], state[2], state[3]
    count = rows.shape[2]
    for i in range(count + lifts):
        step[i] = goal[i] if i < count and not lifts else 0.0
        for j in range(i + 1):
            system[i, j] = 0.0
    for k in range(y.shape[0]):
        if not counts[k]:
            continue
        for i in range(count):
            seen[i] = rows[k, 0, i] * points[k, 1] + rows[k, 1, i] * points[k, 2]
            step[i] -= back[k] * (rows[k, 0, i] * y[k, 1] + rows[k, 1, i] * y[k, 2])
            for j in range(i + 1):
                own = 2.0 * seen[i] * seen[j] + (rows[k, 0, i] * rows[k, 0, j] + rows[k, 1, i] * rows[k, 1, j])
                system[i, j] += weights[k] * own
        if lifts:
            step[count] -= back[k] * y[k, 0]
            for j in range(count):
                system[count, j] += weights[k] * (2.0 * points[k, 0] * seen[j])
            system[count, count] += weights[k] * (2.0 * points[k, 0] * points[k, 0] - 1.0)
    if lifts:
        step[count] += 1.0
    stiff = 0.0
    for i in range(count):
        stiff = max(stiff, system[i, i])
    for i in range(count):
        for j in range(i + 1):
            system[i, j] += stiff * closed[i, j]  # else equations of closed places would be rounding


@nested
def changes(cones: Any, trial: Any, lifts: int, step: Any, state: Any) -> Any:
    """Those of cones and multipliers by a step, and the shares of them that stay inside."""
    y, z = cones
    rows, counts, _ = trial
    points, weights, back, _, dy, dz = state
    up, down = np.inf, np.inf
    count = rows.shape[2]
    for k in range(y.shape[0]):
        if not counts[k]:
            continue
        dy[k, 0], dy[k, 1], dy[k, 2] = -step[count] if lifts else 0.0, 0.0, 0.0
        for i in range(count):
            dy[k, 1] += rows[k, 0, i] * step[i]
            dy[k, 2] += rows[k, 1, i] * step[i]
        weight = weights[k]
        along = 2.0 * weight * (points[k, 0] * dy[k, 0] - points[k, 1] * dy[k, 1] - points[k, 2] * dy[k, 2])
        for r in range(3):
            sign = 1.0 if r == 0 else -1.0
            dz[k, r] = back[k] * sign * y[k, r] - z[k, r] - sign * (along * points[k, r] - weight * dy[k, r])
        up = min(up, way_in(y[k, 0], y[k, 1], y[k, 2], dy[k, 0], dy[k, 1], dy[k, 2]))
        down = min(down, way_in(z[k, 0], z[k, 1], z[k, 2], dz[k, 0], dz[k, 1], dz[k, 2]))
    return min(1.0, NEAR * up), min(1.0, NEAR * down)


@nested
def climb(cones: Any, trial: Any, goal: Any, lifts: int, state: Any, system: Any, step: Any, gone: Any) -> None:
    """Change cones, multipliers and how far the freedoms went to those of the optimum of a trial."""
    y, z = cones
    rows, counts, _ = trial
    dy, dz = state[4], state[5]
    scale, owed, used = 0.0, 1.0, 0
    fill(gone, 0.0)
    for k in range(y.shape[0]):
        if counts[k]:
            scale, used = max(scale, y[k, 0]), used + 1
    for _ in range(MOST_STEPS - 1):
        gap = 0.0
        for k in range(y.shape[0]):
            if counts[k]:
                gap += y[k, 0] * z[k, 0] + y[k, 1] * z[k, 1] + y[k, 2] * z[k, 2]
        if gap <= GAP * scale and (lifts or owed <= OWED):
            return
        scaled(cones, trial, TARGET * gap / used, state)
        equations(cones, trial, goal, lifts, state, system, step)
        solved(system, step, rows.shape[2] + lifts)
        for i in range(rows.shape[2] + lifts):
            if not np.isfinite(step[i]):
                return  # the equations are rounding: the gap is as small as it gets
        up, down = changes(cones, trial, lifts, step, state)
        for i in range(rows.shape[2]):
            gone[i] += up * step[i]
        for k in range(y.shape[0]):
            if counts[k]:
                for r in range(3):
                    y[k, r] += up * dy[k, r]
                    z[k, r] += down * dz[k, r]
        owed *= 1.0 - down


@kernel(
    arrays="float64[:,:,::1], float64[:,:,::1], float64[:,:,:,::1], boolean[:,::1], float64[:,:,::1], float64[:,::1], "
    "int64, float64[:,::1], float64[:,::1]",
    level=FULL,
)
def climbed(
    primal: Any, dual: Any, rows: Any, counts: Any, closed: Any, goal: Any, lifts: Any, steps: Any, multipliers: Any
) -> None:
    """Steps of the freedoms to the largest slack, or as far along a goal as the cones allow.

    Args:
        primal, dual: cones at the start and multipliers, inside (places, 3, trials).
        rows: (places, 2, freedoms, trials).
        counts: which places do (places, trials).
        closed: projectors to what is not open, where nothing moves (freedoms, freedoms, trials).
        goal: what is to be largest where the slack is not (freedoms, trials).
        lifts: 1 if the slack is, else 0.
        steps: (freedoms, trials) [mm].
        multipliers: of the places (places, trials); 0 where one does not count.
    """
    places, size = rows.shape[0], rows.shape[2]
    cones = np.empty((places, 3)), np.empty((places, 3))
    turned, used, shut = np.empty((places, 2, size)), np.empty(places, dtype=np.bool_), np.empty((size, size))
    state = (
        np.empty((places, 3)), np.empty(places), np.empty(places), np.empty(size), np.empty((places, 3)),
        np.empty((places, 3)),
    )  # fmt: skip
    system, step, gone, way = np.empty((size + 1, size + 1)), np.empty(size + 1), np.empty(size), np.empty(size)
    for n in range(primal.shape[2]):
        for k in range(places):
            used[k] = counts[k, n]
            for r in range(3):
                cones[0][k, r], cones[1][k, r] = primal[k, r, n], dual[k, r, n]
            for r in range(2):
                for i in range(size):
                    turned[k, r, i] = rows[k, r, i, n]
        for i in range(size):
            way[i] = goal[i, n]
            for j in range(size):
                shut[i, j] = closed[i, j, n]
        climb(cones, (turned, used, shut), way, lifts, state, system, step, gone)
        for i in range(size):
            steps[i, n] = gone[i]
        for k in range(places):
            multipliers[k, n] = cones[1][k, 0] if used[k] else 0.0
