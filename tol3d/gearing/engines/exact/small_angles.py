"""Sines of small angles by their series, where a call of the library would be most of the work."""

import math

from tol3d.numerics.compiled import part

SMALL = 0.02  # rad; below it the series are exact to 1e-15 of themselves


@part
def sine(angle: float) -> float:
    """sin(angle)."""
    if abs(angle) > SMALL:
        return math.sin(angle)
    square = angle * angle
    return angle * (1.0 - square / 6.0 * (1.0 - square / 20.0 * (1.0 - square / 42.0)))


@part
def arcsine(value: float) -> float:
    """Its inverse."""
    if abs(value) > SMALL:
        return math.asin(value)
    square = value * value
    return value * (1.0 + square * (1.0 / 6.0 + square * (0.075 + square * (15.0 / 336.0 + square * (105.0 / 3456.0)))))


@part
def turned(x: float, y: float, angle: float) -> tuple[float, float]:
    """A vector across an axis, turned about it by less than a right angle."""
    sin = sine(angle)
    cos = math.sqrt(1.0 - sin * sin)
    return cos * x - sin * y, sin * x + cos * y
