"""Two straight bevel gears with a common apex: frames, path of contact, teeth that meet.

Exact for rigid spherical-involute teeth. The plane of action touches both base cones and holds the pitch line; in
it the flanks meet along lines through the apex, and a pair's in-plane angles keep their sum, q1 + q2 = q_p1 + q_p2.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tol3d.errors import GeometryError
from tol3d.gears.bevel_gear import BevelGear, pitch_angles
from tol3d.gears.flank import Flank
from tol3d.gears.pair import CONTACT_MARGIN, Displaced, RollingPair
from tol3d.numerics.arrays import Array

SAME_ANGLE = 1e-9  # rad; over 100 mm a ten-thousandth of a micrometre
SAME_SHIFT = 1e-9  # modules


@dataclass(frozen=True)
class BevelPair(RollingPair):
    """Pinion (driver) and wheel (driven) with their apexes in one point and their axes at a shaft angle [rad].

    World: the common apex is the origin, the driver's axis +z, the pitch line lies in the half plane y = 0, x > 0.

    Raises:
        GeometryError: module, pressure angle, pitch angles, teeth, profile shifts do not make one pair.

    >>> alpha, delta = math.radians(20), math.radians(45)
    >>> gear = BevelGear(31, 3.5, alpha, 9.0, delta)
    >>> pair = BevelPair(gear, gear, math.radians(90))
    >>> round(pair.contact_ratio, 4), abs(pair.normal_backlash) < 1e-12
    (1.7326, True)
    """

    pinion: BevelGear
    wheel: BevelGear
    shaft_angle: float

    def __post_init__(self) -> None:
        self._refuse_unlike()
        self._refuse_cones_that_do_not_roll()
        total = self.pinion.profile_shift + self.wheel.profile_shift
        if not abs(total) <= SAME_SHIFT:
            raise GeometryError(
                "the profile shifts of a bevel pair must cancel, for the pitch cones are given by the teeth and the "
                f"shaft angle: got {self.pinion.profile_shift:g} and {self.wheel.profile_shift:g}, "
                f"together {total:g} instead of 0"
            )

    def _refuse_cones_that_do_not_roll(self) -> None:
        first, second = self.pinion.pitch_angle, self.wheel.pitch_angle
        degrees = f"{math.degrees(first):.6f} and {math.degrees(second):.6f} deg"
        if not abs(first + second - self.shaft_angle) <= SAME_ANGLE:
            raise GeometryError(
                f"the pitch angles {degrees} add up to {math.degrees(first + second):.6f} deg, "
                f"the shaft angle is {math.degrees(self.shaft_angle):.6f} deg"
            )
        wanted = pitch_angles(self.pinion.teeth, self.wheel.teeth, self.shaft_angle)
        if not abs(first - wanted[0]) <= SAME_ANGLE:
            raise GeometryError(
                f"{self.pinion.teeth} and {self.wheel.teeth} teeth at {math.degrees(self.shaft_angle):.6f} deg roll on "
                f"pitch cones of {math.degrees(wanted[0]):.6f} and {math.degrees(wanted[1]):.6f} deg, got {degrees}: "
                f"the outer cone distances would be {self.pinion.outer_cone_distance:.4f} and "
                f"{self.wheel.outer_cone_distance:.4f} mm"
            )

    @property
    def base_helix_cosine(self) -> float:
        """1: the teeth are straight."""
        return 1.0

    @property
    def working_pressure_angle(self) -> float:
        """alpha_w = alpha [rad]: with one apex the pitch cones are the working ones."""
        return self.pinion.pressure_angle

    @property
    def face(self) -> tuple[float, float]:
        """Cone distances [mm] between which both gears have flank; the heels coincide."""
        inner = max(self.pinion.inner_cone_distance, self.wheel.inner_cone_distance)
        return inner, self.pinion.outer_cone_distance

    @property
    def mean_cone_distance(self) -> float:
        """Middle of the common face [mm]."""
        return sum(self.face) / 2

    @property
    def working_radii(self) -> tuple[float, float]:
        """Radii [mm] of the pitch cones of pinion and wheel at the middle of the common face."""
        mean = self.mean_cone_distance
        return mean * math.sin(self.pinion.pitch_angle), mean * math.sin(self.wheel.pitch_angle)

    @property
    def normal_backlash(self) -> float:
        """j_n [mm] at the middle of the common face: R sin(p_b - 2 sum of sin(beta) s/(2 r_e)), 0 for nominal teeth.

        It is proportional to the distance from the apex, for teeth that are cones: not one number on a face.
        """
        teeth = sum(math.sin(gear.base_angle) * gear.pitch_half_angle for gear in (self.pinion, self.wheel))
        return self.mean_cone_distance * math.sin(self.pinion.base_pitch_angle - 2 * teeth)

    # path of contact ------------------------------------------------------------------------------

    @property
    def start_q(self) -> float:
        """In-plane angle [rad] of the pinion's flank where the wheel's tip cone begins the path of contact."""
        return self.pinion.pitch_q + self.wheel.pitch_q - self.wheel.tip_q

    @property
    def contact_ratio(self) -> float:
        """epsilon_alpha: angle of the path of contact, (tip q1 + tip q2 - q_p1 - q_p2), over the base pitch."""
        return (self.pinion.tip_q - self.start_q) / self.pinion.base_pitch_angle

    def refuse_interference(self) -> None:
        """Raise unless tips clear roots and the path of contact stays on both involutes.

        Raises:
            GeometryError: with the angles and what to change.
        """
        mirrored = BevelPair(self.wheel, self.pinion, self.shaft_angle)
        for pair, name, mate in ((self, "driver", "driven"), (mirrored, "driven", "driver")):
            pair._refuse_interference_of_pinion(name, mate)
        if self.contact_ratio < 1.0:
            raise GeometryError(f"contact ratio {self.contact_ratio:.4f} is below 1: the teeth lose contact")

    def _refuse_interference_of_pinion(self, name: str, mate: str) -> None:
        gear = self.pinion
        clearance = gear.outer_cone_distance * math.sin(self.shaft_angle - gear.root_angle - self.wheel.tip_angle)
        if clearance <= 0.0:
            raise GeometryError(
                f"the teeth interfere: the tip of the {mate} gear and the root of the {name} gear interfere by "
                f"{-clearance:.4f} mm at the outer end; raise the {name} gear's dedendum or lower the {mate} gear's "
                "addendum"
            )
        at = math.acos(math.cos(max(self.start_q, 0.0)) * math.cos(gear.base_angle))
        where = f"at {math.degrees(at):.4f} deg" if self.start_q > 0.0 else "below the base cone"
        if at < gear.undercut_angle:
            raise GeometryError(
                f"undercut reaches the flank in use: a crown rack of addendum 1 cuts the {name} gear's involute up to "
                f"{math.degrees(gear.undercut_angle):.4f} deg, contact begins {where}; give "
                f"profile_shift of at least {gear.undercut_limit_shift:.4f} (it has {gear.profile_shift:g})"
            )
        if self.start_q < gear.form_q:
            begins = math.degrees(max(gear.base_angle, gear.root_angle))
            raise GeometryError(
                f"the teeth interfere: the {mate} gear's tip would touch the {name} gear {where}, "
                f"but its involute begins at {begins:.4f} deg; lower addendum, or add profile_shift"
            )

    # positions --------------------------------------------------------------------------------------

    @property
    def wheel_origin(self) -> Array:
        """The common apex, (3,) [mm]."""
        return np.zeros(3)

    @property
    def mesh_azimuths(self) -> tuple[float, float]:
        """Both gears see the pitch line at azimuth 0 [rad]."""
        return 0.0, 0.0

    @property
    def opening_off_mesh(self) -> tuple[float, float]:
        """Away from the mate, both [rad]."""
        return math.pi, math.pi

    @property
    def pinion_section(self) -> float:
        """Position of the middle of the common face on the pinion's, from toe (0) to heel (1)."""
        return (self.mean_cone_distance - self.pinion.inner_cone_distance) / self.pinion.face_width

    @property
    def arm_spread(self) -> float:
        """Spread from toe to heel of the common face, (R_e - R_i)/R_e."""
        inner, outer = self.face
        return (outer - inner) / outer

    @property
    def view_from_world(self) -> Array:
        """Rotation (3, 3) to the view along the pitch line towards the apex, the wheel on the right."""
        cos, sin = math.cos(self.pinion.pitch_angle), math.sin(self.pinion.pitch_angle)
        return np.array([[cos, 0.0, -sin], [0.0, 1.0, 0.0], [sin, 0.0, cos]])

    def tip_clearance(self, origins: Array, scale: tuple[float, float]) -> float:
        """Smaller free distance [mm] between a tip cone and the mate's root cone at the toe, apexes where they are."""
        inner, _ = self.face
        pairs = ((self.pinion, self.wheel), (self.wheel, self.pinion))
        nominal = min(inner * math.sin(self.shaft_angle - a.root_angle - b.tip_angle) for a, b in pairs)
        cos, sin = math.cos(self.pinion.pitch_angle), math.sin(self.pinion.pitch_angle)
        apart = origins[1] - origins[0]
        return float(nominal + cos * apart[0] - sin * apart[2])

    @property
    def remedy(self) -> str:
        """A pair with a common apex has no play: thinner teeth or longer mounting distances give it some."""
        return (
            "nominal teeth with a common apex have no play: thin the teeth, or move the gears away from the apex "
            "(thinner shims, longer mounting distances)"
        )

    @property
    def world_from_wheel(self) -> Array:
        """Rotation (3, 3) of the wheel's frame at rest: z2 = (sin S, 0, cos S), y2 = -y, x2 = y2 x z2.

        Both gears see the pitch line at azimuth 0. A turn of the wheel is about its own z, on the right of this.
        """
        sin, cos = math.sin(self.shaft_angle), math.cos(self.shaft_angle)
        return np.array([[-cos, 0.0, sin], [0.0, -1.0, 0.0], [sin, 0.0, cos]])

    def driven_angle(self, driver_angle: Array) -> Array:
        """Wheel's turn [rad] with its space centred on the pinion's tooth: pi/z2 - (z1/z2) theta_1."""
        return math.pi / self.wheel.teeth - driver_angle / self.ratio

    def touching_angle(self, driver_angle: Array, flank: Flank, displaced: Displaced) -> Array:
        """Wheel's turn [rad] at which the first pair of that side touches in the middle of the face, to first order.

        A pair whose contact lies s from the pitch line in the plane of action has the normal
        n(s) = cos s p - sin s e, p = sin(alpha) N - sigma cos(alpha) y, e the pitch line and N from the pinion to
        the wheel across it. A shift D of the pinion's apex against the wheel's takes n(s) D off its gap, a turn W
        takes R (e x p) W, and a turn of the wheel adds R sigma sin(beta_2).

        Args:
            driver_angle: pinion's turn [rad], (trials,).
            flank: the pinion's flank.
            displaced: where the gears lie, and their flanks.
        """
        radius = self.mean_cone_distance
        sin, cos = math.sin(self.pinion.pitch_angle), math.cos(self.pinion.pitch_angle)
        line, across = np.array([sin, 0.0, cos]), np.array([cos, 0.0, -sin])
        side = np.array([0.0, 1.0, 0.0])
        alpha = self.working_pressure_angle
        at_pitch = math.sin(alpha) * across - flank * math.cos(alpha) * side
        arm = flank * math.cos(alpha) * across + math.sin(alpha) * side
        shift, turn = (vectors[:, 0] - vectors[:, 1] for vectors in (displaced.origin, displaced.turn))
        teeth, near = self.candidate_teeth(driver_angle, flank)
        azimuth = driver_angle[:, None] + self.pinion.angular_pitch * teeth
        off = math.sin(self.pinion.base_angle) * (self.pinion.pitch_half_angle - flank * azimuth)
        opened = np.sin(off) * _along(shift, line)[:, None] - np.cos(off) * _along(shift, at_pitch)[:, None]
        least = np.min(np.where(near, opened, np.inf), axis=1) / radius - _along(turn, arm)
        still = self.start_angle(driver_angle, flank, 2 * displaced.flank_turn * self._mean_radii)
        return np.asarray(still - flank * least / math.sin(self.wheel.base_angle), dtype=np.float64)

    @property
    def _mean_radii(self) -> Array:
        return np.array([self.pinion.mean_radius, self.wheel.mean_radius])

    def start_angle(self, driver_angle: Array, flank: Flank, thickness: Array) -> Array:
        """Wheel's turn [rad] at which the flanks of that side touch, were the axes and the apex in place.

        In the plane of action each flank stands sin(beta) (s/(2 r_e) - sigma azimuth) from the pitch line, and two
        that touch stand together; thicker teeth are the same flanks turned. Exact then, for every tooth pair and
        along the whole face.

        Args:
            driver_angle: pinion's turn [rad], (trials,).
            flank: the pinion's flank.
            thickness: deviations of the tooth thickness of pinion and wheel, (trials, 2) [mm], arcs at
                their mean_radius, proportional along the face.
        """
        half_angles = [
            gear.pitch_half_angle + thickness[:, k] / (2 * gear.mean_radius)
            for k, gear in enumerate((self.pinion, self.wheel))
        ]
        mate = 0 if flank == 1 else 1
        opened = flank * (half_angles[0] / self.ratio + half_angles[1])
        return np.asarray(mate * self.wheel.angular_pitch + opened - driver_angle / self.ratio, dtype=np.float64)

    @property
    def active_azimuths(self) -> tuple[float, float]:
        """A tooth at azimuth psi touches at the in-plane angle q = q_p + sin(beta) (s/(2 r_e) - sigma psi)."""
        gear = self.pinion
        per_azimuth = math.sin(gear.base_angle)
        at_pitch = gear.pitch_q + per_azimuth * gear.pitch_half_angle
        return (at_pitch - gear.tip_q) / per_azimuth, (at_pitch - self.start_q) / per_azimuth

    @property
    def touching_azimuths(self) -> tuple[float, float]:
        """The path of contact and twice CONTACT_MARGIN: tilted cones bring edges into contact that far beyond it."""
        lowest, highest = self.active_azimuths
        margin = 2 * CONTACT_MARGIN * self.pinion.angular_pitch
        return lowest - margin, highest + margin

    def mating_teeth(self, driver_teeth: NDArray[np.int64], flank: Flank) -> NDArray[np.int64]:
        """The wheel's tooth that each of those pinion flanks meets: -k on the right flank, -k - 1 on the left."""
        return -driver_teeth - (0 if flank == 1 else 1)

    def mating_flank(self, flank: Flank) -> Flank:
        """Flank of the same side: the driver's right flank faces -y at the mesh, where the wheel's y is opposite."""
        return flank


def _along(vectors: Array, direction: Array) -> Array:
    """Components (rows,) of vectors (rows, 3) along a direction, with the same bits for one row and many."""
    x, y, z = vectors.T
    return np.asarray(x * direction[0] + y * direction[1] + z * direction[2], dtype=np.float64)
