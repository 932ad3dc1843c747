"""Internal clearance of rolling bearings, of which one draw is what the bearing leaves across its axis and along it.

Radial clearance is the whole way of the inner ring across the axis, axial clearance the whole way along it, each while
the other is in its middle and nothing loads the bearing.
"""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from tol3d.numerics.arrays import Array


@dataclass(frozen=True)
class ObliqueContact:
    """Angular contact balls or tapered rollers: G_r = G_a tan(alpha), alpha the contact angle [rad].

    A ring that moves by r across and by a along the axis closes r cos(alpha) + a sin(alpha) of a row's gap.
    """

    angle: float
    words: ClassVar[str] = "axial clearance"

    def axial(self, radial: Array) -> Array:
        """Axial clearances of radial ones [mm]."""
        return radial / math.tan(self.angle)

    def slope(self, radial: Array) -> Array:
        """Its derivative."""
        return np.full_like(radial, 1 / math.tan(self.angle))

    def deviation(self, measured: Array) -> Array:
        """See Scale: radial clearances of axial ones [mm]."""
        return measured * math.tan(self.angle)

    def measured(self, deviation: Array) -> Array:
        """See Scale."""
        return self.axial(deviation)


@dataclass(frozen=True)
class DeepGroove:
    """Balls in grooves whose centres of curvature lie `apart` [mm] where both touch: r_i + r_o - D_w.

    Centred, they lie apart - G_r/2 across the axis, and G_a/2 along it when the ball touches both:
    G_a = 2 sqrt(apart² - (apart - G_r/2)²). Clearances below 0 leave no axial one.
    """

    apart: float
    words: ClassVar[str] = "axial clearance"

    def axial(self, radial: Array) -> Array:
        """Axial clearances of radial ones [mm]."""
        return np.sqrt(np.maximum(radial * (4 * self.apart - radial), 0.0))

    def slope(self, radial: Array) -> Array:
        """Its derivative; 0 where there is no clearance."""
        axial = self.axial(radial)
        rate = 4 * self.apart - 2 * radial
        return np.divide(rate, 2 * axial, out=np.zeros_like(axial), where=axial > 0.0)

    def deviation(self, measured: Array) -> Array:
        """See Scale: radial clearances of axial ones [mm]; an axial one below 0 is a radial one below 0."""
        half = np.minimum(np.abs(measured) / 2, self.apart)
        return np.asarray(np.sign(measured) * 2 * half**2 / (self.apart + np.sqrt(self.apart**2 - half**2)))

    def measured(self, deviation: Array) -> Array:
        """See Scale."""
        return np.sign(deviation) * self.axial(np.abs(deviation))


Raceways = ObliqueContact | DeepGroove
"""A bearing whose one clearance shows both across its axis and along it."""
