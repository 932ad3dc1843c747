"""Closed forms of what springs do: cumulants of independent terms add up.

Of a z + b z^2 with z normal of sigma s: k1 = b s^2, k2 = a^2 s^2 + 2 b^2 s^4, k3 = 6 a^2 b s^4 + 8 b^3 s^6,
k4 = 48 a^2 b^2 s^6 + 48 b^4 s^8; of a uniform of half width h: k2 = h^2/3, k4 = -2 h^4/15.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class Cumulants:
    """The first four [um^n]."""

    k1: float
    k2: float
    k3: float = 0.0
    k4: float = 0.0

    def __add__(self, other: "Cumulants") -> "Cumulants":
        return Cumulants(self.k1 + other.k1, self.k2 + other.k2, self.k3 + other.k3, self.k4 + other.k4)

    @property
    def sigma(self) -> float:
        return float(self.k2**0.5)

    @property
    def skewness(self) -> float:
        return float(self.k3 / self.k2**1.5)

    @property
    def excess_kurtosis(self) -> float:
        return float(self.k4 / self.k2**2)


def parabola(a: float, b: float, s: float) -> Cumulants:
    """Cumulants of a z + b z^2 with z normal of sigma s."""
    return Cumulants(
        b * s**2,
        a**2 * s**2 + 2 * b**2 * s**4,
        6 * a**2 * b * s**4 + 8 * b**3 * s**6,
        48 * a**2 * b**2 * s**6 + 48 * b**4 * s**8,
    )


def uniform(half: float) -> Cumulants:
    """Cumulants of a uniform from -half to half."""
    return Cumulants(0.0, half**2 / 3, 0.0, -2 * half**4 / 15)
