"""Two external spur or helical gears on parallel axes: their world, positions, interference.

Exact for rigid involute teeth. Sources: ISO 21771-1:2024, 5.3 (pair geometry) and 5.6 (backlash).
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tol3d.errors import GeometryError
from tol3d.gears.cylindrical_pair import CylindricalPair, crossed_axes
from tol3d.gears.flank import Flank
from tol3d.gears.pair import Displaced
from tol3d.gears.spur_gear import SpurGear
from tol3d.numerics.arrays import Array


@dataclass(frozen=True)
class SpurPair(CylindricalPair):
    """Pinion (driver) and wheel (driven) at a centre distance [mm].

    Raises:
        GeometryError: modules, pressure angles or helix angles differ, the hands are alike, or the base circles do not
            leave room.

    >>> alpha = math.radians(20)
    >>> pinion = SpurGear(28, 2.5, alpha, 20.0)
    >>> wheel = SpurGear(110, 2.5, alpha, 20.0)
    >>> pair = SpurPair(pinion, wheel, 172.5)
    >>> abs(pair.normal_backlash) < 1e-12, round(pair.contact_ratio, 4)
    (True, 1.7503)
    """

    pinion: SpurGear
    wheel: SpurGear

    def __post_init__(self) -> None:
        self._refuse_unlike()
        if crossed := crossed_axes(self.pinion, self.wheel):
            raise GeometryError(crossed)
        if self.centre_distance <= self.base_radii:
            normal = f"; module is the normal one, {self.pinion.module:g} mm" if self.pinion.helix_angle else ""
            raise GeometryError(
                f"centre distance {self.centre_distance:g} mm: the teeth interfere, the base circles alone "
                f"need more than {self.base_radii:.4f} mm{normal}"
            )

    @property
    def iso_sign(self) -> int:
        """+1."""
        return 1

    # world --------------------------------------------------------------------------------------

    @property
    def wheel_origin(self) -> Array:
        """The face centre of the wheel, at +x by the centre distance, (3,) [mm]."""
        return np.array([self.centre_distance, 0.0, 0.0])

    @property
    def mesh_azimuths(self) -> tuple[float, float]:
        """The pinion sees the mesh at +x, the wheel at -x [rad]."""
        return 0.0, math.pi

    def tip_clearance(self, origins: Array, scale: tuple[float, float]) -> float:
        """Smaller free distance [mm] between a tip circle and the mate's root circle, axes where they are."""
        tips = [part * gear.tip_radius for part, gear in zip(scale, (self.pinion, self.wheel), strict=True)]
        roots = [part * gear.root_radius for part, gear in zip(scale, (self.pinion, self.wheel), strict=True)]
        between = origins[1, :2] - origins[0, :2]
        return math.hypot(*between) - max(tips[0] + roots[1], tips[1] + roots[0])

    @property
    def remedy(self) -> str:
        """Change needed for zero backlash."""
        return (
            f"zero backlash needs a centre distance of {self.zero_backlash_centre_distance:.4f} mm for the nominal "
            "teeth. Open the centre distance or thin the teeth"
        )

    def refuse_interference(self) -> None:
        """Raise unless tips clear roots and the path of contact stays on both involutes.

        Raises:
            GeometryError: with the radii and the remedy.
        """
        for pair, name, mate in ((self, "driver", "driven"), (self.mirrored, "driven", "driver")):
            gear, other = pair.pinion, pair.wheel
            clearance = self.centre_distance - gear.root_radius - other.tip_radius
            if clearance <= 0.0:
                addendum = other.addendum + clearance / other.module
                shifts = gear.profile_shift + other.profile_shift
                for_tip = f"give the {mate} gear an addendum below {addendum:.4f} (it has {other.addendum:g}), or "
                raise GeometryError(
                    f"the teeth interfere at centre distance {self.centre_distance:g} mm: the tip of the {mate} "
                    f"gear and the root of the {name} gear interfere by {-clearance:.4f} mm; "
                    f"{for_tip if addendum > 0.0 else ''}open the centre distance"
                    + (f"; the profile shifts sum to {shifts:.4g}" if shifts else "")
                )
            start = gear.base_radius * math.hypot(1.0, max(pair.start_roll, 0.0))
            where = f"at {2 * start:.4f} mm" if pair.start_roll > 0 else "below the base circle"
            gear.refuse_undercut(start, name, where)
            if pair.start_roll < gear.form_roll:
                raise GeometryError(
                    f"the teeth interfere: the {mate} gear's tip would touch the {name} gear {where}, "
                    f"but its involute begins at {2 * gear.form_radius:.4f} mm; "
                    "lower addendum or root_fillet, or add profile_shift"
                )
        self._refuse_short_contact()

    @property
    def mirrored(self) -> "SpurPair":
        """The wheel as the driver."""
        return SpurPair(self.wheel, self.pinion, self.centre_distance)

    # positions --------------------------------------------------------------------------------------

    def driven_angle(self, driver_angle: Array) -> Array:
        """Wheel's turn [rad] with its space centred on the pinion's tooth: pi + pi/z2 - (z1/z2) theta_1.

        Of helical gears while both face centres lie in one plane.
        """
        return math.pi + math.pi / self.wheel.teeth - driver_angle / self.ratio

    def touching_angle(self, driver_angle: Array, flank: Flank, displaced: Displaced) -> Array:
        """Wheel's turn [rad] at which the flanks of that side touch, were the axes parallel.

        From the line of action, r_b1 t_1 + r_b2 t_2 = (r_b1 + r_b2) tan alpha_w with the rolls
        t = alpha_w + eta_b - sigma (azimuth off the line of centres).

        Args:
            driver_angle: pinion's turn [rad], (trials,).
            flank: the pinion's flank.
            displaced: where the gears' centres lie, and their flanks; turns of the axes are left out.
        """
        centre_line = displaced.origin[:, 1] - displaced.origin[:, 0]
        direction = np.arctan2(centre_line[:, 1], centre_line[:, 0])
        distance = np.sqrt(centre_line[:, 0] ** 2 + centre_line[:, 1] ** 2)
        working = np.arccos(np.minimum(self.base_radii / distance, 1.0))
        along = self._along(working, displaced)
        turned = flank * along - self.pinion.base_radius * (driver_angle - direction)
        mate = 0 if flank == 1 else 1
        screwed = self.wheel.twist * centre_line[:, 2] if self.wheel.helix_angle else 0.0
        return np.asarray(
            math.pi + direction + mate * self.wheel.angular_pitch + turned / self.wheel.base_radius + screwed,
            dtype=np.float64,
        )

    def mating_flank(self, flank: Flank) -> Flank:
        """Flank of the wheel that meets that side of the pinion: the same."""
        return flank

    def mating_teeth(self, driver_teeth: NDArray[np.int64], flank: Flank) -> NDArray[np.int64]:
        """The wheel's tooth that each of those pinion flanks meets: -k on the right flank, -k - 1 on the left."""
        return -driver_teeth - (0 if flank == 1 else 1)
