"""One external involute spur gear: circles, tooth thickness, flank, root fillet."""

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import NDArray

from tol3d.errors import GeometryError
from tol3d.gears.flank import Flank
from tol3d.gears.involute import involute
from tol3d.gears.root_fillet import fillet_azimuth
from tol3d.gears.undercut import RACK_ADDENDUM, rack_undercut_radius

Array = NDArray[np.float64]

ISO53_ROOT_FILLET = 0.38  # of the module; fillet of the standard basic rack, ISO 53:1998, profile A
FULL_ROUND_MARGIN = 1e-9  # mm; two fillets of a space may touch, not overlap


@dataclass(frozen=True)
class SpurGear:
    """An external spur gear by the words of ISO 21771-1; lengths in mm, angles in rad.

    Args:
        teeth: number of teeth z, at least 3.
        module: m [mm].
        pressure_angle: alpha at the reference circle [rad].
        face_width: b [mm].
        profile_shift: coefficient x, in modules.
        addendum, dedendum: factors h_a*, h_f* of the module.
        root_fillet: radius [mm] of the arc between flank and root circle; None takes the 0.38 m
            of ISO 53, or the full round of the space where that is smaller.
        bore: diameter [mm]; 0 means none.
        tooth_thickness_deviation: added to the nominal arc at the reference circle [mm],
            half on each flank; positive is thicker.

    Raises:
        GeometryError: the gear cannot be made; the text carries the numbers.

    >>> wheel = SpurGear(teeth=110, module=2.5, pressure_angle=math.radians(20), face_width=20.0)
    >>> wheel.reference_diameter, round(wheel.base_diameter, 6), wheel.tip_diameter
    (275.0, 258.415471, 280.0)
    """

    teeth: int
    module: float
    pressure_angle: float
    face_width: float
    profile_shift: float = 0.0
    addendum: float = 1.0
    dedendum: float = 1.25
    root_fillet: float | None = None
    bore: float = 0.0
    tooth_thickness_deviation: float = 0.0

    def __post_init__(self) -> None:
        self._refuse_unmakeable()

    def _refuse_unmakeable(self) -> None:
        if self.teeth < 3:
            raise GeometryError(f"teeth: expected at least 3, got {self.teeth}")
        for name in ("module", "face_width"):
            if not getattr(self, name) > 0.0:
                raise GeometryError(f"{name}: expected more than 0 mm, got {getattr(self, name):g} mm")
        if not math.radians(5) <= self.pressure_angle <= math.radians(45):
            degrees = math.degrees(self.pressure_angle)
            raise GeometryError(f"pressure_angle: expected 5 to 45 deg, got {degrees:g} deg")
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
                "lower addendum or profile_shift"
            )
        if not 0.0 <= self.bore < self.root_diameter:
            raise GeometryError(
                f"bore: expected less than the root circle ({self.root_diameter:.4f} mm), got {self.bore:g} mm"
            )
        if self.full_round_fillet <= 0.0:
            raise GeometryError("no tooth space is left at the root circle: look at dedendum, profile_shift")
        if self.root_fillet is not None and not 0.0 < self.root_fillet <= self.full_round_fillet + FULL_ROUND_MARGIN:
            raise GeometryError(
                f"root_fillet: expected more than 0 and at most {self.full_round_fillet:.4f} mm "
                f"(the full round of the space), got {self.root_fillet:g} mm"
            )
        if self.form_radius >= self.tip_radius:
            raise GeometryError("root_fillet: it eats the whole flank; choose a smaller one")

    # circles ----------------------------------------------------------------------------------

    @property
    def reference_radius(self) -> float:
        """r = m z / 2 [mm]."""
        return self.module * self.teeth / 2

    @property
    def reference_diameter(self) -> float:
        """d = m z [mm]."""
        return self.module * self.teeth

    @cached_property
    def base_radius(self) -> float:
        """r_b = r cos alpha [mm]."""
        return self.reference_radius * math.cos(self.pressure_angle)

    @property
    def section_arm(self) -> float:
        """r_b [mm], the same in every section."""
        return self.base_radius

    @property
    def thickness_radius(self) -> float:
        """r [mm]: the tooth thickness is an arc at the reference circle."""
        return self.reference_radius

    @property
    def pitch_angle(self) -> float:
        """0 [rad]: a spur gear is a cylinder."""
        return 0.0

    @property
    def base_diameter(self) -> float:
        """d_b [mm]."""
        return 2 * self.base_radius

    @property
    def tip_radius(self) -> float:
        """r_a = r + m (h_a* + x) [mm]."""
        return self.reference_radius + self.module * (self.addendum + self.profile_shift)

    @property
    def tip_diameter(self) -> float:
        """d_a [mm]."""
        return 2 * self.tip_radius

    @property
    def root_radius(self) -> float:
        """r_f = r - m (h_f* - x) [mm]."""
        return self.reference_radius - self.module * (self.dedendum - self.profile_shift)

    @property
    def root_diameter(self) -> float:
        """d_f [mm]."""
        return 2 * self.root_radius

    @property
    def base_pitch(self) -> float:
        """p_b = pi m cos alpha [mm]."""
        return math.pi * self.module * math.cos(self.pressure_angle)

    @property
    def angular_pitch(self) -> float:
        """2 pi / z [rad]."""
        return 2 * math.pi / self.teeth

    def perturbed(self, flank_turn: float, scale: float) -> Self:
        """The gear with its flanks turned out of their teeth [rad], and grown.

        Raises:
            GeometryError: such a gear cannot be made.
        """
        thicker = self.tooth_thickness_deviation + 2 * self.reference_radius * flank_turn
        return replace(
            self,
            module=self.module * scale,
            face_width=self.face_width * scale,
            root_fillet=None if self.root_fillet is None else self.root_fillet * scale,
            bore=self.bore * scale,
            tooth_thickness_deviation=thicker * scale,
        )

    # tooth thickness ----------------------------------------------------------------------------

    @property
    def tooth_thickness(self) -> float:
        """s = m (pi/2 + 2 x tan alpha) + deviation, arc at the reference circle [mm]."""
        nominal = self.module * (math.pi / 2 + 2 * self.profile_shift * math.tan(self.pressure_angle))
        return nominal + self.tooth_thickness_deviation

    @cached_property
    def base_half_angle(self) -> float:
        """Half the angle [rad] that a tooth takes at the base circle: s/(2 r) + inv alpha."""
        return self.tooth_thickness / (2 * self.reference_radius) + involute(self.pressure_angle)

    def pressure_angle_at(self, radius: float) -> float:
        """alpha_y with cos alpha_y = r_b / radius [rad]; 0 at and below the base circle."""
        return math.acos(min(1.0, self.base_radius / radius))

    def thickness_at(self, radius: float) -> float:
        """Tooth thickness as an arc [mm] on the circle of that radius (radial flank below the base)."""
        return 2 * radius * (self.base_half_angle - involute(self.pressure_angle_at(radius)))

    @property
    def tip_thickness(self) -> float:
        """s_a, arc at the tip circle [mm]."""
        return self.thickness_at(self.tip_radius)

    @property
    def pointed_radius(self) -> float:
        """Radius [mm] at which both flanks of a tooth would meet."""
        from_angle = max(self.base_half_angle, 0.0)
        low, high = 0.0, math.pi / 2 - 1e-9
        for _ in range(200):
            middle = (low + high) / 2
            low, high = (middle, high) if involute(middle) < from_angle else (low, middle)
        return self.base_radius / math.cos(low)

    # roll -----------------------------------------------------------------------------------------

    def roll_at(self, radius: float) -> float:
        """Roll angle t = tan alpha_y [rad] of the flank at a radius; 0 at the base circle."""
        return math.tan(self.pressure_angle_at(radius))

    @cached_property
    def tip_roll(self) -> float:
        """Roll angle at the tip circle [rad]."""
        return self.roll_at(self.tip_radius)

    @cached_property
    def form_roll(self) -> float:
        """Roll angle [rad] at which the involute begins: where the fillet ends, or 0 at the base circle."""
        radius = self.fillet_radius
        beyond = (self.root_radius + radius) ** 2 - self.base_radius**2
        if beyond <= radius**2:
            return 0.0
        return (math.sqrt(beyond) - radius) / self.base_radius

    @property
    def form_radius(self) -> float:
        """Radius [mm] at which the involute begins."""
        return self.base_radius * math.hypot(1.0, self.form_roll)

    def flank_points(self, roll: Array, flank: Flank) -> Array:
        """Points of a flank of tooth 0 in the transverse plane, gear frame.

        Args:
            roll: roll angles [rad], shape (n,), 0 at the base circle.
            flank: RIGHT or LEFT.

        Returns:
            (n, 2) [mm]. P = r_b [(cos beta, sin beta) + sigma t (sin beta, -cos beta)],
            beta = sigma (t - eta_b): the string unwound from the base circle.
        """
        beta = flank * (roll - self.base_half_angle)
        cos, sin = np.cos(beta), np.sin(beta)
        return self.base_radius * np.stack([cos + flank * roll * sin, sin - flank * roll * cos], axis=-1)

    def flank_normals(self, roll: Array, flank: Flank) -> Array:
        """Unit normals out of the tooth at those points, shape (n, 2): sigma (sin beta, -cos beta)."""
        beta = flank * (roll - self.base_half_angle)
        return np.stack([flank * np.sin(beta), -flank * np.cos(beta)], axis=-1)

    # root -----------------------------------------------------------------------------------------

    @cached_property
    def full_round_fillet(self) -> float:
        """Largest fillet radius [mm]: one arc from flank to flank, touching the root circle."""
        low, high = 0.0, self.reference_radius
        for _ in range(200):
            middle = (low + high) / 2
            low, high = (middle, high) if self._fillet_azimuth(middle) < math.pi / self.teeth else (low, middle)
        return low

    @cached_property
    def fillet_radius(self) -> float:
        """The fillet in use [mm]: the stated one, or ISO 53's, or the full round where that is smaller."""
        if self.root_fillet is not None:
            return self.root_fillet
        return min(ISO53_ROOT_FILLET * self.module, self.full_round_fillet)

    def _fillet_azimuth(self, radius: float) -> float:
        """Azimuth [rad] of the fillet's centre off the tooth's middle, for an arc of that radius."""
        return fillet_azimuth(radius, self.root_radius, self.base_radius, self.base_half_angle)

    def fillet_centre(self, flank: Flank) -> tuple[float, float]:
        """Centre (x, y) [mm] of the fillet arc below a flank of tooth 0."""
        centre = self.root_radius + self.fillet_radius
        azimuth = -flank * self._fillet_azimuth(self.fillet_radius)
        return centre * math.cos(azimuth), centre * math.sin(azimuth)

    def fillet_top(self, flank: Flank) -> tuple[float, float]:
        """Where the fillet leaves the flank (involute or radial line), (x, y) [mm]."""
        if self.form_roll > 0.0:
            x, y = self.flank_points(np.array([self.form_roll]), flank)[0]
            return float(x), float(y)
        radius = math.sqrt((self.root_radius + self.fillet_radius) ** 2 - self.fillet_radius**2)
        azimuth = -flank * self.base_half_angle
        return radius * math.cos(azimuth), radius * math.sin(azimuth)

    def fillet_bottom(self, flank: Flank) -> tuple[float, float]:
        """Where the fillet meets the root circle, (x, y) [mm]."""
        azimuth = -flank * self._fillet_azimuth(self.fillet_radius)
        return self.root_radius * math.cos(azimuth), self.root_radius * math.sin(azimuth)

    @property
    def root_arc(self) -> float:
        """Arc [mm] of the root circle between the two fillets of a space; 0 at the full round."""
        return 2 * self.root_radius * max(0.0, math.pi / self.teeth - self._fillet_azimuth(self.fillet_radius))

    @cached_property
    def transverse_area(self) -> float:
        """Area [mm^2] of the toothed section without the bore: exact, by Green's theorem.

        Half the sum of x dy - y dx along tip arc, involute, radial line, fillet and root arc; the
        involute's share is r_b^2 (t_a^3 - t_f^3)/6 for each flank.
        """
        tip_half = self.base_half_angle - (self.tip_roll - math.atan(self.tip_roll))
        tip_arc = self.tip_radius**2 * 2 * tip_half / 2
        flanks = 2 * self.base_radius**2 * (self.tip_roll**3 - self.form_roll**3) / 6
        root = self.root_radius * self.root_arc / 2
        return self.teeth * (tip_arc + flanks + root + 2 * self._fillet_sector())

    def _fillet_sector(self) -> float:
        """1/2 of the integral of x dy - y dx [mm^2] along the fillet of a left flank, from flank to root."""
        (cx, cy), radius = self.fillet_centre(-1), self.fillet_radius
        (ax, ay), (bx, by) = self.fillet_top(-1), self.fillet_bottom(-1)
        start = math.atan2(ay - cy, ax - cx)
        turn = math.remainder(math.atan2(by - cy, bx - cx) - start, 2 * math.pi)
        return (radius**2 * turn + cx * (by - ay) - cy * (bx - ax)) / 2

    # undercut -------------------------------------------------------------------------------------

    @property
    def undercut_limit_shift(self) -> float:
        """Smallest profile shift without undercut by a rack of addendum 1: x = 1 - z sin^2(alpha)/2."""
        return RACK_ADDENDUM - self.teeth * math.sin(self.pressure_angle) ** 2 / 2

    @cached_property
    def undercut_radius(self) -> float:
        """Radius [mm] below which a rack of addendum 1 would cut the involute away; the base circle if none."""
        if self.profile_shift >= self.undercut_limit_shift:
            return self.base_radius
        depth = self.module * (RACK_ADDENDUM - self.profile_shift)
        ends = (self.base_radius, self.tip_radius)
        return rack_undercut_radius(self.pressure_angle, self.reference_radius, depth, ends, self.pressure_angle_at)
