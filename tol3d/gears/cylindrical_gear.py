"""Common base of external and internal involute cylindrical gears: circles, helix, tooth thickness, flanks.

Formulas are those of ISO 21771-1 with the sign of the number of teeth written out: +1 outside, -1 inside. Users and
properties have positive numbers. Module, pressure angle and tooth thickness are those of the normal section; circles,
rolls and points those of the transverse section at z = 0, in which a helical gear is a spur gear. At the height z that
section is turned by `twist` z. Of a spur gear both sections are one, to the last bit.
"""

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import Final

import numpy as np

from tol3d.errors import GeometryError
from tol3d.gears.flank import LEFT_HAND, RIGHT_HAND, Flank, Hand
from tol3d.gears.involute import involute
from tol3d.gears.toothed_gear import ToothedGear
from tol3d.numerics.arrays import Array

ISO53_ROOT_FILLET: Final = 0.38  # of the module; fillet of the standard basic rack, ISO 53:1998, profile A
FULL_ROUND_MARGIN: Final = 1e-9  # mm; two fillets of a space may touch, not overlap
STEEPEST_HELIX: Final = math.radians(60)  # of a gear on parallel axes; steeper ones are worms
SAME_LEAD: Final = 1e-9  # of a twist; gears drawn for one lead differ by the digits of their helix angles


