"""Transmission error and backlash of eccentric involute gears, without the assumption of small eccentricities.

At any instant both gears are ordinary gears about their own centres C1, C2: with a' = |C2 - C1|, beta the direction of
C2 - C1 and cos alpha' = (r_b1 + r_b2)/a',

    drive flank  r_b2 (phi2 + beta) = r_b1 (phi1 - beta) - (r_b1 + r_b2) inv alpha' + K_d
    back flank   r_b2 (phi2 + beta) = r_b1 (phi1 - beta) + (r_b1 + r_b2) inv alpha' + K_b

with K_d = (r_b1 + r_b2) inv alpha_w and K_d + K_b = j_n: on the drive flank phi2 = phi1 z1/z2 without eccentricities,
on the back flank the driven gear is ahead by j_n/r_b2. C2 turns with phi2, so phi2 is found by iteration.
"""

from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np

from tol3d.numerics.arrays import Array
from tol3d.records.pair import RigPair, Specimen

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
    """phi2 [rad] at which that flank touches, for phi1 [rad] of any shape."""
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
    """j [rad]: how far the driven gear is free to turn with the driver held at phi1."""
    return np.asarray(driven_angle(specimen, phi1, "back") - driven_angle(specimen, phi1, "drive"))
