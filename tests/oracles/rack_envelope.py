"""A gear's flank as a rack cuts it: the rack rolls on the reference circle and takes away what it passes over.

Gear frame: x through the middle of tooth 0; the flank here is the one on the high-azimuth side. The rack has
straight flanks at the pressure angle, a space of pi m/2 on its reference line, which lies x m outside the
reference circle, and sharp corners at the depth `addendum` m below that line (infinite: no corner).
"""

import math
from dataclasses import dataclass

import numpy as np

from oracles.brute_force import zoomed_minimum

GRID = (201, 9)  # points, zooms: 100^9 times finer than the range, down to the spacing of doubles
CUT_AWAY = 1e-10  # rad; a flank this far inside the endless rack's has been undercut
RADIUS_XTOL = 1e-9  # mm


@dataclass(frozen=True)
class Rack:
    """Plain numbers of the rack and of the gear that it cuts."""

    teeth: int
    module: float
    pressure_angle: float
    profile_shift: float
    addendum: float = math.inf

    @property
    def reference_radius(self) -> float:
        return self.module * self.teeth / 2

    def flank_azimuth(self, radius: float) -> float:
        """Azimuth [rad] of the flank that is left at a radius.

        When the rack's flank passes the gear's point (radius, phi) at the world azimuth psi, the gear has
        turned by u = psi - phi and the rack moved by r u, so that phi = psi - (R sin(psi + alpha)/cos(alpha) - K)/r
        with K = pi m/4 + (r + x m) tan(alpha). The smallest of them is left, over all psi that the rack reaches.
        """
        alpha, r = self.pressure_angle, self.reference_radius
        constant = math.pi * self.module / 4 + (r + self.profile_shift * self.module) * math.tan(alpha)

        def cut_azimuth(psi: np.ndarray) -> np.ndarray:
            return psi - (radius * np.sin(psi + alpha) / math.cos(alpha) - constant) / r

        if math.isinf(self.addendum):
            low, high = -alpha, math.pi / 2 - alpha
        else:
            corner = r + (self.profile_shift - self.addendum) * self.module
            high = math.acos(min(1.0, corner / radius))
            low = -high
        return float(zoomed_minimum(cut_azimuth, np.array([low]), np.array([high]), GRID)[0])

    def undercut_radius(self, tip_radius: float) -> float:
        """Largest radius [mm] at which the corner has cut below the flank that an endless rack would leave."""
        endless = Rack(self.teeth, self.module, self.pressure_angle, self.profile_shift)
        low, high = self.reference_radius * math.cos(self.pressure_angle), tip_radius
        while high - low > RADIUS_XTOL:
            middle = (low + high) / 2
            cut = self.flank_azimuth(middle) < endless.flank_azimuth(middle) - CUT_AWAY
            low, high = (middle, high) if cut else (low, middle)
        return low
