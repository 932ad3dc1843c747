"""The standard normal law: density, distribution function and its inverse.

`import scipy` is cheap (0.03 s); `scipy.special` (0.2 s) loads itself at its first use, so that
reading and checking a scene does without it.
"""

import math

import scipy

from tol3d.numerics.arrays import Array


def density(z: float) -> float:
    """phi(z) = exp(-z^2 / 2) / sqrt(2 pi)."""
    return math.exp(-z * z / 2) / math.sqrt(2 * math.pi)


def probability_below(z: float) -> float:
    """Phi(z) = erfc(-z / sqrt 2) / 2 of one number.

    >>> probability_below(0.0)
    0.5
    """
    return math.erfc(-z / math.sqrt(2)) / 2


def cdf(z: Array) -> Array:
    """Phi(z), elementwise."""
    probability: Array = scipy.special.ndtr(z)
    return probability


def ppf(u: Array) -> Array:
    """The inverse of Phi, elementwise, for u in (0, 1)."""
    z: Array = scipy.special.ndtri(u)
    return z
