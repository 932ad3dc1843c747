"""The profile of a cycloid disc: the equidistant of a shortened epitrochoid, point, normal and curvature exact.

The disc's own frame: its axis is the origin, x leads through the root between its last lobe and lobe 0. As crank and
disc turn, the centre of a pin of radius r on a circle of radius rp runs in that frame along the path
c(u) = rp e^(iu) - a e^(i Zp u), a the eccentricity and Zp the number of pins. Its outward normal is
n(u) = e^(iu) (1 - K e^(it)) / w, with t = (Zp - 1) u, K = a Zp / rp and w = sqrt(1 + K^2 - 2 K cos t); the profile is
c - r n. All normals pass the pitch point a (Zp - 1) e^(i Zp u), on the circle that rolls in the pins' one.
"""

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from tol3d.numerics.arrays import Array, Complex
from tol3d.numerics.plane import as_points


@dataclass(frozen=True)
class Modification:
    """Modification of the ground profile against the one that touches every pin.

    First-order clearance between a flank and its pin, along the normal, at the phase t of the pin:
    offset - shift cos(alpha) + rotation |lever|, where cos(alpha) = (1 - K cos t) / sqrt(1 + K^2 - 2 K cos t) is that
    of the angle between the normal and the radius to the pin. Shift and offset of one sign work against each other;
    offset = shift sqrt(1 - K^2) < 0 leaves no clearance at cos t = K, where the lever is largest, and some elsewhere.

    Args:
        shift: added to the radius of the pin circle that the profile is ground for [mm]; negative takes material off.
        offset: added to the radius of the pins that it is ground for [mm]; positive takes material off.
        rotation: of either flank about the disc's axis, towards the middle of its lobe [rad]; positive takes material
            off. The lobe's tip and the root between two lobes become corners.
    """

    shift: float = 0.0
    offset: float = 0.0
    rotation: float = 0.0


UNMODIFIED: Final = Modification()


AZIMUTH_XTOL: Final = 1e-15  # rad; times 100 mm it is far below a double's last digit of a coordinate


