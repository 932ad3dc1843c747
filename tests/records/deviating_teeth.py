"""Pairs whose flanks deviate tooth by tooth, in closed form: which flanks touch shares nothing with tol3d.apps.records.

Eccentric gears are two strings over base circles, solved by Newton's method. Flanks that lie ahead or behind on their
involutes shift the driven gear as a whole: of all pairs of flanks on the path of contact the first to touch governs.
Contact at tips is left out, as are second-order products of both.
"""

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from tol3d.apps.records.pair import RigPair, Side, Specimen

Array = NDArray[np.float64]
CONTACT_RATIO = 1.6
ROUNDS = 4  # of Newton; each doubles the digits, the first error is e/r_b2


@dataclass(frozen=True)
class ToothedUnit:
    """A unit on a rig.

    Args:
        specimen: its eccentricities and play without deviating teeth.
        ahead: of each side by how far the flanks of driver and driven gear stand out on the line of action [mm].
        before: pitches by which pairs of flanks of a side change before they otherwise would.
    """

    specimen: Specimen
    ahead: dict[Side, tuple[Array, Array]] = field(default_factory=dict)
    before: dict[Side, float] = field(default_factory=dict)

    @property
    def pair(self) -> RigPair:
        return self.specimen.pair

    def driven_angle(self, phi1: Array, side: Side) -> Array:
        return self.strings(phi1, side) + self.flanks(phi1, side)

    def strings(self, phi1: Array, side: Side) -> Array:
        """phi2 without deviating teeth: r_b2 (phi2 + beta) = r_b1 (phi1 - beta) -+ (r_b1 + r_b2)(inv - inv_0) + j_n."""
        own, pair = self.specimen, self.pair
        arm, sum_of_arms, sense = pair.driven_base_radius, pair.base_radii, -1.0 if side == "drive" else 1.0
        play = own.normal_backlash if side == "back" else 0.0
        driver = own.e1 * np.exp(1j * (phi1 + own.theta1))
        phi2 = phi1 * pair.driver_teeth / pair.driven_teeth
        nominal = math.sqrt(pair.centre_distance**2 - sum_of_arms**2) / sum_of_arms
        for _ in range(ROUNDS):
            line = pair.centre_distance + own.e2 * np.exp(-1j * (phi2 + own.theta2)) - driver
            steep = np.sqrt(np.abs(line) ** 2 - sum_of_arms**2) / sum_of_arms  # tan of the working angle
            lean = steep - np.arctan(steep) - (nominal - math.atan(nominal))
            miss = arm * phi2 + sum_of_arms * np.angle(line) - pair.driver_base_radius * phi1
            phi2 = phi2 - (miss - sense * sum_of_arms * lean - play) / arm
        return np.asarray(phi2)

    def flanks(self, phi1: Array, side: Side) -> Array:
        """By how much deviating teeth shift phi2: forward on the drive side, backward on the back side."""
        if side not in self.ahead:
            return np.zeros_like(phi1)
        first, second = self.ahead[side]
        pitches = phi1 * self.pair.driver_teeth / (2 * math.pi) + (0.3 if side == "drive" else 0.8)
        pitches += self.before.get(side, 0.0)
        latest = np.floor(pitches)
        candidates = []
        for back in range(math.ceil(CONTACT_RATIO)):
            tooth = (latest - back).astype(np.int64)
            out = first[tooth % len(first)] + second[tooth % len(second)]
            candidates.append(np.where(pitches - tooth < CONTACT_RATIO, out, -np.inf))
        sense = 1.0 if side == "drive" else -1.0
        return np.asarray(sense * np.max(candidates, axis=0) / self.pair.driven_base_radius)

    def curve(self, a_tooth: int = 40) -> tuple[Array, Array]:
        """The backlash over the long period [rad]: places, values."""
        count = a_tooth * self.pair.driver_teeth * self.pair.long_period_turns
        phi1 = (np.arange(count) + 0.5) * self.pair.long_period / count
        return phi1, self.driven_angle(phi1, "back") - self.driven_angle(phi1, "drive")

    @property
    def play_at_start(self) -> float:
        """The backlash at phi1 = 0 [rad]."""
        start = np.zeros(1)
        return float((self.driven_angle(start, "back") - self.driven_angle(start, "drive"))[0])

    @property
    def teeth_close(self) -> float:
        """Mean over the long period by which deviating teeth shrink the backlash [rad]."""
        phi1, _ = self.curve()
        return float(np.mean(self.flanks(phi1, "drive") - self.flanks(phi1, "back")))


def deviating(specimen: Specimen, single: float, random: np.random.Generator, *, walk: bool = False) -> ToothedUnit:
    """A unit whose flanks lie off by a standard deviation [mm] each for itself, or step so from tooth to tooth."""
    sides: tuple[Side, ...] = ("drive", "back")
    if single == 0.0:
        return ToothedUnit(specimen)

    def gear(teeth: int) -> Array:
        own = random.normal(0.0, single, teeth)
        if walk:
            own = np.cumsum(own - own.mean())
        return np.asarray(own - own.mean())

    pair = specimen.pair
    return ToothedUnit(specimen, {side: (gear(pair.driver_teeth), gear(pair.driven_teeth)) for side in sides})
