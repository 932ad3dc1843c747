"""Undercut: the part of the involute that the generating rack or crown rack cuts away, below its pitch line.

The corner at the end of the rack's straight flank sweeps through the flank that the rack has made; both curves cross
once between base and tip. The crossing is bisected.
"""

import math
from collections.abc import Callable
from typing import Final

from tol3d.gears.involute import involute
from tol3d.gears.spherical_involute import involute_azimuth

RACK_ADDENDUM: Final = 1.0  # of the module; the straight part of the generating rack ends there
RADIUS_XTOL: Final = 1e-9  # mm; a millionth of a micrometre
ANGLE_XTOL: Final = 1e-12  # rad; over 100 mm a ten-thousandth of a micrometre

Curve = Callable[[float], float]


def rack_undercut_radius(
    pressure_angle: float, reference_radius: float, depth: float, ends: tuple[float, float], angle_at: Curve
) -> float:
    """Radius [mm] below which a rack would cut the involute of a spur gear away.

    In the gear's frame the corner runs along radius R at the azimuth atan2(v, r - h) - (v + h tan alpha)/r,
    v = sqrt(R^2 - (r - h)^2), while the flank lies at inv alpha_R - inv alpha.

    Args:
        pressure_angle: alpha [rad].
        reference_radius: r [mm].
        depth: h [mm], of the corner below the pitch line.
        ends: radii [mm] of base and tip circle.
        angle_at: alpha_R [rad] at a radius [mm].
    """
    from_axis = reference_radius - depth

    def corner_inside_tooth(radius: float) -> bool:
        along = math.sqrt(max(radius**2 - from_axis**2, 0.0))
        roll = (along + depth * math.tan(pressure_angle)) / reference_radius
        flank = involute(angle_at(radius)) - involute(pressure_angle)
        return math.atan2(along, from_axis) - roll > flank

    return _crossing(corner_inside_tooth, ends, RADIUS_XTOL)


def crown_rack_undercut_angle(
    pressure_angle: float, pitch_angle: float, eta: float, ends: tuple[float, float], flank_at: Curve
) -> float:
    """Polar angle [rad] below which a crown rack would cut the involute of a bevel gear away.

    Turned by xi from the pitch line the corner stands, seen from the gear, at the polar angle theta with
    cos(theta) = cos(eta) cos(xi) cos(delta) + sin(eta) sin(delta), and the gear has turned by the crown gear's turn
    over sin(delta).

    Args:
        pressure_angle: alpha [rad].
        pitch_angle: delta [rad].
        eta: of the corner below the crown gear's pitch plane [rad].
        ends: polar angles [rad] of base and tip cone.
        flank_at: azimuth [rad] of the flank from its crossing with the pitch cone, at a polar angle [rad].
    """
    sin, cos = math.sin(pitch_angle), math.cos(pitch_angle)
    crown_base = math.pi / 2 - pressure_angle
    below = math.asin(min(1.0, math.sin(eta) / math.sin(pressure_angle)))
    first, last = (float(involute_azimuth(math.pi / 2 + q, crown_base)) for q in (0.0, below))

    def corner_inside_tooth(polar: float) -> bool:
        cos_xi = min(1.0, (math.cos(polar) - math.sin(eta) * sin) / (math.cos(eta) * cos))
        xi = math.acos(cos_xi)
        outwards = math.cos(eta) * cos_xi * sin - math.sin(eta) * cos
        azimuth = math.atan2(math.cos(eta) * math.sin(xi), outwards) - (xi + last - first) / sin
        return azimuth > flank_at(polar)

    return _crossing(corner_inside_tooth, ends, ANGLE_XTOL)


def _crossing(inside: Callable[[float], bool], ends: tuple[float, float], xtol: float) -> float:
    """Crossing at which the corner leaves the tooth, between two ends."""
    low, high = ends
    while high - low > xtol:
        middle = (low + high) / 2
        low, high = (middle, high) if inside(middle) else (low, middle)
    return low
