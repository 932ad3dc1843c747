"""Rests and play of two eccentric involute gears on parallel axes, from both sides; no formulas of small eccentricity.

In the words of Wang, Zhou, Zou (Chinese J. Engineering 42(8), 2020, 1055-1064): angles phi and phases theta are
positive in each gear's own sense of rotation, phi2 is 0 where the drive flanks rest at phi1 = 0 without eccentricity.

The centres lie at C1 = e1 (cos, sin)(phi1 + theta1) and C2 = (a, 0) + e2 (cos, -sin)(phi2 + theta2), their distance is
a', its direction beta, cos alpha_w = (r_b1 + r_b2)/a'. On the crossed tangents of both base circles, the unwound
lengths of the touching involutes must add up to the tangent's:

    drive  r_b2 (phi2 + beta) = r_b1 (phi1 - beta) - (r_b1 + r_b2) inv alpha_w + K_d
    back   r_b2 (phi2 + beta) = r_b1 (phi1 - beta) + (r_b1 + r_b2) inv alpha_w + K_b

phi2 is in C2, so that it is found by iteration; each step gains a factor of e2/r_b2.
"""

import math
from dataclasses import dataclass

import numpy as np

STEPS = 12  # of the iteration: (27 um/45 mm)^12; five reach 1e-13 rad


def inv(angle: np.ndarray | float) -> np.ndarray:
    return np.asarray(np.tan(angle) - angle)


@dataclass(frozen=True)
class EccentricPair:
    """Lengths in mm, angles in rad; `play` is the normal backlash without eccentricity at the distance `centre`."""

    teeth: tuple[int, int]
    module: float
    alpha: float
    centre: float
    play: float
    eccentricity: tuple[float, float]
    phase: tuple[float, float]

    @property
    def base(self) -> tuple[float, float]:
        each = [self.module * teeth / 2 * math.cos(self.alpha) for teeth in self.teeth]
        return each[0], each[1]

    @property
    def working_alpha(self) -> float:
        return math.acos(sum(self.base) / self.centre)

    @property
    def turns(self) -> int:
        """Turns of the driver until the same teeth meet again."""
        return self.teeth[1] // math.gcd(*self.teeth)

    def rest(self, phi1: np.ndarray, side: str) -> np.ndarray:
        """phi2 where the drive or the back flanks touch."""
        (r1, r2), (e1, e2), (t1, t2) = self.base, self.eccentricity, self.phase
        at_rest = float(inv(self.working_alpha)) * (r1 + r2)
        sign, constant = (-1.0, at_rest) if side == "drive" else (1.0, self.play - at_rest)
        phi2 = phi1 * r1 / r2
        for _ in range(STEPS):
            x = self.centre + e2 * np.cos(phi2 + t2) - e1 * np.cos(phi1 + t1)
            y = -e2 * np.sin(phi2 + t2) - e1 * np.sin(phi1 + t1)
            beta, alpha = np.arctan2(y, x), np.arccos((r1 + r2) / np.hypot(x, y))
            phi2 = (r1 * (phi1 - beta) + sign * (r1 + r2) * inv(alpha) + constant) / r2 - beta
        return np.asarray(phi2)

    def transmission_error(self, phi1: np.ndarray, side: str) -> np.ndarray:
        """phi2 - phi1/i, less that at phi1 = 0."""
        lead = self.rest(phi1, side) - phi1 * self.base[0] / self.base[1]
        return np.asarray(lead - self.rest(np.zeros(1), side))

    def backlash(self, phi1: np.ndarray) -> np.ndarray:
        """The driven gear's free turn, the driver held."""
        return np.asarray(self.rest(phi1, "back") - self.rest(phi1, "drive"))

    # to first order: equations 3 to 6 ------------------------------------------------------------------

    def first_order_error(self, phi1: np.ndarray, side: str, alpha: float | None = None) -> np.ndarray:
        alpha = self.working_alpha if alpha is None else alpha
        sign = 1.0 if side == "drive" else -1.0

        def shift(phi: np.ndarray) -> np.ndarray:
            first = self.eccentricity[0] * np.sin(phi + sign * alpha + self.phase[0])
            second = phi * self.base[0] / self.base[1] - sign * alpha + self.phase[1]
            return np.asarray(first + self.eccentricity[1] * np.sin(second))

        return np.asarray((shift(phi1) - shift(np.zeros(1))) / self.base[1])

    def first_order_backlash(self, phi1: np.ndarray, alpha: float | None = None) -> np.ndarray:
        alpha = self.working_alpha if alpha is None else alpha
        phi2 = phi1 * self.base[0] / self.base[1]
        varying = self.eccentricity[1] * np.cos(phi2 + self.phase[1]) - self.eccentricity[0] * np.cos(
            phi1 + self.phase[0]
        )
        return np.asarray((self.play + 2 * math.sin(alpha) * varying) / self.base[1])
