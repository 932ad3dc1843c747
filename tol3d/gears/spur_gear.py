"""One external involute spur or helical gear: allowed sizes, root fillet, undercut."""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

from tol3d.errors import GeometryError
from tol3d.gears.cylindrical_gear import CylindricalGear
from tol3d.gears.flank import Flank
from tol3d.gears.involute import involute
from tol3d.gears.toothed_gear import PRESSURE_ANGLES, ToothedGear
from tol3d.gears.undercut import RACK_ADDENDUM, rack_undercut_radius


def fillet_azimuth(radius: float, root_radius: float, base_radius: float, base_half_angle: float) -> float:
    """Azimuth [rad] of the fillet's centre off the tooth's middle.

    An offset of an involute is the same involute turned, so the centre of an arc that touches flank and root circle is
    in closed form: on the involute of roll t + radius/r_b. Where the arc would touch below the base circle it touches
    the radial line instead.

    Args:
        radius: of the fillet [mm].
        root_radius, base_radius: of the gear [mm].
        base_half_angle: half a tooth at the base circle [rad].
    """
    centre = root_radius + radius
    beyond = centre**2 - base_radius**2
    if beyond > radius**2:
        along = math.sqrt(beyond)
        roll = (along - radius) / base_radius
        return base_half_angle - roll + math.atan2(along, base_radius)
    return base_half_angle + math.asin(radius / centre)


