"""The whole side of a tooth in polar form: how much azimuth the tooth takes at each radius, fillet included."""

import math

import numpy as np

from tol3d.gears.cylindrical_gear import CylindricalGear
from tol3d.gears.flank import RIGHT
from tol3d.numerics.arrays import Array


def tooth_half_angle(gear: CylindricalGear, radius: Array) -> Array:
    """Half the azimuth [rad] that a tooth takes at radii [mm] from its root to its tip, (n,).

    On the involute it is eta_b - inv alpha_R, inside eta_b + inv alpha_R; below the base circle the line is radial; on
    the fillet, of radius rho and with its centre at R_c, it is the centre's azimuth less arccos((R^2 + R_c^2 - rho^2)/
    (2 R R_c)).
    """
    sign = gear.iso_sign
    alpha = np.arccos(np.minimum(gear.base_radius / radius, 1.0))
    flank = gear.base_half_angle - sign * (np.tan(alpha) - alpha)
    fillet = gear.fillet_radius
    x, y = gear.fillet_centre(RIGHT)
    centre, azimuth = math.hypot(x, y), -math.atan2(y, x)
    cosine = (radius**2 + centre**2 - fillet**2) / (2 * radius * centre)
    round_off = azimuth - np.arccos(np.clip(cosine, -1.0, 1.0))
    top = math.hypot(*gear.fillet_top(RIGHT))
    return np.asarray(np.where(sign * (radius - top) < 0.0, round_off, flank))
