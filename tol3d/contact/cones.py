"""Convex programmes over second-order cones with a few unknowns, in kernels: interior points.

Cones are y_k = (c_k - s, o_k + B_k p), inside where |o_k + B_k p| < c_k - s. Primal and dual steps go along Nesterov
and Todd's directions (Andersen, Dahl, Vandenberghe: CVXOPT's coneprog): W is the scaling with W z = W^-1 y. As soon as
the cones that decide the largest s are known, Newton steps finish: these cones meet exactly, and their multipliers
balance. A cone whose dual lies inside its cone is met at its apex, where o_k + B_k p = 0 and c_k = s.
"""

from typing import Any, Final

import numpy as np

from tol3d.numerics.compiled import nested
from tol3d.numerics.loops import fill

STEPS: Final = 60
"""Interior-point steps at most, 8 to 15 in practice."""
GAP: Final = 1e-12
"""Final gap over the size of offsets and clearances: the slack may be better by so much."""
AIM: Final = 0.1
"""Factor of the gap from one step to the next."""
CAREFUL_STEPS: Final = 200
"""Interior-point steps at most that keep to the middle."""
CAREFUL_AIM: Final = 0.8
"""Factor of the gap after a step cut short by more than half, for steps that keep to the middle."""
SHORT_OF: Final = 0.98
"""Fraction of the distance to the end of a cone."""
OWED: Final = 1e-9
"""Fraction of the multipliers' initial imbalance that may be left."""
ROUNDING: Final = 1e-14
"""Fraction of a pivot left by rounding."""
SHOWN: Final = 1e-3, 1e-6, 1e-10
"""Gaps, over the size of offsets and clearances, at which the deciding cones may be known."""
LOOSE: Final = 1e-12
"""Fraction of the stiffness of deciding cones that counts as none: of freedoms that change offsets by 1e-6 or less."""
LAST: Final = 10
"""Newton steps at most, 2 to 4 in practice."""
STIFF: Final = 1e5
"""Stiffness of deciding cones over their curvature; 1e-6 of their residual is left by each."""
MET: Final = 1e-13
"""Largest residual of deciding cones, over the size of offsets and clearances."""
BALANCED: Final = 1e-9
"""Largest imbalance of multipliers that sum to 1."""
POINTED: Final = 1e-6
"""Length of an offset over its clearance, below which it has no direction."""
APEX: Final = 0.98
"""Square of a dual's direction over its first component's, below which a cone that decides is met at its apex."""


@nested
def factored(matrix: Any, count: int, least: float) -> None:
    """Cholesky's factors of a matrix without negative eigenvalues, in place.

    Freedoms are not moved by of which rounding of 0 is left, or no more than `least`.
    """
    for j in range(count):
        whole = matrix[j, j]
        for k in range(j):
            matrix[j, j] -= matrix[j, k] * matrix[j, k]
        matrix[j, j] = np.sqrt(matrix[j, j]) if matrix[j, j] > max(ROUNDING * whole, least) else np.inf
        for i in range(j + 1, count):
            for k in range(j):
                matrix[i, j] -= matrix[i, k] * matrix[j, k]
            matrix[i, j] /= matrix[j, j]


@nested
def substituted(matrix: Any, right: Any, count: int) -> None:
    """Solve with Cholesky's factors, in place."""
    for i in range(count):
        for k in range(i):
            right[i] -= matrix[i, k] * right[k]
        right[i] /= matrix[i, i]
    for i in range(count - 1, -1, -1):
        for k in range(i + 1, count):
            right[i] -= matrix[k, i] * right[k]
        right[i] /= matrix[i, i]


@nested
def reach_of(a: float, b: float, c: float, u: float, v: float, w: float) -> Any:
    """The largest fraction of (u, v, w) that a point (a, b, c) of a cone can go."""
    square, slope = a * a - b * b - c * c, a * u - b * v - c * w
    bend = u * u - v * v - w * w
    # square + 2 slope t + bend t^2 = 0 and a + u t > 0
    rest = slope * slope - bend * square
    if bend < 0.0:
        return (-slope - np.sqrt(max(rest, 0.0))) / bend
    if slope < 0.0 and rest > 0.0:
        return square / (-slope + np.sqrt(rest))
    return 1e30 if u >= 0.0 else -a / u