@dataclass(frozen=True)
class SpurGear(CylindricalGear):
    """An external spur or helical gear by the words of ISO 21771-1; lengths in mm, angles in rad.

    Args:
        teeth: number of teeth z, at least 3.
        module: m [mm], of a helical gear the normal module m_n.
        pressure_angle: alpha at the reference circle [rad], of a helical gear alpha_n in the normal section.
        face_width: b [mm].
        profile_shift: coefficient x, in modules.
        addendum, dedendum: factors h_a*, h_f* of the module.
        root_fillet: radius [mm] of the arc between flank and root circle; None takes the 0.38 m
            of ISO 53, or the full round of the space where that is smaller.
        bore: diameter [mm]; 0 means none.
        tooth_thickness_deviation: added to the nominal arc at the reference circle [mm], of a helical gear in the
            normal section (E_sn), half on each flank; positive is thicker.
        helix_angle: beta at the reference cylinder [rad]; 0 is a spur gear.
        hand: of the helix, RIGHT_HAND or LEFT_HAND.

    Raises:
        GeometryError: the gear cannot be made; the text carries the numbers.

    >>> wheel = SpurGear(teeth=110, module=2.5, pressure_angle=math.radians(20), face_width=20.0)
    >>> wheel.reference_diameter, round(wheel.base_diameter, 6), wheel.tip_diameter
    (275.0, 258.415471, 280.0)
    """

    lengths: ClassVar[tuple[str, ...]] = (*ToothedGear.lengths, "root_fillet", "bore")

    bore: float = 0.0
    tooth_thickness_deviation: float = 0.0

    def __post_init__(self) -> None:
        self._refuse_unmakeable()

    def _refuse_unmakeable(self) -> None:
        self._refuse_sizes({"pressure_angle": PRESSURE_ANGLES})
        self._refuse_helix()
        if not self.root_radius > 0.0 or not self.tip_radius > self.root_radius:
            raise GeometryError(
                f"the tip circle ({self.tip_diameter:.4f} mm) must lie outside the root circle "
                f"({self.root_diameter:.4f} mm), and that above zero: look at addendum, dedendum, profile_shift"
            )
        if self.tip_radius <= self.base_radius:
            raise GeometryError(
                f"no involute is left: the tip circle ({self.tip_diameter:.4f} mm) lies inside "
                f"the base circle ({self.base_diameter:.4f} mm)"
            )
        if self.tip_thickness <= 0.0:
            raise GeometryError(
                f"pointed teeth: the tooth thickness at the tip circle ({self.tip_diameter:.4f} mm) is "
                f"{self.tip_thickness:.4f} mm; flanks meet at {2 * self.pointed_radius:.4f} mm: "
                f"lower addendum below {self._pointed_addendum:.4f}, or profile_shift"
            )
        if not 0.0 <= self.bore < self.root_diameter:
            raise GeometryError(
                f"bore: expected less than the root circle ({self.root_diameter:.4f} mm), got {self.bore:g} mm"
            )
        if self.full_round_fillet <= 0.0:
            raise GeometryError("no tooth space is left at the root circle: look at dedendum, profile_shift")
        self._refuse_fillet()
        if self.form_radius >= self.tip_radius:
            raise GeometryError("root_fillet: it eats the whole flank; choose a smaller one")

    @property
    def iso_sign(self) -> int:
        """+1."""
        return 1

    @property
    def pointed_radius(self) -> float:
        """Radius [mm] at which both flanks of a tooth would meet."""
        from_angle = max(self.base_half_angle, 0.0)
        low, high = 0.0, math.pi / 2 - 1e-9
        for _ in range(200):
            middle = (low + high) / 2
            low, high = (middle, high) if involute(middle) < from_angle else (low, middle)
        return self.base_radius / math.cos(low)

    @property
    def _pointed_addendum(self) -> float:
        """Addendum whose tip circle is where both flanks of a tooth would meet."""
        return (self.pointed_radius - self.reference_radius) / self.module - self.profile_shift

    @cached_property
    def form_roll(self) -> float:
        """Roll angle [rad] at which the involute begins: where the fillet ends, or 0 at the base circle."""
        radius = self.fillet_radius
        beyond = (self.root_radius + radius) ** 2 - self.base_radius**2
        if beyond <= radius**2:
            return 0.0
        return (math.sqrt(beyond) - radius) / self.base_radius

    # root -----------------------------------------------------------------------------------------

    @cached_property
    def full_round_fillet(self) -> float:
        """Largest fillet radius [mm]: one arc from flank to flank, touching the root circle."""
        low, high = 0.0, self.reference_radius
        for _ in range(200):
            middle = (low + high) / 2
            low, high = (middle, high) if self._fillet_azimuth(middle) < math.pi / self.teeth else (low, middle)
        return low

    def _fillet_azimuth(self, radius: float) -> float:
        """Azimuth [rad] of the fillet's centre off the tooth's middle, for an arc of that radius."""
        return fillet_azimuth(radius, self.root_radius, self.base_radius, self.base_half_angle)

    def fillet_top(self, flank: Flank) -> tuple[float, float]:
        """Point where the fillet leaves the flank (involute or radial line), (x, y) [mm]."""
        if self.form_roll > 0.0:
            return super().fillet_top(flank)
        radius = math.sqrt((self.root_radius + self.fillet_radius) ** 2 - self.fillet_radius**2)
        azimuth = -flank * self.base_half_angle
        return radius * math.cos(azimuth), radius * math.sin(azimuth)

    @property
    def transverse_area(self) -> float:
        """Area [mm^2] of the toothed section without the bore: exact."""
        return self.outline_area

    # undercut -------------------------------------------------------------------------------------

    @property
    def undercut_limit_shift(self) -> float:
        """Smallest profile shift without undercut by a rack of addendum 1: x = 1 - z sin^2(alpha_t)/(2 cos beta)."""
        return RACK_ADDENDUM - self.teeth * math.sin(self.transverse_pressure_angle) ** 2 / (
            2 * math.cos(self.helix_angle)
        )

    @cached_property
    def undercut_radius(self) -> float:
        """Radius [mm] below which a rack of addendum 1 would cut the involute away; the base circle if none."""
        if self.profile_shift >= self.undercut_limit_shift:
            return self.base_radius
        depth = self.module * (RACK_ADDENDUM - self.profile_shift)
        ends = (self.base_radius, self.tip_radius)
        return rack_undercut_radius(
            self.transverse_pressure_angle, self.reference_radius, depth, ends, self.pressure_angle_at
        )

    def refuse_undercut(self, start: float, name: str, where: str) -> None:
        """Raise where a rack of addendum 1 would cut into the flank in use.

        Args:
            start: radius [mm] at which contact begins.
            name: of the gear, in words.
            where: contact begins, in words.

        Raises:
            GeometryError: with the radii and the profile shift that would do.
        """
        if start < self.undercut_radius:
            raise GeometryError(
                f"undercut reaches the flank in use: a rack of addendum 1 cuts the {name} gear's involute up to "
                f"{2 * self.undercut_radius:.4f} mm, contact begins {where}; give "
                f"profile_shift of at least {self.undercut_limit_shift:.4f} (it has {self.profile_shift:g})"
            )
