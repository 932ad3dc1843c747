"""One internal involute spur or helical gear, the ring: allowed sizes, root fillet, rim."""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, Final

from tol3d.errors import GeometryError
from tol3d.gears.cylindrical_gear import CylindricalGear
from tol3d.gears.involute import involute
from tol3d.gears.toothed_gear import PRESSURE_ANGLES, ToothedGear

RIM: Final = 2.5  # modules between root circle and outside, where no outer diameter is given
BISECTIONS: Final = 200  # more than a double has bits


@dataclass(frozen=True)
class InternalGear(CylindricalGear):
    """An internal spur or helical gear by the words of ISO 21771-1; lengths in mm, angles in rad.

    Its teeth point inwards: the tip circle is the smallest, the root circle the largest. Teeth and diameters are
    positive.

    Args:
        teeth: number of teeth z, at least 3; ISO counts it negative.
        module: m [mm], of a helical gear the normal module m_n.
        pressure_angle: alpha at the reference circle [rad], of a helical gear alpha_n in the normal section.
        face_width: b [mm].
        profile_shift: coefficient x, in modules; as in ISO 21771 positive goes towards the tip, that is inwards, and
            thickens the teeth. Books that write inv alpha_w with (x_2 - x_1)/(z_2 - z_1) have the other sign.
        addendum, dedendum: factors h_a*, h_f* of the module.
        root_fillet: radius [mm] of the arc between flank and root circle; None takes the 0.38 m
            of ISO 53, or the full round of the space where that is smaller.
        outer_diameter: of the rim [mm]; None takes the root circle and 2.5 m on either side.
        tooth_thickness_deviation: added to the nominal arc at the reference circle [mm], of a helical gear in the
            normal section (E_sn), half on each flank; positive is thicker.
        helix_angle: beta at the reference cylinder [rad]; 0 is a spur gear.
        hand: of the helix, RIGHT_HAND or LEFT_HAND: that of its mate.

    Raises:
        GeometryError: the gear cannot be made; the text carries the numbers.

    >>> ring = InternalGear(teeth=79, module=1.0, pressure_angle=math.radians(20), face_width=10.0)
    >>> ring.reference_diameter, round(ring.base_diameter, 6), ring.tip_diameter, ring.root_diameter
    (79.0, 74.235717, 77.0, 81.5)
    """

    lengths: ClassVar[tuple[str, ...]] = (*ToothedGear.lengths, "root_fillet", "outer_diameter")

    outer_diameter: float | None = None
    tooth_thickness_deviation: float = 0.0

    def __post_init__(self) -> None:
        self._refuse_sizes({"pressure_angle": PRESSURE_ANGLES})
        self._refuse_helix()
        self._refuse_circles()
        self._refuse_teeth()
        if not self.rim_diameter > self.root_diameter:
            raise GeometryError(
                f"outer_diameter: expected more than the root circle ({self.root_diameter:.4f} mm), "
                f"got {self.rim_diameter:g} mm"
            )

    def _refuse_circles(self) -> None:
        if not self.tip_radius < self.root_radius:
            raise GeometryError(
                f"the tip circle ({self.tip_diameter:.4f} mm) of an internal gear must lie inside the root circle "
                f"({self.root_diameter:.4f} mm): look at addendum, dedendum"
            )
        if not self.tip_radius > self.base_radius:
            most = self._addendum_to(self.base_radius)
            raise GeometryError(
                f"the tip circle ({self.tip_diameter:.4f} mm) of the internal gear reaches the base circle "
                f"({self.base_diameter:.4f} mm), inside which there is no involute: expected an addendum below "
                f"{most:.4f} with profile_shift {self.profile_shift:g}, or more teeth"
            )

    def _addendum_to(self, radius: float) -> float:
        """Addendum factor at which the tip circle has that radius [mm]."""
        return (self.reference_radius - radius) / self.module - self.profile_shift

    def _refuse_teeth(self) -> None:
        if self.tip_thickness <= 0.0:
            raise GeometryError(
                f"pointed teeth: the tooth thickness at the tip circle ({self.tip_diameter:.4f} mm) of the internal "
                f"gear is {self.tip_thickness:.4f} mm; flanks meet at {2 * self.pointed_radius:.4f} mm: lower addendum "
                f"below {self._addendum_to(self.pointed_radius):.4f}"
            )
        if self.full_round_fillet <= 0.0:
            raise GeometryError("no tooth space is left at the root circle: look at dedendum, profile_shift")
        self._refuse_fillet()
        if self.form_radius <= self.tip_radius:
            raise GeometryError("root_fillet: it eats the whole flank; choose a smaller one")

    @property
    def iso_sign(self) -> int:
        """-1."""
        return -1

    @property
    def bore(self) -> float:
        """0 [mm]: there is no shaft through its middle."""
        return 0.0

    @property
    def rim_diameter(self) -> float:
        """Outside diameter of the rim [mm]."""
        return self.root_diameter + 2 * RIM * self.module if self.outer_diameter is None else self.outer_diameter

    @property
    def pointed_radius(self) -> float:
        """Radius [mm] at which both flanks of a tooth would meet; the base circle where they do not."""
        low, high = 0.0, self.pressure_angle_at(self.root_radius)
        for _ in range(BISECTIONS):
            middle = (low + high) / 2
            low, high = (middle, high) if involute(middle) < -self.base_half_angle else (low, middle)
        return self.base_radius / math.cos(low)

    # root -----------------------------------------------------------------------------------------

    @cached_property
    def form_roll(self) -> float:
        """Roll angle [rad] at which the involute ends and the fillet begins; it is larger than at the tip."""
        return self._fillet_roll(self.fillet_radius)

    def _fillet_roll(self, radius: float) -> float:
        """Roll [rad] at which an arc of that radius touches flank and root circle."""
        along = math.sqrt(max((self.root_radius - radius) ** 2 - self.base_radius**2, 0.0))
        return (along + radius) / self.base_radius

    def _fillet_azimuth(self, radius: float) -> float:
        """Azimuth [rad] of the fillet's centre off the tooth's middle, for an arc of that radius.

        The arc lies in the space, its centre on the flank's parallel: the involute of roll t - radius/r_b, turned.
        """
        roll = self._fillet_roll(radius)
        return self.base_half_angle + roll - math.atan(roll - radius / self.base_radius)

    @cached_property
    def full_round_fillet(self) -> float:
        """Largest fillet radius [mm]: one arc from flank to flank, touching the root circle."""
        low, high = 0.0, self.root_radius - self.base_radius
        for _ in range(BISECTIONS):
            middle = (low + high) / 2
            low, high = (low, middle) if self._fillet_azimuth(middle) > math.pi / self.teeth else (middle, high)
        return low

    @property
    def transverse_area(self) -> float:
        """Area [mm^2] of the section between teeth and rim: exact."""
        return math.pi * self.rim_diameter**2 / 4 - self.outline_area
