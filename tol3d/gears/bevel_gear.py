"""One straight bevel gear with spherical-involute flanks: cones, tooth thickness, flank.

Gear frame: apex at the origin, z the axis towards the heel, x through the middle of tooth 0. A tooth is a cone:
every length in it is proportional to the distance from the apex, so most of the geometry is in angles.
Sources: ISO 23509:2016 for words, cones and diameters; the flank is worked out on the sphere, from the
rolling plane, where others (Jiang et al., J. Zhejiang Univ. (Eng. Sci.) 58(8), 2024, section 3) take the imaginary
spur gear of the back cone.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, Final

from tol3d.errors import GeometryError
from tol3d.gears.flank import Flank
from tol3d.gears.spherical_involute import (
    flank_directions,
    flank_normals,
    in_plane_angle,
    inverse_spherical_involute,
    spherical_involute,
)
from tol3d.gears.toothed_gear import PRESSURE_ANGLES, ToothedGear
from tol3d.gears.undercut import RACK_ADDENDUM, crown_rack_undercut_angle
from tol3d.numerics.arrays import Array


def pitch_angles(pinion_teeth: int, wheel_teeth: int, shaft_angle: float) -> tuple[float, float]:
    """Pitch angles [rad] of pinion and wheel: tan(delta_1) = sin(Sigma)/(z_2/z_1 + cos(Sigma)).

    Raises:
        GeometryError: the shaft angle [rad] is not between 0 and 180 deg, or a pitch cone would be flat or hollow.

    >>> [round(math.degrees(angle), 4) for angle in pitch_angles(17, 43, math.radians(90))]
    [21.5713, 68.4287]
    """
    degrees = math.degrees(shaft_angle)
    if not 0.0 < shaft_angle < math.pi:
        raise GeometryError(f"shaft_angle: expected more than 0 and less than 180 deg, got {degrees:g} deg")
    sin, cos = math.sin(shaft_angle), math.cos(shaft_angle)
    pinion = math.atan2(sin, wheel_teeth / pinion_teeth + cos)
    wheel = math.atan2(sin, pinion_teeth / wheel_teeth + cos)
    for name, angle in (("driver", pinion), ("driven", wheel)):
        if angle >= math.pi / 2:
            raise GeometryError(
                f"shaft_angle {degrees:g} deg: with {pinion_teeth} and {wheel_teeth} teeth the {name} gear's pitch "
                f"angle would be {math.degrees(angle):.4f} deg, expected less than 90 deg"
            )
    return pinion, wheel


PITCH_ANGLES: Final = (0.01, 89.99)  # deg
LONGEST_FACE = 0.9  # of the outer cone distance; common practice stops at a third


@dataclass(frozen=True)
class BevelGear(ToothedGear):
    """A straight bevel gear by the words of ISO 23509; lengths in mm, angles in rad. Its depth tapers to the apex.

    Args:
        teeth: number of teeth z, at least 3.
        module: m [mm] at the outer end, on the back cone.
        pressure_angle: alpha on the pitch cone [rad].
        face_width: b [mm], from the heel towards the apex.
        pitch_angle: delta [rad], of the pitch cone; see pitch_angles.
        profile_shift: coefficient x, in modules; tooth and space change by 2 x m tan(alpha), tip and root by x m.
        addendum, dedendum: factors h_a*, h_f* of the module, at the outer end.
        bore: diameter [mm]; 0 means none.
        tooth_thickness_deviation: added to the nominal arc on the pitch cone at the outer end [mm], half on
            each flank, in proportion along the face; positive is thicker.

    Raises:
        GeometryError: the gear cannot be made; the text carries the numbers.

    >>> gear = BevelGear(31, 3.5, math.radians(20), 9.0, math.radians(45))
    >>> round(gear.outer_cone_distance, 6), round(math.degrees(gear.base_angle), 6)
    (76.721086, 41.641143)
    """

    lengths: ClassVar[tuple[str, ...]] = (*ToothedGear.lengths, "bore")

    pitch_angle: float
    profile_shift: float = 0.0
    addendum: float = 1.0
    dedendum: float = 1.25
    bore: float = 0.0
    tooth_thickness_deviation: float = 0.0

    def __post_init__(self) -> None:
        self._refuse_unmakeable()

    def _refuse_unmakeable(self) -> None:
        self._refuse_sizes({"pressure_angle": PRESSURE_ANGLES, "pitch_angle": PITCH_ANGLES})
        longest = LONGEST_FACE * self.outer_cone_distance
        if not self.face_width <= longest:
            raise GeometryError(
                f"face_width: expected at most {longest:.4f} mm, {LONGEST_FACE:g} of the outer cone distance "
                f"({self.outer_cone_distance:.4f} mm), got {self.face_width:g} mm: the teeth would reach the apex"
            )
        self._refuse_cones()
        if not 0.0 <= self.bore < self.inner_root_diameter:
            raise GeometryError(
                f"bore: expected less than the root circle at the toe ({self.inner_root_diameter:.4f} mm), "
                f"got {self.bore:g} mm"
            )

    def _refuse_cones(self) -> None:
        tip, root, base = (math.degrees(angle) for angle in (self.tip_angle, self.root_angle, self.base_angle))
        if not 0.0 < root < tip < 90.0:
            raise GeometryError(
                f"the tip cone ({tip:.4f} deg) must lie outside the root cone ({root:.4f} deg), that above 0 and "
                "the tip cone below 90 deg: look at addendum, dedendum, profile_shift, pitch_angle"
            )
        if tip <= base:
            raise GeometryError(
                f"no involute is left: the tip cone ({tip:.4f} deg) lies inside the base cone ({base:.4f} deg)"
            )
        if self.tip_thickness <= 0.0:
            raise GeometryError(
                f"pointed teeth: the tooth thickness at the outer tip circle ({self.tip_diameter:.4f} mm) is "
                f"{self.tip_thickness:.4f} mm; flanks meet at {math.degrees(self.pointed_angle):.4f} deg, the tip cone "
                f"is at {tip:.4f} deg: lower addendum or profile_shift"
            )
        if self.half_angle_at(self.root_angle) >= math.pi / self.teeth:
            raise GeometryError("no tooth space is left at the root cone: look at dedendum, profile_shift")

    # cone distances and circles -----------------------------------------------------------------

    @property
    def twist(self) -> float:
        """0 [rad/mm]: the teeth are straight."""
        return 0.0

    @cached_property
    def outer_cone_distance(self) -> float:
        """R_e = m z/(2 sin delta) [mm], from the apex to the heel along the pitch cone."""
        return self.module * self.teeth / (2 * math.sin(self.pitch_angle))

    @property
    def inner_cone_distance(self) -> float:
        """R_i = R_e - b [mm], to the toe."""
        return self.outer_cone_distance - self.face_width

    @property
    def mean_cone_distance(self) -> float:
        """R_m = R_e - b/2 [mm], to the middle of the face."""
        return self.outer_cone_distance - self.face_width / 2

    @property
    def mean_radius(self) -> float:
        """r_m = R_m sin delta [mm], of the pitch cone at the middle of the face."""
        return self.mean_cone_distance * math.sin(self.pitch_angle)

    @property
    def base_radius(self) -> float:
        """R_e sin beta [mm]: arm with which a turn about the gear's axis moves its flank's heel along the normal."""
        return self.outer_cone_distance * math.sin(self.base_angle)

    @property
    def section_arm(self) -> float:
        """R_m sin beta [mm]: that arm in the middle of the face."""
        return self.mean_cone_distance * math.sin(self.base_angle)

    @property
    def thickness_radius(self) -> float:
        """r_m [mm]: a deviation of the tooth thickness is an arc on the pitch cone in the middle of the face."""
        return self.mean_radius

    @property
    def tip_radius(self) -> float:
        """r_e + m (h_a* + x) cos delta [mm], largest radius, at the outer end."""
        return self.reference_radius + self.module * (self.addendum + self.profile_shift) * math.cos(self.pitch_angle)

    @property
    def tip_diameter(self) -> float:
        """d_ae [mm], at the outer end."""
        return 2 * self.tip_radius

    @property
    def root_radius(self) -> float:
        """r_e - m (h_f* - x) cos delta [mm], of the root cone at the outer end."""
        return self.reference_radius - self.module * (self.dedendum - self.profile_shift) * math.cos(self.pitch_angle)

    @property
    def root_diameter(self) -> float:
        """d_fe [mm], at the outer end."""
        return 2 * self.root_radius

    @property
    def inner_root_diameter(self) -> float:
        """Diameter [mm] of the root cone at the toe."""
        return self.root_diameter * self.inner_cone_distance / self.outer_cone_distance

    # cones ----------------------------------------------------------------------------------------

    @cached_property
    def base_angle(self) -> float:
        """beta with sin beta = sin delta cos alpha [rad]."""
        return math.asin(math.sin(self.pitch_angle) * math.cos(self.pressure_angle))

    @property
    def tip_angle(self) -> float:
        """delta_a = delta + atan(m (h_a* + x)/R_e) [rad]."""
        height = self.module * (self.addendum + self.profile_shift)
        return self.pitch_angle + math.atan(height / self.outer_cone_distance)

    @property
    def root_angle(self) -> float:
        """delta_f = delta - atan(m (h_f* - x)/R_e) [rad]."""
        depth = self.module * (self.dedendum - self.profile_shift)
        return self.pitch_angle - math.atan(depth / self.outer_cone_distance)

    @property
    def base_pitch_angle(self) -> float:
        """p_b = 2 pi sin(beta)/z [rad], from flank to flank in the rolling plane; R p_b is an arc."""
        return self.angular_pitch * math.sin(self.base_angle)

    @property
    def base_pitch(self) -> float:
        """R_m p_b [mm], arc from flank to flank in the middle of the face."""
        return self.mean_cone_distance * self.base_pitch_angle

    # tooth thickness ----------------------------------------------------------------------------

    @property
    def tooth_thickness(self) -> float:
        """s = m (pi/2 + 2 x tan alpha) + deviation, arc on the pitch cone at the outer end [mm]."""
        nominal = self.module * (math.pi / 2 + 2 * self.profile_shift * math.tan(self.pressure_angle))
        return nominal + self.tooth_thickness_deviation

    @property
    def mean_tooth_thickness(self) -> float:
        """s_m = s R_m/R_e, arc on the pitch cone in the middle of the face [mm]."""
        return self.tooth_thickness * self.mean_cone_distance / self.outer_cone_distance

    @property
    def pitch_half_angle(self) -> float:
        """Half the angle [rad] about the axis that a tooth takes on the pitch cone: s/(2 r_e)."""
        return self.tooth_thickness / (2 * self.reference_radius)

    @cached_property
    def base_half_angle(self) -> float:
        """Half the angle [rad] about the axis that a tooth takes on the base cone: s/(2 r_e) + inv delta."""
        return self.pitch_half_angle + float(spherical_involute(self.pitch_angle, self.base_angle))

    def half_angle_at(self, polar: float) -> float:
        """Half the angle [rad] that a tooth takes at a polar angle (meridian flank below the base cone)."""
        return self.base_half_angle - float(spherical_involute(polar, self.base_angle))

    @property
    def tip_thickness(self) -> float:
        """s_ae, arc on the tip circle at the outer end [mm]."""
        return 2 * self.tip_radius * self.half_angle_at(self.tip_angle)

    @property
    def section_thickness(self) -> float:
        """s_m [mm], in the middle of the face."""
        return self.mean_tooth_thickness

    @property
    def section_tip(self) -> float:
        """s_ae r_m/r_ae [mm]: the arc in the middle of the face that is as wide an angle as the tooth at its tip."""
        return self.tip_thickness * self.mean_radius / self.tip_radius

    @property
    def pointed_angle(self) -> float:
        """Polar angle [rad] at which both flanks of a tooth would meet; pi/2 where they do not up to there."""
        if self.base_half_angle >= float(spherical_involute(math.pi / 2, self.base_angle)):
            return math.pi / 2
        return inverse_spherical_involute(self.base_half_angle, self.base_angle)

    # flank ----------------------------------------------------------------------------------------

    def q_at(self, polar: float) -> float:
        """In-plane angle q of the flank at a polar angle [rad], cos q = cos(polar)/cos(beta); 0 below the base cone."""
        return float(in_plane_angle(polar, self.base_angle))

    @cached_property
    def pitch_q(self) -> float:
        """In-plane angle on the pitch cone [rad]; sin q = sin(alpha) sin(delta)/cos(beta)."""
        return self.q_at(self.pitch_angle)

    @cached_property
    def tip_q(self) -> float:
        """In-plane angle on the tip cone [rad]."""
        return self.q_at(self.tip_angle)

    @cached_property
    def form_q(self) -> float:
        """In-plane angle [rad] at which the involute begins: on the root cone, or 0 on the base cone."""
        return self.q_at(self.root_angle)

    def flank_start(self, flank: Flank) -> float:
        """Azimuth [rad] at which a flank of tooth 0 leaves the base cone: -sigma times the base half angle."""
        return -flank * self.base_half_angle

    def flank_directions(self, q: Array, flank: Flank) -> Array:
        """Unit vectors from the apex to a flank of tooth 0 at in-plane angles q [rad]: (...) to (..., 3)."""
        return flank_directions(q, self.base_angle, self.flank_start(flank), flank)

    def flank_normals(self, q: Array, flank: Flank) -> Array:
        """Unit normals out of the tooth there, (..., 3); the same along the whole face."""
        return flank_normals(q, self.base_angle, self.flank_start(flank), flank)

    # undercut -------------------------------------------------------------------------------------

    @property
    def undercut_limit_shift(self) -> float:
        """Smallest profile shift without undercut by a crown rack of addendum 1.

        The crown gear's tip cone, eta below the pitch plane, leaves the plane of action asin(sin eta/sin alpha)
        from the pitch point, and the flank ends pitch_q from it, so sin eta = sin^2(alpha) sin(delta)/cos(beta),
        tan eta = m (1 - x)/R_e. The equivalent spur gear of Tredgold, z/cos(delta) teeth, has
        sin^2(alpha) tan(delta) there: the same for small cones, 5 % more at 45 deg.
        """
        sine = math.sin(self.pressure_angle) * math.sin(self.pitch_q)
        return RACK_ADDENDUM - math.tan(math.asin(sine)) * self.outer_cone_distance / self.module

    @cached_property
    def undercut_angle(self) -> float:
        """Polar angle [rad] below which a crown rack of addendum 1 would cut the involute away.

        The base angle where there is no undercut.
        """
        if self.profile_shift >= self.undercut_limit_shift:
            return self.base_angle
        eta = math.atan(self.module * (RACK_ADDENDUM - self.profile_shift) / self.outer_cone_distance)

        def flank_at(polar: float) -> float:
            return self.pitch_half_angle - self.half_angle_at(polar)

        ends = (self.base_angle, self.tip_angle)
        return crown_rack_undercut_angle(self.pressure_angle, self.pitch_angle, eta, ends, flank_at)