@nested
def equations(cones: Any, size: int, lifts: int, matrix: Any, right: Any, aim: float, turned: Any) -> bool:
    """Those of a step, without the goal: G' W^-2 G and -aim G' y^-1; whether y and z lie inside."""
    y, z, rows, used = cones
    unknowns = size + lifts
    for r in range(unknowns):
        right[r] = 0.0
        for s in range(r + 1):
            matrix[r, s] = 0.0
    for k in range(y.shape[0]):
        if not used[k]:
            continue
        first = y[k, 0] * y[k, 0] - y[k, 1] * y[k, 1] - y[k, 2] * y[k, 2]
        second = z[k, 0] * z[k, 0] - z[k, 1] * z[k, 1] - z[k, 2] * z[k, 2]
        if not (first > 0.0 and second > 0.0):
            return False
        a, b = 1.0 / np.sqrt(first), 1.0 / np.sqrt(second)
        both = (y[k, 0] * z[k, 0] + y[k, 1] * z[k, 1] + y[k, 2] * z[k, 2]) * a * b
        half = 0.5 / np.sqrt(0.5 * (1.0 + both))
        w0 = half * (a * y[k, 0] + b * z[k, 0])
        w1 = half * (a * y[k, 1] - b * z[k, 1])
        w2 = half * (a * y[k, 2] - b * z[k, 2])
        weight = a / b  # 1 / beta^2
        back = aim / first
        for r in range(size):
            turned[r] = rows[k, 0, r] * w1 + rows[k, 1, r] * w2
            right[r] -= back * (rows[k, 0, r] * y[k, 1] + rows[k, 1, r] * y[k, 2])
        if lifts:
            turned[size] = w0
            right[size] -= back * y[k, 0]
            matrix[size, size] -= weight
        for r in range(unknowns):
            for s in range(r + 1):
                matrix[r, s] += 2.0 * weight * turned[r] * turned[s]
        for r in range(size):
            for s in range(r + 1):
                matrix[r, s] += weight * (rows[k, 0, r] * rows[k, 0, s] + rows[k, 1, r] * rows[k, 1, s])
    return True


@nested
def changes_of(cones: Any, size: int, lifts: int, step: Any, aim: float, dy: Any, dz: Any) -> Any:
    """Changes of cones and multipliers that go with a step, and how far each can go."""
    y, z, rows, used = cones
    ahead, behind = 1e30, 1e30
    for k in range(y.shape[0]):
        if not used[k]:
            continue
        d0, d1, d2 = 0.0, 0.0, 0.0
        if lifts:
            d0 = -step[size]
        for r in range(size):
            d1 += rows[k, 0, r] * step[r]
            d2 += rows[k, 1, r] * step[r]
        dy[k, 0], dy[k, 1], dy[k, 2] = d0, d1, d2
        first = y[k, 0] * y[k, 0] - y[k, 1] * y[k, 1] - y[k, 2] * y[k, 2]
        second = z[k, 0] * z[k, 0] - z[k, 1] * z[k, 1] - z[k, 2] * z[k, 2]
        a, b = 1.0 / np.sqrt(first), 1.0 / np.sqrt(second)
        both = (y[k, 0] * z[k, 0] + y[k, 1] * z[k, 1] + y[k, 2] * z[k, 2]) * a * b
        half = 0.5 / np.sqrt(0.5 * (1.0 + both))
        w0 = half * (a * y[k, 0] + b * z[k, 0])
        w1 = half * (a * y[k, 1] - b * z[k, 1])
        w2 = half * (a * y[k, 2] - b * z[k, 2])
        weight, back = a / b, aim / first
        along = 2.0 * weight * (w0 * d0 - w1 * d1 - w2 * d2)
        # W^-2 d with (w0, -w1, -w2), of which -J takes (d0, d1, d2) to (-d0, d1, d2)
        dz[k, 0] = back * y[k, 0] - z[k, 0] - (along * w0 - weight * d0)
        dz[k, 1] = -back * y[k, 1] - z[k, 1] - (-along * w1 + weight * d1)
        dz[k, 2] = -back * y[k, 2] - z[k, 2] - (-along * w2 + weight * d2)
        ahead = min(ahead, reach_of(y[k, 0], y[k, 1], y[k, 2], d0, d1, d2))
        behind = min(behind, reach_of(z[k, 0], z[k, 1], z[k, 2], dz[k, 0], dz[k, 1], dz[k, 2]))
    return min(1.0, SHORT_OF * ahead), min(1.0, SHORT_OF * behind)


