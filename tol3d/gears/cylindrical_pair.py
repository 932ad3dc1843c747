"""Common base of two cylindrical gears on parallel axes, internal or not: angles, backlash, path of contact.

Exact for rigid involute teeth. Sources: ISO 21771-1:2024, 5.3 (pair geometry) and 5.6 (backlash), whose formulas hold
for internal gears with their teeth, radii and centre distance counted negative. A slice of a helical pair at any height
is the spur pair of its transverse section, turned: lengths along the line of action there are 1/cos(beta_b) of those
along the normals.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from tol3d.errors import GeometryError
from tol3d.gears.cylindrical_gear import CylindricalGear
from tol3d.gears.flank import RIGHT_HAND
from tol3d.gears.involute import inverse_involute, involute
from tol3d.gears.pair import CONTACT_MARGIN, SAME_LENGTH, Displaced, RollingPair
from tol3d.numerics.arrays import Array


def crossed_axes(pinion: CylindricalGear, wheel: CylindricalGear) -> str:
    """Reason why two gears do not run together on parallel axes, by their helices; "" if they do.

    External gears lean against each other, a gear inside a ring leans as the ring does.
    """
    first, second = pinion.helix_angle, wheel.helix_angle
    if not math.isclose(first, second, rel_tol=SAME_LENGTH):
        angles = " and ".join(f"{math.degrees(angle):g} deg" for angle in (first, second))
        return f"gears on parallel axes need the same helix_angle, got {angles}: the axes would cross"
    inside = pinion.iso_sign != wheel.iso_sign
    if first and (pinion.hand == wheel.hand) != inside:
        hands = " and ".join("right" if gear.hand == RIGHT_HAND else "left" for gear in (pinion, wheel))
        need = "a helical gear and its ring need the same hand"
        if not inside:
            need = "external helical gears on parallel axes need opposite hands"
        return f"{need}, got {hands}: the axes would cross"
    return ""


class Backlashes(NamedTuple):
    """A backlash of a pair [mm]: ISO 21771's j_bn, j_wt, j_t and j_r.

    Args:
        normal: shortest distance of the flanks.
        working: arc on the working pitch circles of the nominal centre distance.
        reference: arc on the reference circles.
        radial: travel of the gears towards each other until both flanks touch; nan where they never would.
    """

    normal: float
    working: float
    reference: float
    radial: float


@dataclass(frozen=True)
class CylindricalPair(RollingPair):
    """Pinion (driver) and wheel (driven) at a centre distance [mm], which is positive."""

    pinion: CylindricalGear
    wheel: CylindricalGear
    centre_distance: float

    @property
    def iso_sign(self) -> int:
        """Sign of the centre distance in ISO 21771: -1 inside."""
        raise NotImplementedError

    @property
    def base_radii(self) -> float:
        """r_b1 + r_b2 [mm], an internal gear's counted negative."""
        return self.pinion.iso_sign * self.pinion.base_radius + self.wheel.iso_sign * self.wheel.base_radius

    @cached_property
    def working_pressure_angle(self) -> float:
        """alpha_wt with cos alpha_wt = (r_b1 + r_b2)/a [rad], in the transverse section."""
        return math.acos(self.iso_sign * self.base_radii / self.centre_distance)

    @property
    def working_radii(self) -> tuple[float, float]:
        """r_w of pinion and wheel [mm]: r_b / cos alpha_w."""
        cos = math.cos(self.working_pressure_angle)
        return self.pinion.base_radius / cos, self.wheel.base_radius / cos

    @property
    def base_helix_cosine(self) -> float:
        """cos beta_b, the same of both gears; 1 of spur gears."""
        return self.pinion.base_helix_cosine

    @property
    def common_face(self) -> float:
        """Width [mm] on which both gears have teeth; their face centres lie in one plane."""
        return min(self.pinion.face_width, self.wheel.face_width)

    # world --------------------------------------------------------------------------------------

    @property
    def world_from_wheel(self) -> Array:
        """Rotation (3, 3) of the wheel's frame at rest: none."""
        return np.eye(3)

    @property
    def opening_off_mesh(self) -> tuple[float, float]:
        """Away from the mate [rad]; the teeth of a ring leave it on the other side of them."""
        pinion, wheel = (math.pi if gear.iso_sign > 0 else 0.0 for gear in (self.pinion, self.wheel))
        return pinion, wheel

    @property
    def pinion_section(self) -> float:
        """The middle: the face centres lie in one plane."""
        return 0.5

    @property
    def arm_spread(self) -> float:
        """0: the arm of a turn is r_b over the whole face."""
        return 0.0

    @property
    def view_from_world(self) -> Array:
        """None (3, 3): one looks against z."""
        return np.eye(3)

    # backlash -----------------------------------------------------------------------------------

    @cached_property
    def zero_backlash_involute(self) -> float:
        """inv alpha_wt at which the teeth would touch on both flanks.

        From tooth + tooth = pitch on the working circle:
        inv alpha_t + [s_t1 + s_t2 - pi m_t] cos alpha_t / (2 (r_b1 + r_b2)).
        """
        alpha = self.pinion.transverse_pressure_angle
        thicker = self.pinion.tooth_thickness + self.wheel.tooth_thickness - math.pi * self.pinion.module
        thicker /= math.cos(self.pinion.helix_angle)
        return involute(alpha) + thicker * math.cos(alpha) / (2 * self.base_radii)

    @property
    def zero_backlash_centre_distance(self) -> float:
        """Centre distance [mm] without backlash; nan where there is none.

        External teeth may leave some even where the base circles touch, internal ones interfere at any distance then.
        """
        if self.zero_backlash_involute < 0.0:
            return math.nan
        return self.iso_sign * self.base_radii / math.cos(inverse_involute(self.zero_backlash_involute))

    @property
    def normal_backlash(self) -> float:
        """j_bn [mm], shortest distance of the non-working flanks; negative: the teeth interfere.

        2 (r_b1 + r_b2) cos beta_b (inv alpha_wt - inv alpha_w0), exact for parallel axes.
        """
        transverse = 2 * self.base_radii * (involute(self.working_pressure_angle) - self.zero_backlash_involute)
        return transverse * self.base_helix_cosine

    @property
    def circumferential_backlash(self) -> float:
        """j_wt = j_bn / (cos alpha_wt cos beta_b), free arc on the working pitch circles [mm]."""
        return self.normal_backlash / (math.cos(self.working_pressure_angle) * self.base_helix_cosine)

    @property
    def radial_backlash(self) -> float:
        """j_r [mm]: travel of the gears towards each other until both flanks touch; not j_wt/(2 tan alpha_w).

        External gears do so as the centre distance shrinks, internal ones as it grows.
        """
        return self.iso_sign * (self.centre_distance - self.zero_backlash_centre_distance)

    @property
    def angular_backlash(self) -> tuple[float, float]:
        """Free turn of the pinion (wheel held) and of the wheel (pinion held) [rad]: j_bn / (r_b cos beta_b)."""
        return self.normal_backlash / self.pinion.section_arm, self.normal_backlash / self.wheel.section_arm

    def further_with(self, normal: float) -> float:
        """Further distance of the axes [mm] at which these teeth have a normal backlash [mm]."""
        working = self.zero_backlash_involute + normal / (2 * self.base_radii * self.base_helix_cosine)
        return self.iso_sign * self.base_radii / math.cos(inverse_involute(working)) - self.centre_distance

    def from_normal(self, normal: float, further: float = 0.0) -> "Backlashes":
        """A normal backlash [mm] of other teeth in all the words of drawings, the axes so much further apart [mm].

        The arc is on the working circles of this pair, as the measure `circumferential_backlash` is in every build.
        """
        distance, transverse = self.centre_distance + further, normal / self.base_helix_cosine
        working = math.acos(self.iso_sign * self.base_radii / distance)
        tight, radial = involute(working) - transverse / (2 * self.base_radii), math.nan
        if tight >= 0.0:
            radial = self.iso_sign * distance - self.base_radii / math.cos(inverse_involute(tight))
        reference = transverse / math.cos(self.pinion.transverse_pressure_angle)
        return Backlashes(normal, transverse / math.cos(self.working_pressure_angle), reference, radial)

    # path of contact ------------------------------------------------------------------------------

    @property
    def start_roll(self) -> float:
        """Roll [rad] of the pinion's flank where the wheel's tip circle ends the path of contact on its root's side."""
        along = self.iso_sign * self.centre_distance * math.sin(self.working_pressure_angle)
        wheel = self.wheel.iso_sign * self.wheel.base_radius * self.wheel.tip_roll
        return (along - wheel) / (self.pinion.iso_sign * self.pinion.base_radius)

    @property
    def contact_ratio(self) -> float:
        """epsilon_alpha: length of the path of contact over the transverse base pitch."""
        return self.pinion.iso_sign * (self.pinion.tip_roll - self.start_roll) / self.pinion.angular_pitch

    @property
    def overlap_ratio(self) -> float:
        """epsilon_beta = b sin beta/(pi m_n) of the common face; 0 of spur gears."""
        return self.common_face * math.sin(self.pinion.helix_angle) / (math.pi * self.pinion.module)

    @property
    def total_contact_ratio(self) -> float:
        """epsilon_gamma = epsilon_alpha + epsilon_beta: contact lines in contact, floor of it or one more."""
        return self.contact_ratio + self.overlap_ratio

    @property
    def active_azimuths(self) -> tuple[float, float]:
        """A tooth at azimuth psi touches at the roll t = alpha_w + eta_b - sigma psi.

        Of a driving ring it is alpha_w - eta_b + sigma psi. The azimuth is that of the tooth at z = 0; a helical one
        stands kappa z further on at other heights.
        """
        return self._azimuths_over(self.common_face)

    def _azimuths_over(self, face: float) -> tuple[float, float]:
        sign = self.pinion.iso_sign
        at_pitch = sign * self.working_pressure_angle + self.pinion.base_half_angle
        leaning = abs(self.pinion.twist) * face / 2
        return at_pitch - sign * self.pinion.tip_roll - leaning, at_pitch - sign * self.start_roll + leaning

    @property
    def touching_azimuths(self) -> tuple[float, float]:
        """The path of contact over the pinion's face, along which the wheel may shift, and CONTACT_MARGIN."""
        lowest, highest = self._azimuths_over(self.pinion.face_width)
        margin = CONTACT_MARGIN * self.pinion.angular_pitch
        return lowest - margin, highest + margin

    def _refuse_short_contact(self) -> None:
        if self.contact_ratio + self.overlap_ratio >= 1.0:
            return
        words, faces = f"contact ratio {self.contact_ratio:.4f}", ""
        if self.overlap_ratio:
            words = f"total {words[:-6]}{self.total_contact_ratio:.4f} ({self.contact_ratio:.4f} over the profile)"
            least = self.common_face * (1.0 - self.contact_ratio) / self.overlap_ratio
            faces = f", on a common face narrower than {least:.4f} mm"
        raise GeometryError(
            f"{words} is below 1 at centre distance {self.centre_distance:g} mm: the teeth lose contact{faces}"
        )

    def _along(self, working: Array, displaced: Displaced) -> Array:
        """Half of the gap of the teeth along the line of action [mm], (rows,), at working pressure angles [rad]."""
        half_angles = sum(
            gear.base_radius * (gear.base_half_angle + displaced.flank_turn[:, k])
            for k, gear in enumerate((self.pinion, self.wheel))
        )
        return np.asarray(half_angles - self.base_radii * (np.tan(working) - working))
