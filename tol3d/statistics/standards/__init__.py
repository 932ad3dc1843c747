"""Limits that standards of drawings give to sizes: letters and numbers in, micrometres or millimetres out."""

import math
from typing import Final

HALF_XTOL: Final = 1e-9  # steps; formulae of round lengths err by 1e-13, and miss a half by 1e-6 or more where they do


def half_up(value: float, step: float) -> float:
    """The nearest multiple of a step; halves go up, also where rounding of the formula leaves them just below.

    >>> half_up(5.25, 0.5), half_up((0.55 * 10 + 5) * math.sqrt(2.0) ** -2, 0.5), half_up(5.2499, 0.5)
    (5.5, 5.5, 5.0)
    """
    return math.floor(value / step + 0.5 + HALF_XTOL) * step
