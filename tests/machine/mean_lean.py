"""Mean size of a lean by characteristic functions: exact, without draws and without the program.

A lean is a sum of independent vectors seen along one direction: ends of axes, uniform in discs, and bearings of uniform
length in random directions. E|X| is 2/pi of the integral of (1 - phi(t)) / t².
"""

import math
from collections.abc import Sequence

import numpy as np
from scipy.integrate import quad
from scipy.special import j0, j1

END = 40.0  # sigma; where phi is 0 to all digits


def mean_size(discs: Sequence[tuple[float, float]], rings: Sequence[tuple[float, float, float]]) -> float:
    """E|X| of a sum of vectors along a direction: discs by size and radius, rings by size and limits of length."""
    nodes, weights = np.polynomial.legendre.leggauss(16)
    variance = sum((a * r) ** 2 / 4 for a, r in discs)
    variance += sum(a**2 * (low**2 + low * high + high**2) / 6 for a, low, high in rings)
    sigma = math.sqrt(variance)

    def phi(t: float) -> float:
        found = math.prod(2 * j1(a * r * t) / (a * r * t) if a * r * t > 1e-6 else 1.0 for a, r in discs)
        for a, low, high in rings:
            found *= float(weights @ j0(a * t * ((low + high) + (high - low) * nodes) / 2)) / 2
        return float(found)

    end = END / sigma
    inner = quad(lambda t: (1 - phi(t)) / t**2, 1e-5 / sigma, end, limit=1000, epsrel=1e-10)[0]
    return float(2 / math.pi * (inner + 1e-5 / sigma * variance / 2 + 1 / end))