@dataclass(frozen=True)
class CylindricalGear(ToothedGear):
    """A spur or helical gear, external or internal; arguments as there. Lengths in mm, angles in rad."""

    profile_shift: float = 0.0
    addendum: float = 1.0
    dedendum: float = 1.25
    root_fillet: float | None = None
    helix_angle: float = field(default=0.0, kw_only=True)
    hand: Hand = field(default=RIGHT_HAND, kw_only=True)

    @property
    def iso_sign(self) -> int:
        """Sign of the number of teeth, of all radii and of the centre distance in ISO 21771: -1 inside."""
        raise NotImplementedError

    def _refuse_fillet(self) -> None:
        if self.root_fillet is not None and not 0.0 < self.root_fillet <= self.full_round_fillet + FULL_ROUND_MARGIN:
            raise GeometryError(
                f"root_fillet: expected more than 0 and at most {self.full_round_fillet:.4f} mm "
                f"(the full round of the space), got {self.root_fillet:g} mm"
            )

    def _refuse_helix(self) -> None:
        if not 0.0 <= self.helix_angle <= STEEPEST_HELIX:
            raise GeometryError(
                f"helix_angle: expected 0 to {math.degrees(STEEPEST_HELIX):g} deg, "
                f"got {math.degrees(self.helix_angle):g} deg; the hand gives its sense"
            )
        if self.hand not in (RIGHT_HAND, LEFT_HAND):
            raise GeometryError(f"hand: expected 1 for a right-hand helix or -1 for a left-hand one, got {self.hand}")
        if self.face_width > self.lead / 2:
            raise GeometryError(
                f"face_width: expected at most half of the helix's lead, {self.lead / 2:.4f} mm, "
                f"got {self.face_width:g} mm"
            )

    # helix ------------------------------------------------------------------------------------

    @property
    def transverse_module(self) -> float:
        """m_t = m_n/cos beta [mm]."""
        return self.module / math.cos(self.helix_angle)

    @cached_property
    def transverse_pressure_angle(self) -> float:
        """alpha_t [rad], tan alpha_t = tan alpha_n/cos beta."""
        if self.helix_angle == 0.0:
            return self.pressure_angle
        return math.atan(math.tan(self.pressure_angle) / math.cos(self.helix_angle))

    @cached_property
    def base_helix_angle(self) -> float:
        """beta_b [rad], sin beta_b = sin beta cos alpha_n."""
        return math.asin(math.sin(self.helix_angle) * math.cos(self.pressure_angle))

    @cached_property
    def base_helix_cosine(self) -> float:
        """cos beta_b: of a length in the transverse section along the line of action, the part along the normal."""
        return math.cos(self.base_helix_angle)

    @property
    def twist(self) -> float:
        """kappa = h tan beta/r [rad/mm]: turn of the transverse section per height; 0 of a spur gear."""
        return self.hand * math.tan(self.helix_angle) / self.reference_radius

    @property
    def lead(self) -> float:
        """p_z = pi d/tan beta [mm]; inf of a spur gear."""
        return 2 * math.pi / abs(self.twist) if self.twist else math.inf

    # circles ----------------------------------------------------------------------------------

    @property
    def reference_radius(self) -> float:
        """r = m_t z/2 [mm]."""
        return self.transverse_module * self.teeth / 2

    @property
    def reference_diameter(self) -> float:
        """d = m_t z [mm]."""
        return self.transverse_module * self.teeth

    @cached_property
    def base_radius(self) -> float:
        """r_b = r cos alpha_t [mm]."""
        return self.reference_radius * math.cos(self.transverse_pressure_angle)

    @property
    def section_arm(self) -> float:
        """r_b cos beta_b [mm]: a turn by one over it moves a flank by 1 mm along its normal, in every section."""
        return self.base_radius * self.base_helix_cosine

    @property
    def thickness_radius(self) -> float:
        """r cos beta [mm]: the tooth thickness is an arc of the normal section at the reference circle."""
        return self.reference_radius * math.cos(self.helix_angle)

    @property
    def deviation_radius(self) -> float:
        """r cos beta [mm], as of the thickness."""
        return self.thickness_radius

    @property
    def pitch_angle(self) -> float:
        """0 [rad]: the gear is a cylinder."""
        return 0.0

    @property
    def base_diameter(self) -> float:
        """d_b [mm]."""
        return 2 * self.base_radius

    @property
    def tip_radius(self) -> float:
        """r_a = r + m_n (h_a* + x) [mm], inside r - m_n (h_a* + x)."""
        return self.reference_radius + self.iso_sign * self.module * (self.addendum + self.profile_shift)

    @property
    def tip_diameter(self) -> float:
        """d_a [mm]."""
        return 2 * self.tip_radius

    @property
    def root_radius(self) -> float:
        """r_f = r - m_n (h_f* - x) [mm], inside r + m_n (h_f* - x)."""
        return self.reference_radius - self.iso_sign * self.module * (self.dedendum - self.profile_shift)

    @property
    def root_diameter(self) -> float:
        """d_f [mm]."""
        return 2 * self.root_radius

    @property
    def base_pitch(self) -> float:
        """p_bn = pi m_n cos alpha_n [mm], along the normal."""
        return math.pi * self.module * math.cos(self.pressure_angle)

    @property
    def transverse_base_pitch(self) -> float:
        """p_bt = p_bn/cos beta_b [mm], along the line of action of a transverse section."""
        return self.base_pitch / self.base_helix_cosine

    # tooth thickness ----------------------------------------------------------------------------

    @property
    def tooth_thickness(self) -> float:
        """s_n = m_n (pi/2 + 2 x tan alpha_n) + deviation, arc of the normal section at the reference circle [mm]."""
        nominal = self.module * (math.pi / 2 + 2 * self.profile_shift * math.tan(self.pressure_angle))
        return nominal + self.tooth_thickness_deviation

    @cached_property
    def base_half_angle(self) -> float:
        """Half the angle [rad] that a tooth takes at the base circle: s_t/(2 r) + inv alpha_t, inside less inv alpha_t.

        s_t = s_n/cos beta is the arc in the transverse section. Flanks of an internal gear may meet before that: it is
        less than 0 then.
        """
        half = self.tooth_thickness / (2 * self.thickness_radius)
        return half + self.iso_sign * involute(self.transverse_pressure_angle)

    def pressure_angle_at(self, radius: float) -> float:
        """alpha_y with cos alpha_y = r_b / radius [rad]; 0 at and below the base circle."""
        return math.acos(min(1.0, self.base_radius / radius))

    def thickness_at(self, radius: float) -> float:
        """Tooth thickness as a transverse arc [mm] on the circle of that radius (radial flank below the base)."""
        return 2 * radius * (self.base_half_angle - self.iso_sign * involute(self.pressure_angle_at(radius)))

    @property
    def tip_thickness(self) -> float:
        """s_a, transverse arc at the tip circle [mm]."""
        return self.thickness_at(self.tip_radius)

    @property
    def normal_tip_thickness(self) -> float:
        """s_na = s_a cos beta_a [mm], tan beta_a = tan beta d_a/d."""
        return self.tip_thickness * math.cos(
            math.atan(math.tan(self.helix_angle) * self.tip_radius / self.reference_radius)
        )

    @property
    def section_thickness(self) -> float:
        """s_n [mm], the same in every section."""
        return self.tooth_thickness

    @property
    def section_tip(self) -> float:
        """s_a r cos beta/r_a [mm]: the arc at the reference circle that is as wide an angle as the tooth at its tip."""
        return self.tip_thickness * self.thickness_radius / self.tip_radius

    # roll -----------------------------------------------------------------------------------------

    def roll_at(self, radius: float) -> float:
        """Roll angle t = tan alpha_y [rad] of the flank at a radius; 0 at the base circle."""
        return math.tan(self.pressure_angle_at(radius))

    @cached_property
    def tip_roll(self) -> float:
        """Roll angle at the tip circle [rad]."""
        return self.roll_at(self.tip_radius)

    @property
    def form_roll(self) -> float:
        """Roll angle [rad] at which the fillet takes the involute over."""
        raise NotImplementedError

    @property
    def form_radius(self) -> float:
        """Radius [mm] at which the fillet takes the involute over."""
        return self.base_radius * math.hypot(1.0, self.form_roll)

    def _beta(self, roll: Array, flank: Flank) -> Array:
        """Azimuth [rad] at which the string touches the base circle."""
        return self.iso_sign * flank * (roll - self.iso_sign * self.base_half_angle)

    def flank_points(self, roll: Array, flank: Flank) -> Array:
        """Points of a flank of tooth 0 in the transverse plane, gear frame.

        Args:
            roll: roll angles [rad], shape (n,), 0 at the base circle.
            flank: RIGHT or LEFT.

        Returns:
            (n, 2) [mm]. P = r_b [(cos beta, sin beta) + sigma t (sin beta, -cos beta)],
            beta = sigma (t - eta_b): the string unwound from the base circle. Inside, sigma is that of the flank of
            the space, the other one, and eta_b counts negative.
        """
        beta, side = self._beta(roll, flank), self.iso_sign * flank
        cos, sin = np.cos(beta), np.sin(beta)
        return self.base_radius * np.stack([cos + side * roll * sin, sin - side * roll * cos], axis=-1)

    def flank_normals(self, roll: Array, flank: Flank) -> Array:
        """Unit normals out of the tooth at those points, shape (n, 2): sigma (sin beta, -cos beta)."""
        beta = self._beta(roll, flank)
        return np.stack([flank * np.sin(beta), -flank * np.cos(beta)], axis=-1)

    # root -----------------------------------------------------------------------------------------

    @property
    def full_round_fillet(self) -> float:
        """Largest fillet radius [mm]: one arc from flank to flank, touching the root circle."""
        raise NotImplementedError

    @cached_property
    def fillet_radius(self) -> float:
        """The fillet in use [mm]: the stated one, or ISO 53's, or the full round where that is smaller."""
        if self.root_fillet is not None:
            return self.root_fillet
        return min(ISO53_ROOT_FILLET * self.module, self.full_round_fillet)

    def _fillet_azimuth(self, radius: float) -> float:
        """Azimuth [rad] of the fillet's centre off the tooth's middle, for an arc of that radius."""
        raise NotImplementedError

    def fillet_centre(self, flank: Flank) -> tuple[float, float]:
        """Centre (x, y) [mm] of the fillet arc below a flank of tooth 0."""
        centre = self.root_radius + self.iso_sign * self.fillet_radius
        azimuth = -flank * self._fillet_azimuth(self.fillet_radius)
        return centre * math.cos(azimuth), centre * math.sin(azimuth)

    def fillet_top(self, flank: Flank) -> tuple[float, float]:
        """Point where the fillet leaves the flank, (x, y) [mm]."""
        x, y = self.flank_points(np.array([self.form_roll]), flank)[0]
        return float(x), float(y)

    def fillet_bottom(self, flank: Flank) -> tuple[float, float]:
        """Point where the fillet meets the root circle, (x, y) [mm]."""
        azimuth = -flank * self._fillet_azimuth(self.fillet_radius)
        return self.root_radius * math.cos(azimuth), self.root_radius * math.sin(azimuth)

    @property
    def root_arc(self) -> float:
        """Arc [mm] of the root circle between the two fillets of a space; 0 at the full round."""
        return 2 * self.root_radius * max(0.0, math.pi / self.teeth - self._fillet_azimuth(self.fillet_radius))

    @cached_property
    def outline_area(self) -> float:
        """Area [mm^2] within the outline of the teeth: exact, by Green's theorem.

        Half the sum of x dy - y dx along tip arc, involute, radial line, fillet and root arc; the
        involute's share is r_b^2 (t_a^3 - t_f^3)/6 for each flank.
        """
        tip_half = self.base_half_angle - self.iso_sign * (self.tip_roll - math.atan(self.tip_roll))
        tip_arc = self.tip_radius**2 * 2 * tip_half / 2
        flanks = 2 * self.base_radius**2 * self.iso_sign * (self.tip_roll**3 - self.form_roll**3) / 6
        root = self.root_radius * self.root_arc / 2
        return self.teeth * (tip_arc + flanks + root + 2 * self._fillet_sector())

    def _fillet_sector(self) -> float:
        """1/2 of the integral of x dy - y dx [mm^2] along the fillet of a left flank, from flank to root."""
        (cx, cy), radius = self.fillet_centre(-1), self.fillet_radius
        (ax, ay), (bx, by) = self.fillet_top(-1), self.fillet_bottom(-1)
        start = math.atan2(ay - cy, ax - cx)
        turn = math.remainder(math.atan2(by - cy, bx - cx) - start, 2 * math.pi)
        return (radius**2 * turn + cx * (by - ay) - cy * (bx - ax)) / 2
