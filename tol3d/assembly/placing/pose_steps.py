"""Steps of poses, in kernels."""

from typing import Any

from tol3d.numerics.compiled import nested


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
