"""Steps of poses and small systems of equations, in kernels."""

from typing import Any, Final

import numpy as np

from tol3d.numerics.compiled import nested

NO_PIVOT: Final = 1e-12
"""Pivot of equations with coefficients of about 1, below which they are singular."""


@nested
def turned_by(pose: Any, a: float, b: float, c: float) -> None:
    """Turn the rotation of a pose (3, 4) further, about (a, b, c) by 2 atan(|(a, b, c)| / 2): Cayley's formula."""
    a, b, c = a / 2, b / 2, c / 2
    share = 2.0 / (1.0 + a * a + b * b + c * c)
    for k in range(3):
        x, y, z = pose[0, k], pose[1, k], pose[2, k]
        u, v, w = b * z - c * y, c * x - a * z, a * y - b * x
        pose[0, k] = x + share * (u + b * w - c * v)
        pose[1, k] = y + share * (v + c * u - a * w)
        pose[2, k] = z + share * (w + a * v - b * u)


@nested
def stepped(pose: Any, step: Any, reach: float) -> Any:
    """Move a pose by a step (6,), turn times reach and shift; returns its length, a turn [rad] or a shift per reach."""
    turned_by(pose, step[0] / reach, step[1] / reach, step[2] / reach)
    length = 0.0
    for r in range(3):
        pose[r, 3] += step[3 + r]
        length = max(length, abs(step[r]) / reach, abs(step[3 + r]) / reach)
    return length


@nested
def solved(matrix: Any, right: Any, count: int) -> bool:
    """Solve count equations in place by elimination with pivots; False if they are singular."""
    for k in range(count):
        best = k
        for i in range(k + 1, count):
            if abs(matrix[i, k]) > abs(matrix[best, k]):
                best = i
        if best != k:
            for j in range(k, count):
                matrix[k, j], matrix[best, j] = matrix[best, j], matrix[k, j]
            right[k], right[best] = right[best], right[k]
        pivot = matrix[k, k]
        if not abs(pivot) > NO_PIVOT:
            return False
        for i in range(k + 1, count):
            factor = matrix[i, k] / pivot
            for j in range(k + 1, count):
                matrix[i, j] -= factor * matrix[k, j]
            right[i] -= factor * right[k]
    for k in range(count - 1, -1, -1):
        total = right[k]
        for j in range(k + 1, count):
            total -= matrix[k, j] * right[j]
        right[k] = total / matrix[k, k]
    return bool(np.isfinite(right[0]))
