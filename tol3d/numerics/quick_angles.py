"""Cosines, sines and azimuths by series, in kernels: a library's calls are most of the time of a short formula."""

import math
from typing import Final

import numpy as np

from tol3d.numerics.compiled import nested, part

PER_QUARTER = 2.0 / math.pi  # quarters of a turn per radian
QUARTER_HIGH, QUARTER_LOW = math.pi / 2.0, 6.123233995736766e-17  # together a quarter of a turn to 1e-33
# coefficients of x^(2k+1) and of x^2k; the first terms left out are 5e-17 and 2e-18 at an eighth of a turn
SINES = tuple((-1.0) ** k / math.factorial(2 * k + 1) for k in range(8))
COSINES = tuple((-1.0) ** k / math.factorial(2 * k) for k in range(9))
LITTLE: Final = 2.0**-5  # rad; the first term that a series leaves out is 2e-17 there
SLIGHT: Final = 2.0**-7  # tangent, of which the series of the arc tangent leaves out 1e-18 of it


@part
def cos_and_sin(angle: float) -> tuple[float, float]:
    """cos and sin of an angle [rad], by series about the nearest quarter of a turn.

    The error is below 4e-16 up to a thousand turns where products are fused with sums, as kernels have them; otherwise
    rounding of the quarters adds 1e-16 per radian.
    """
    quarters = math.floor(angle * PER_QUARTER + 0.5)
    x = (angle - quarters * QUARTER_HIGH) - quarters * QUARTER_LOW
    y = x * x
    sin, cos = SINES[7], COSINES[8]
    for k in range(6, -1, -1):
        sin = sin * y + SINES[k]
    for k in range(7, -1, -1):
        cos = cos * y + COSINES[k]
    sin *= x
    quadrant = int(quarters) & 3
    if quadrant == 0:
        return cos, sin
    if quadrant == 1:
        return -sin, cos
    if quadrant == 2:
        return -cos, -sin
    return sin, -cos


@part
def turned_by(c: float, s: float, turn: float) -> tuple[float, float]:
    """Cosine and sine of an angle turned on; by the series where the turn is little."""
    if abs(turn) < LITTLE:
        t = turn * turn
        cos = 1.0 - t * (1.0 / 2 - t * (1.0 / 24 - t * (1.0 / 720)))
        sin = turn * (1.0 - t * (1.0 / 6 - t * (1.0 / 120 - t * (1.0 / 5040))))
    else:
        cos, sin = np.cos(turn), np.sin(turn)
    return cos * c - sin * s, cos * s + sin * c


@nested
def azimuth(y: float, x: float) -> float:
    """Azimuth of a point; of one near the axis x by the series of the arc tangent."""
    if not abs(y) < SLIGHT * x:
        found: float = np.arctan2(y, x)
        return found
    z = y / x
    t = z * z
    small: float = z * (1.0 - t * (1.0 / 3 - t * (1.0 / 5 - t * (1.0 / 7 - t * (1.0 / 9)))))
    return small