@nested
def closing(cones: Any, size: int, lifts: int, goal: Any, rooms: Any) -> Any:
    """Equations of Newton's step from `at` (y), with multipliers m; how far cones that decide are apart, and balance.

    Each of them gives m + stiff (u . B p + s + w) at the end of the step; at an apex m + stiff (s + c) and, for the
    offset, v + stiff (o + B p). Negative where an offset has no direction, but its dual has.
    """
    _, _, rows, used = cones
    matrix, step, at, own, turned, _ = rooms
    for r in range(size + 1):
        step[r] = 0.0
        turned[r] = 0.0
        for s in range(r + 1):
            matrix[r, s] = 0.0
    turned[size], apart, balance = 1.0, 0.0, 0.0
    if not lifts:
        for r in range(size):
            turned[r] = goal[r]
    for k in range(at.shape[0]):
        if not used[k] or own[k, 1] == 0.0:
            continue
        length = np.sqrt(at[k, 1] * at[k, 1] + at[k, 2] * at[k, 2])
        m, stiff, w = own[k, 0], own[k, 1], at[k, 0] - length
        if own[k, 2] > 0.0:
            w, apart = at[k, 0], max(apart, abs(at[k, 0]) + length)
            for c in range(2):
                for r in range(size):
                    turned[r] -= own[k, 3 + c] * rows[k, c, r]
                    step[r] -= stiff * at[k, 1 + c] * rows[k, c, r]
                    for s in range(r + 1):
                        matrix[r, s] += stiff * rows[k, c, r] * rows[k, c, s]
        elif length > POINTED * at[k, 0]:
            u, v, apart = at[k, 1] / length, at[k, 2] / length, max(apart, abs(w))
            for r in range(size):
                along, across = u * rows[k, 0, r] + v * rows[k, 1, r], u * rows[k, 1, r] - v * rows[k, 0, r]
                turned[r] -= m * along
                step[r] += stiff * w * along
                matrix[size, r] += stiff * along
                for s in range(r + 1):
                    matrix[r, s] += stiff * along * (u * rows[k, 0, s] + v * rows[k, 1, s])
                    matrix[r, s] += max(m, 0.0) / length * across * (u * rows[k, 1, s] - v * rows[k, 0, s])
        else:
            return -1.0, 1.0
        turned[size] -= m
        step[size] += stiff * w
        matrix[size, size] += stiff
    for r in range(size + lifts):
        balance = max(balance, abs(turned[r]))
        step[r] += turned[r]
    step[size] *= lifts
    return apart, balance


@nested
def stepped(cones: Any, size: int, rooms: Any) -> None:
    """Go Newton's whole step."""
    _, _, rows, used = cones
    _, step, at, own, _, gone = rooms
    for r in range(size + 1):
        gone[r] += step[r]
    for k in range(at.shape[0]):
        if not used[k]:
            continue
        a, b = 0.0, 0.0
        for r in range(size):
            a += rows[k, 0, r] * step[r]
            b += rows[k, 1, r] * step[r]
        if own[k, 2] > 0.0:
            own[k, 0] += own[k, 1] * (step[size] - at[k, 0])
            own[k, 3] += own[k, 1] * (at[k, 1] + a)
            own[k, 4] += own[k, 1] * (at[k, 2] + b)
        elif own[k, 1] > 0.0:
            length = np.sqrt(at[k, 1] * at[k, 1] + at[k, 2] * at[k, 2])
            along = (at[k, 1] * a + at[k, 2] * b) / length
            own[k, 0] += own[k, 1] * (along + step[size] - at[k, 0] + length)
        at[k, 0] -= step[size]
        at[k, 1] += a
        at[k, 2] += b


@nested
def amiss(cones: Any, rooms: Any, limit: float) -> int:
    """A cone beyond those that decide, or one that decides with a negative multiplier; -1 if there is none."""
    used = cones[3]
    at, own = rooms[2], rooms[3]
    for k in range(at.shape[0]):
        if used[k]:
            length = np.sqrt(at[k, 1] * at[k, 1] + at[k, 2] * at[k, 2])
            sideways = np.sqrt(own[k, 3] * own[k, 3] + own[k, 4] * own[k, 4]) if own[k, 2] > 0.0 else 0.0
            if own[k, 0] < sideways or at[k, 0] - length < -limit:
                return k
    return -1


