"""The spherical involute: the trace of a line through the apex while its plane rolls on a base cone.

Worked out from the rolling plane. Angles in rad, lengths in mm. Frame: apex at the origin, z the cone's axis.

The plane touches the cone along t = (sin b cos f, sin b sin f, cos b), b the base angle and f the tangent's
azimuth, and holds e = (-sin f, cos f, 0) too. Rolled by psi about the axis it has moved by the angle
q = psi sin b within itself, the in-plane angle, and the line has drawn

    P = R (cos q t - sigma sin q e),  f = f0 + sigma psi,

R the distance from the apex. q = 0 lies on the base cone, f0 is the azimuth there. The flank is ruled by the
lines through the apex, and its normal, which stays in the rolling plane, is the same all along such a line.
"""

import numpy as np

from tol3d.gears.flank import Flank
from tol3d.numerics.arrays import Array

Angles = float | Array

SERIES_BELOW = 0.1  # tan q over sin b; from there on the closed form loses less than 2e-17 rad
SERIES_TERMS = 9  # the first one left out is below 0.1^18 of the sum
NEWTON_STEPS = 60  # far more than the start needs (under 10); a guard, not a tuning
ANGLE_XTOL = 4e-16  # of the angle itself, the spacing of doubles
END_ROUNDING = 1e-14  # of the largest azimuth; the flank's own end, computed another way, may lie that far beyond


def in_plane_angle(polar: Angles, base: float) -> Array:
    """q [rad] of the flank at a polar angle, cos q = cos(polar)/cos(base); 0 at and below the base cone.

    Written with half angles, 2 sin^2(q/2) = 1 - cos q, so that no digits cancel near the base cone.

    >>> b = np.radians(40.0)
    >>> float(np.cos(in_plane_angle(np.radians(45.0), b)) * np.cos(b) - np.cos(np.radians(45.0))) < 1e-16
    True
    """
    rise = np.maximum(np.sin((polar - base) / 2), 0.0)
    half = np.sin((polar + base) / 2) * rise / np.cos(base)
    return np.asarray(2 * np.arcsin(np.sqrt(np.minimum(half, 1.0))), dtype=np.float64)


def polar_angle(q: Angles, base: float) -> Array:
    """Angle [rad] between axis and flank at the in-plane angle q: cos(polar) = cos q cos(base)."""
    outwards = np.sqrt(np.sin(q) ** 2 + (np.sin(base) * np.cos(q)) ** 2)
    return np.asarray(np.arctan2(outwards, np.cos(base) * np.cos(q)), dtype=np.float64)


def involute_azimuth(q: Angles, base: float) -> Array:
    """Azimuth [rad] that the flank gains from the base cone to the in-plane angle q, 0 <= q <= pi.

    q/sin b - atan2(sin q, sin b cos q). Near the base cone both terms are nearly equal: there, with
    u = tan q/sin b, the sum of (-1)^(k+1) (1 - sin^2k b) u^(2k+1)/(2k+1) over k = 1, 2, ... replaces them.
    """
    sin_base = float(np.sin(base))
    q = np.asarray(q, dtype=np.float64)
    sin, cos = np.sin(q), np.cos(q)
    near = sin < SERIES_BELOW * sin_base * cos
    closed = q / sin_base - np.arctan2(sin, sin_base * cos)
    u = np.where(near, sin / np.where(near, sin_base * cos, 1.0), 0.0)
    series = np.zeros_like(u)
    for k in range(SERIES_TERMS, 0, -1):
        series = (1 - sin_base ** (2 * k)) / (2 * k + 1) - u * u * series
    return np.asarray(np.where(near, u**3 * series, closed), dtype=np.float64)


def spherical_involute(polar: Angles, base: float) -> Array:
    """inv [rad]: azimuth that the flank gains from the base cone to a polar angle; 0 at and below the base cone.

    For small cones it tends to the plane involute tan a - a with cos a = sin(base)/sin(polar).

    >>> b = float(np.arcsin(np.sin(np.radians(45.0)) * np.cos(np.radians(20.0))))
    >>> round(float(spherical_involute(np.radians(45.0), b)), 9)
    0.020598343
    """
    return involute_azimuth(in_plane_angle(polar, base), base)


def inverse_spherical_involute(azimuth: float, base: float) -> float:
    """The polar angle [rad], base <= polar <= pi/2, at which the flank has gained that azimuth.

    Newton on involute_azimuth(q), whose derivative sin^2 q cos^2 b/(sin b sin^2(polar)) grows with q: the first
    step lands above the root, and all later ones come down to it.

    Raises:
        ValueError: azimuth is negative, or more than the flank gains on the way to 90 deg.

    >>> b = float(np.radians(40.0))
    >>> round(float(np.degrees(inverse_spherical_involute(float(spherical_involute(np.radians(50.0), b)), b))), 12)
    50.0
    """
    highest = float(involute_azimuth(np.pi / 2, base))
    if not 0.0 <= azimuth <= highest * (1 + END_ROUNDING):
        raise ValueError(f"inverse_spherical_involute: expected 0 to {highest:g} rad, got {azimuth:g} rad")
    sin, cos = float(np.sin(base)), float(np.cos(base))
    q = min(float(np.cbrt(3 * azimuth / cos**2)) * sin, np.pi / 2)
    for _ in range(NEWTON_STEPS):
        if q == 0.0:
            break
        rate = np.sin(q) ** 2 * cos**2 / (sin * (np.sin(q) ** 2 + (sin * np.cos(q)) ** 2))
        step = (float(involute_azimuth(q, base)) - azimuth) / float(rate)
        q = min(q - step, np.pi / 2)
        if abs(step) <= ANGLE_XTOL * q:
            break
    return float(polar_angle(q, base))


def flank_directions(q: Angles, base: float, start: Angles, flank: Flank) -> Array:
    """Unit vectors from the apex to the flank, cos q t - sigma sin q e.

    Args:
        q: in-plane angles [rad], any shape; q and start broadcast.
        base: base angle [rad].
        start: azimuth [rad] at which the flank leaves the base cone.
        flank: RIGHT or LEFT.

    Returns:
        (..., 3).
    """
    tangent, along = _rolling_plane(q, base, start, flank)
    return np.cos(q)[..., None] * tangent - flank * np.sin(q)[..., None] * along


def flank_normals(q: Angles, base: float, start: Angles, flank: Flank) -> Array:
    """Unit normals out of the tooth at those directions, -(sin q t + sigma cos q e), shape (..., 3)."""
    tangent, along = _rolling_plane(q, base, start, flank)
    return -np.sin(q)[..., None] * tangent - flank * np.cos(q)[..., None] * along


def _rolling_plane(q: Angles, base: float, start: Angles, flank: Flank) -> tuple[Array, Array]:
    """t and e, each (..., 3), of the plane that has rolled to the in-plane angle q."""
    azimuth = np.asarray(start + flank * np.asarray(q) / np.sin(base))
    cos, sin, flat = np.cos(azimuth), np.sin(azimuth), np.zeros_like(azimuth)
    tangent = np.stack([np.sin(base) * cos, np.sin(base) * sin, np.cos(base) + flat], axis=-1)
    return tangent, np.stack([-sin, cos, flat], axis=-1)
