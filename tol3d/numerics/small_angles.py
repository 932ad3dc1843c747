"""Cosines, sines and arc tangents of mostly small angles, in kernels: by series, in a fifth of the time."""

from typing import Final

import numpy as np

from tol3d.numerics.compiled import nested, part

LITTLE: Final = 2.0**-5  # rad; the first term that a series leaves out is 2e-17 there
SLIGHT: Final = 2.0**-7  # tangent, of which the series of the arc tangent leaves out 1e-18 of it


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