@nested
def ended(cones: Any, size: int, lifts: int, goal: Any, scale: float, weight: float, found: Any, rooms: Any) -> bool:
    """Reach the optimum by Newton steps; True if all its conditions hold, otherwise nothing is changed.

    Args:
        cones: as in `climbed`; the duals are changed to z = m (1, -u), u along the offset.
        size, lifts, goal: as in `climbed`.
        scale: of offsets and clearances.
        weight: of the multipliers.
        found: changed by the step.
        rooms: work arrays; the fourth has the first multipliers (cones, 5): m, 0 for cones that do not decide, two
            others, and the v of those that are met at their apex.
    """
    y, z, _, used = cones
    matrix, step, at, own, _, gone = rooms
    fill(gone, 0.0)
    for k in range(y.shape[0]):
        at[k, 0], at[k, 1], at[k, 2] = y[k, 0], y[k, 1], y[k, 2]
        own[k, 1] = weight * STIFF / scale if own[k, 0] > 0.0 else 0.0
        sideways = own[k, 3] * own[k, 3] + own[k, 4] * own[k, 4]
        own[k, 2] = lifts if sideways < APEX * own[k, 0] * own[k, 0] else 0.0
    for _ in range(LAST):
        apart, balance = closing(cones, size, lifts, goal, rooms)
        if apart < 0.0:
            return False
        if apart <= MET * scale and balance <= BALANCED * weight:
            wrong = amiss(cones, rooms, MET * scale)
            if wrong < 0:
                for k in range(y.shape[0]):
                    m = own[k, 0] if used[k] else 0.0
                    share = m / np.sqrt(at[k, 1] * at[k, 1] + at[k, 2] * at[k, 2]) if m > 0.0 else 0.0
                    z[k, 0], z[k, 1], z[k, 2] = m, -share * at[k, 1], -share * at[k, 2]
                    if m > 0.0 and own[k, 2] > 0.0:
                        z[k, 1], z[k, 2] = -own[k, 3], -own[k, 4]
                for r in range(size + 1):
                    found[r] += gone[r]
                return True
            own[wrong, 0], own[wrong, 1] = 0.0, weight * STIFF / scale if own[wrong, 1] == 0.0 else 0.0
            apart, balance = closing(cones, size, lifts, goal, rooms)
        factored(matrix, size + lifts, LOOSE * weight * STIFF / scale)
        substituted(matrix, step, size + lifts)
        stepped(cones, size, rooms)
    return False


@nested
def climbed(cones: Any, size: int, lifts: int, careful: bool, goal: Any, found: Any, rooms: Any) -> bool:
    """Find a programme's optimum, the largest goal . p, or s if it lifts; True if found.

    Args:
        cones: y at p = 0 and multipliers z, both inside (cones, 3), changed; B_k (cones, 2, size); which of them count.
        size: of p.
        lifts: 1 for the largest s, 0 for the largest goal.
        careful: True to keep steps to the middle, where tied cones would cut them short.
        goal: (size,).
        found: p and s, as changes (size + 1,).
        rooms: work arrays.
    """
    y, z, _, used = cones
    matrix, step, dy, dz, turned, _ = rooms
    count, scale, owed, tries, share, weight = 0, 0.0, 1.0, 0, AIM, float(lifts)
    for k in range(y.shape[0]):
        if used[k]:
            count += 1
            scale = max(scale, y[k, 0])
    if not lifts:
        for r in range(size):
            weight = max(weight, abs(goal[r]))
    fill(found, 0.0)
    for _ in range(CAREFUL_STEPS if careful else STEPS):
        gap = 0.0
        for k in range(y.shape[0]):
            if used[k]:
                gap += y[k, 0] * z[k, 0] + y[k, 1] * z[k, 1] + y[k, 2] * z[k, 2]
        if gap <= GAP * scale and owed <= OWED:
            return True
        if tries < len(SHOWN) and gap <= SHOWN[tries] * scale * weight:
            tries += 1
            for k in range(y.shape[0]):
                length = np.sqrt(y[k, 1] * y[k, 1] + y[k, 2] * y[k, 2])
                dz[k, 0] = z[k, 0] if used[k] and z[k, 0] * scale > (y[k, 0] - length) * weight else 0.0
                dz[k, 3], dz[k, 4] = -z[k, 1], -z[k, 2]
            if ended(cones, size, lifts, goal, scale, weight, found, rooms):
                return True
        aim = share * gap / count
        if not equations(cones, size, lifts, matrix, step, aim, turned):
            return gap <= 1e3 * GAP * scale
        if lifts:
            step[size] += 1.0
        else:
            for r in range(size):
                step[r] += goal[r]
        factored(matrix, size + lifts, 0.0)
        substituted(matrix, step, size + lifts)
        ahead, behind = changes_of(cones, size, lifts, step, aim, dy, dz)
        owed *= 1.0 - behind
        share = CAREFUL_AIM if careful and min(ahead, behind) < 0.5 else AIM
        for r in range(size + lifts):
            found[r] += ahead * step[r]
        for k in range(y.shape[0]):
            if used[k]:
                for r in range(3):
                    y[k, r] += ahead * dy[k, r]
                    z[k, r] += behind * dz[k, r]
    return False