@dataclass(frozen=True)
class DiscProfile:
    """Lobes of a cycloid disc, one fewer than its pins. Lengths in mm, angles in rad, counter-clockwise.

    The parameter u of a point is the azimuth of its pin before the eccentricity is added; lobe k lies between
    2 pi k / lobes, where the root is, and 2 pi (k + 1) / lobes, its tip in the middle. The phase t = lobes u is the
    angle from the radius to the pin to the direction of the eccentricity: 0 at a root, pi at a tip. The flank at phases
    from 0 to pi, the lobe's right one, is cleared by turning the disc counter-clockwise; the other by turning it back.

    Which numbers make a disc is not checked here; see tol3d.gearing.cycloid.model.limits.

    Args:
        pins: number of pins Zp.
        pin_circle_radius: rp [mm].
        pin_radius: r [mm].
        eccentricity: a [mm].
        modification: of the profile; pins and their circle are those above all the same.

    >>> profile = DiscProfile(pins=40, pin_circle_radius=114.5, pin_radius=5.0, eccentricity=2.2)
    >>> round(profile.shortening, 6), round(profile.pitch_radius, 6), round(math.degrees(profile.best_phase), 2)
    (0.768559, 85.8, 39.78)
    """

    pins: int
    pin_circle_radius: float
    pin_radius: float
    eccentricity: float
    modification: Modification = UNMODIFIED

    # numbers --------------------------------------------------------------------------------------------

    @property
    def lobes(self) -> int:
        """Zc = Zp - 1."""
        return self.pins - 1

    @property
    def lobe_pitch(self) -> float:
        """Angle from lobe to lobe [rad]."""
        return 2 * math.pi / self.lobes

    @property
    def shortening(self) -> float:
        """Shortening coefficient K = a Zp / rp of the epitrochoid; below 1 it has no cusp."""
        return self.eccentricity * self.pins / self.pin_circle_radius

    @property
    def pitch_radius(self) -> float:
        """rc' = a Zc [mm]: of the disc's pitch circle, and the largest lever of a pin's force about the disc's axis."""
        return self.eccentricity * self.lobes

    @property
    def best_phase(self) -> float:
        """Phase t [rad], between 0 and pi, at which the lever is largest: cos t = K."""
        return math.acos(self.shortening)

    @cached_property
    def ground(self) -> "DiscProfile":
        """The unmodified profile of the pins that the disc is ground for; the rotation is left out."""
        shifted = self.pin_circle_radius + self.modification.shift
        grown = self.pin_radius + self.modification.offset
        return replace(self, pin_circle_radius=shifted, pin_radius=grown, modification=UNMODIFIED)

    @property
    def tip_radius(self) -> float:
        """Radius of the circle through the tips of the lobes [mm], but for the corner that a rotation leaves there."""
        return self.ground.pin_circle_radius + self.eccentricity - self.ground.pin_radius

    @property
    def root_radius(self) -> float:
        """Radius of the circle through the roots [mm], but for the corner that a rotation leaves there."""
        return self.ground.pin_circle_radius - self.eccentricity - self.ground.pin_radius

    # forces ---------------------------------------------------------------------------------------------

    def phase(self, u: ArrayLike) -> Array:
        """t = Zc u [rad]."""
        return np.asarray(self.lobes * np.asarray(u, dtype=np.float64))

    def lever(self, u: ArrayLike) -> Array:
        """Lever of a pin's force about the disc's axis [mm], positive where it turns the disc counter-clockwise.

        rc' sin t / sqrt(1 + K^2 - 2 K cos t), from -rc' to rc'; the gap at the pin closes by that much per radian as
        the disc turns clockwise.
        """
        t = self.phase(u)
        return np.asarray(self.pitch_radius * np.sin(t) / self._speed(t))

    def cos_normal(self, u: ArrayLike) -> Array:
        """Cosine of the angle between the normal and the radius to the pin; sqrt(1 - K^2) at the best phase, 1 at tips.

        (1 - K cos t) / sqrt(1 + K^2 - 2 K cos t): the share of a radial displacement of the pin that acts.
        """
        t = self.phase(u)
        return np.asarray((1 - self.shortening * np.cos(t)) / self._speed(t))

    def sin_normal(self, u: ArrayLike) -> Array:
        """Sine of that angle: K sin t / sqrt(1 + K^2 - 2 K cos t), the share of a pin's tangential displacement.

        A pin that moves clockwise on its circle by d opens a gap of d times it; K at the best phase.
        """
        t = self.phase(u)
        return np.asarray(self.shortening * np.sin(t) / self._speed(t))

    def clearance(self, u: ArrayLike) -> Array:
        """Gap between flank and pin along the normal [mm] that the modification leaves, to first order."""
        own = self.modification
        return np.asarray(own.offset - own.shift * self.cos_normal(u) + own.rotation * np.abs(self.lever(u)))

    # curves ---------------------------------------------------------------------------------------------

    def pin_centres(self, u: ArrayLike) -> Array:
        """Path of the centres of the nominal pins, (..., 2) [mm]; a modified disc leaves gaps to pins on it."""
        return as_points(self._path(np.asarray(u, dtype=np.float64)))

    def points(self, u: ArrayLike) -> Array:
        """Points of the profile, (..., 2) [mm]; where flanks were rotated see `flank_ends`."""
        u, own = np.asarray(u, dtype=np.float64), self.ground
        return as_points((own._path(u) - own.pin_radius * own._normal(u)) * self._turn(u))

    def normals(self, u: ArrayLike) -> Array:
        """Unit normals out of the disc, (..., 2)."""
        u = np.asarray(u, dtype=np.float64)
        return as_points(self.ground._normal(u) * self._turn(u))

    def slopes(self, u: ArrayLike) -> Array:
        """dp/du of the profile, (..., 2) [mm/rad]; 0 where it would be undercut."""
        u, own = np.asarray(u, dtype=np.float64), self.ground
        along = 1j * own._normal(u) * own.path_speed(u) * (1 - own.pin_radius * own.path_curvature(u))
        return as_points(along * self._turn(u))

    def path_curvature(self, u: ArrayLike) -> Array:
        """Curvature of the path of pin centres that the disc is ground for [1/mm], positive where the disc is convex.

        (1 + Zp K^2 - (Zp + 1) K cos t) / (rp w^3).
        """
        own = self.ground
        t, k = own.phase(u), own.shortening
        return np.asarray(
            (1 + own.pins * k**2 - (own.pins + 1) * k * np.cos(t)) / (own.pin_circle_radius * own._speed(t) ** 3)
        )

    @cached_property
    def smallest_convex_radius(self) -> float:
        """Smallest radius of curvature of convex parts of the path that the disc is ground for [mm].

        d/dt of the radius vanishes at cos t = ((2 Zp - 1) K^2 - (Zp - 2)) / ((Zp + 1) K), where it is
        rp sqrt(27 (Zp - 1) (1 - K^2) / (Zp + 1)^3); up to K = (Zp - 2) / (2 Zp - 1) it is smallest at the tips,
        rp (1 + K)^2 / (1 + Zp K). A pin of at least that radius undercuts the lobes.
        """
        own = self.ground
        k, pins, radius = own.shortening, own.pins, own.pin_circle_radius
        if k <= (pins - 2) / (2 * pins - 1):
            return radius * (1 + k) ** 2 / (1 + pins * k)
        return radius * math.sqrt(27 * (pins - 1) * (1 - k**2) / (pins + 1) ** 3)

    @cached_property
    def flank_ends(self) -> tuple[float, float]:
        """Parameters u of the profile that the disc is ground for, between which lobe 0 has its right flank.

        From 0 to half a lobe pitch. A rotation takes the flank along: it begins and ends where the flank, rotated,
        meets the left one, which lies in the mirror.
        """
        turned = self.modification.rotation
        if turned == 0.0:
            return 0.0, self.lobe_pitch / 2
        return self._at_azimuth(-turned), self._at_azimuth(self.lobe_pitch / 2 - turned)

    # steps ----------------------------------------------------------------------------------------------

    def _at_azimuth(self, azimuth: float) -> float:
        """Parameter of the point at that azimuth on the profile that the disc is ground for."""
        own = self.ground
        reach = self.lobe_pitch / 4

        def beyond(u: float) -> float:
            x, y = own.points(u)
            return math.atan2(y, x) - azimuth

        return float(brentq(beyond, azimuth - reach, azimuth + reach, xtol=AZIMUTH_XTOL))

    def _turn(self, u: Array) -> Complex:
        """The rotation of the flank on which u lies."""
        return np.asarray(np.exp(1j * np.copysign(self.modification.rotation, np.sin(self.phase(u)))))

    def _speed(self, t: Array) -> Array:
        k = self.shortening
        return np.sqrt(1 + k**2 - 2 * k * np.cos(t))

    def path_speed(self, u: Array) -> Array:
        """|dc/du| = rp w of the path of pin centres [mm/rad]."""
        return self.pin_circle_radius * self._speed(self.phase(u))

    def _path(self, u: Array) -> Complex:
        return np.asarray(self.pin_circle_radius * np.exp(1j * u) - self.eccentricity * np.exp(1j * self.pins * u))

    def _normal(self, u: Array) -> Complex:
        t = self.phase(u)
        return np.asarray(np.exp(1j * u) * (1 - self.shortening * np.exp(1j * t)) / self._speed(t))
