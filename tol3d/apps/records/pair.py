"""A spur pair on a rig: its data in a scene, and one specimen of it with its own eccentricities.

Convention of every formula here: phi1 and phi2 are the turns of driver and driven gear, each positive in its OWN sense
of rotation in the drive run, and theta1, theta2 the phases of the eccentricities in the same senses. The teeth's
centres lie at C1 = e1 (cos, sin)(phi1 + theta1) and C2 = (a, 0) + e2 (cos, -sin)(phi2 + theta2), the driver's axis in
the origin and the driven one at +x. Source: Wang, Zhou, Zou, "Measurement and prediction of backlash based on two-sided
transmission error", Chinese J. Engineering 42(8), 2020, 1055-1064, whose formulas are of first order in e.
"""

import math
from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np

from tol3d.numerics.arrays import Array

ARCSEC = math.pi / 648000  # rad
TURN = 2 * math.pi  # rad


@dataclass(frozen=True)
class RigPair:
    """Two spur gears on fixed axes.

    Args:
        driver_teeth, driven_teeth: z1, z2.
        driver_base_radius, driven_base_radius: r_b1, r_b2 [mm].
        centre_distance: a [mm], of the axes.

    >>> pair = RigPair(27, 48, 27 * math.cos(math.radians(20)), 48 * math.cos(math.radians(20)), 75.0)
    >>> pair.long_period_turns, round(math.degrees(pair.working_angle), 6)
    (16, 20.0)
    """

    driver_teeth: int
    driven_teeth: int
    driver_base_radius: float
    driven_base_radius: float
    centre_distance: float

    @property
    def rate(self) -> float:
        """z1/z2, turns of the driven gear per turn of the driver."""
        return self.driver_teeth / self.driven_teeth

    @property
    def base_radii(self) -> float:
        """r_b1 + r_b2 [mm]."""
        return self.driver_base_radius + self.driven_base_radius

    @property
    def working_angle(self) -> float:
        """alpha_w with cos alpha_w = (r_b1 + r_b2)/a [rad]."""
        return math.acos(self.base_radii / self.centre_distance)

    @property
    def common_factor(self) -> int:
        """Greatest common divisor of z1 and z2."""
        return math.gcd(self.driver_teeth, self.driven_teeth)

    @property
    def long_period_turns(self) -> int:
        """Turns of the driver until both eccentricities stand to each other as before: z2 / gcd(z1, z2)."""
        return self.driven_teeth // self.common_factor

    @property
    def long_period(self) -> float:
        """The same as an angle of the driver [rad]."""
        return TURN * self.long_period_turns

    @property
    def driven_pitch(self) -> float:
        """2 pi / z2 [rad]."""
        return TURN / self.driven_teeth


@dataclass(frozen=True)
class Specimen:
    """One pair as it was made and mounted.

    Args:
        pair: its nominal numbers.
        e1, theta1: eccentricity of the driver [mm] and its phase [rad].
        e2, theta2: of the driven gear.
        normal_backlash: j_n [mm] that it would have without eccentricities.
    """

    pair: RigPair
    e1: float
    theta1: float
    e2: float
    theta2: float
    normal_backlash: float

    @property
    def constant_part(self) -> float:
        """j_c = j_n / r_b2 [rad], a turn of the driven gear."""
        return self.normal_backlash / self.pair.driven_base_radius


Side = Literal["drive", "back"]

ROUNDS = 6  # each gains a factor e2/a, 1e-3 or less for any gear that runs


class Unit(Protocol):
    """A pair whose flanks can be found touching, at any angle of the driver."""

    @property
    def pair(self) -> RigPair:
        """Its nominal numbers."""

    def driven_angle(self, phi1: Array, side: Side) -> Array:
        """phi2 [rad] at which the flank of that side touches, for phi1 [rad] of any shape."""


@dataclass(frozen=True)
class ClosedForm:
    """A specimen as a Unit."""

    specimen: Specimen

    @property
    def pair(self) -> RigPair:
        """See Unit."""
        return self.specimen.pair

    def driven_angle(self, phi1: Array, side: Side) -> Array:
        """See Unit."""
        return driven_angle(self.specimen, phi1, side)


def driven_angle(specimen: Specimen, phi1: Array, side: Side) -> Array:
    """phi2 [rad] at which that flank touches, for phi1 [rad] of any shape and eccentricities of any size.

    At any instant both gears are ordinary gears about their own centres C1, C2: with a' = |C2 - C1|, beta the direction
    of C2 - C1 and cos alpha' = (r_b1 + r_b2)/a',

        drive flank  r_b2 (phi2 + beta) = r_b1 (phi1 - beta) - (r_b1 + r_b2) inv alpha' + K_d
        back flank   r_b2 (phi2 + beta) = r_b1 (phi1 - beta) + (r_b1 + r_b2) inv alpha' + K_b

    with K_d = (r_b1 + r_b2) inv alpha_w and K_d + K_b = j_n: on the drive flank phi2 = phi1 z1/z2 without
    eccentricities, on the back flank the driven gear is ahead by j_n/r_b2. C2 turns with phi2, so phi2 is found by
    iteration.
    """
    pair = specimen.pair
    flat = pair.base_radii * (np.tan(pair.working_angle) - pair.working_angle)
    sense, constant = (-1.0, flat) if side == "drive" else (1.0, specimen.normal_backlash - flat)
    x1, y1 = specimen.e1 * np.cos(phi1 + specimen.theta1), specimen.e1 * np.sin(phi1 + specimen.theta1)
    phi2 = pair.rate * phi1
    for _ in range(ROUNDS):
        at = phi2 + specimen.theta2
        x = pair.centre_distance + specimen.e2 * np.cos(at) - x1
        y = -specimen.e2 * np.sin(at) - y1
        beta = np.arctan2(y, x)
        cos = pair.base_radii / np.hypot(x, y)
        involute = np.sqrt(1.0 - cos * cos) / cos - np.arccos(cos)
        along = pair.driver_base_radius * (phi1 - beta) + sense * pair.base_radii * involute + constant
        phi2 = along / pair.driven_base_radius - beta
    return np.asarray(phi2)


def transmission_error(specimen: Specimen, phi1: Array, side: Side) -> Array:
    """phi2 - phi1 z1/z2 [rad], not yet counted from its value at phi1 = 0."""
    return np.asarray(driven_angle(specimen, phi1, side) - specimen.pair.rate * phi1)


def angular_backlash(specimen: Specimen, phi1: Array) -> Array:
    """j [rad]: free turn of the driven gear with the driver held at phi1."""
    return np.asarray(driven_angle(specimen, phi1, "back") - driven_angle(specimen, phi1, "drive"))
