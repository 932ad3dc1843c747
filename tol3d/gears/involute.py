"""The involute function and its inverse.

Source: ISO 21771-1:2024, 5.2 (inv alpha = tan alpha - alpha). Angles in rad.
"""

import math

NEWTON_STEPS = 60  # far more than the cube-root start needs (under 10); a guard, not a tuning
ANGLE_XTOL = 1e-16  # rad; below the spacing of doubles near any pressure angle


def involute(angle: float) -> float:
    """inv alpha = tan alpha - alpha [rad], for 0 <= alpha < pi/2.

    Below 0.05 rad the difference cancels digits, so the series is summed instead.

    >>> round(involute(math.radians(20)), 9)
    0.014904384
    """
    if abs(angle) < 0.05:
        square = angle * angle
        return angle * square * (1 / 3 + square * (2 / 15 + square * (17 / 315 + square * (62 / 2835))))
    return math.tan(angle) - angle


def inverse_involute(value: float) -> float:
    """The angle alpha [rad] in 0 <= alpha < pi/2 with inv alpha = value.

    Newton on tan alpha - alpha - value, d/dalpha = tan^2 alpha, from a start that lies above the
    root: the function is convex there, so every step lands above it too and none overshoots.

    Raises:
        ValueError: value is negative; no angle has a negative involute.

    >>> round(math.degrees(inverse_involute(0.014904383867336446)), 9)
    20.0
    """
    if value < 0.0:
        raise ValueError(f"inverse_involute: expected a value of at least 0, got {value}")
    if value == 0.0:
        return 0.0
    angle = min(math.cbrt(3.0 * value), math.atan(value + math.pi / 2))
    for _ in range(NEWTON_STEPS):
        step = (involute(angle) - value) / math.tan(angle) ** 2
        angle -= step
        if abs(step) <= ANGLE_XTOL + 4e-16 * angle:
            break
    return angle
