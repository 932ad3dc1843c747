"""An external spur or helical gear in an internal one, on parallel axes; either may drive.

World: the driver's axis is z. The teeth meet at azimuth 0 of both gears, and both turn in the same sense. The axis of a
driven ring lies at -x by the centre distance, that of a driven gear in a driving ring at +x.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tol3d.errors import GeometryError
from tol3d.gears.cylindrical_pair import CylindricalPair, crossed_axes
from tol3d.gears.flank import Flank, opposite
from tol3d.gears.internal_assembly import interference, interferes, radially_assembled
from tol3d.gears.internal_gear import InternalGear
from tol3d.gears.internal_mesh import InternalMesh
from tol3d.gears.pair import CONTACT_MARGIN, Displaced
from tol3d.gears.spur_gear import SpurGear
from tol3d.numerics.arrays import Array


@dataclass(frozen=True)
class InternalPair(CylindricalPair):
    """Pinion (driver) and wheel (driven), of which one is an InternalGear, at a centre distance [mm] above 0.

    As the centre distance grows the teeth come closer: backlash shrinks.

    Raises:
        GeometryError: not exactly one gear is internal; modules, pressure angles, helix angles or hands differ; the
            internal gear has not more teeth; or at that distance the base circles have no common tangent.

    >>> alpha = math.radians(20)
    >>> planet, ring = SpurGear(27, 1.0, alpha, 10.0), InternalGear(79, 1.0, alpha, 10.0)
    >>> pair = InternalPair(planet, ring, 26.0)
    >>> abs(pair.normal_backlash) < 1e-12, round(pair.contact_ratio, 4)
    (True, 1.9281)
    """

    pinion: SpurGear | InternalGear
    wheel: SpurGear | InternalGear

    def __post_init__(self) -> None:
        if isinstance(self.pinion, InternalGear) == isinstance(self.wheel, InternalGear):
            count = "two" if isinstance(self.wheel, InternalGear) else "none"
            raise GeometryError(f"an internal pair needs one internal gear and one external, got {count} of the first")
        self._refuse_unlike()
        if crossed := crossed_axes(self.pinion, self.wheel):
            raise GeometryError(crossed)
        if self.ring.teeth <= self.inner.teeth:
            raise GeometryError(
                f"the internal gear needs more teeth than the gear inside it: got {self.ring.teeth} and "
                f"{self.inner.teeth}"
            )
        if self.centre_distance <= -self.base_radii:
            raise GeometryError(
                f"centre distance {self.centre_distance:g} mm: the base circles have no common tangent, an internal "
                f"pair of {self.inner.teeth} and {self.ring.teeth} teeth needs more than {-self.base_radii:.4f} mm"
            )

    @property
    def ring(self) -> InternalGear:
        """The internal gear."""
        ring = self.wheel if isinstance(self.wheel, InternalGear) else self.pinion
        if not isinstance(ring, InternalGear):
            raise TypeError("no gear of the pair is internal")
        return ring

    @property
    def inner(self) -> SpurGear:
        """The external gear inside it."""
        inner = self.wheel if isinstance(self.wheel, SpurGear) else self.pinion
        if not isinstance(inner, SpurGear):
            raise TypeError("no gear of the pair is external")
        return inner

    @property
    def ring_drives(self) -> bool:
        """True if the internal gear is the driver."""
        return isinstance(self.pinion, InternalGear)

    @property
    def iso_sign(self) -> int:
        """-1: ISO 21771 counts the centre distance of an internal pair negative."""
        return -1

    # world --------------------------------------------------------------------------------------

    @property
    def wheel_origin(self) -> Array:
        """Face centre of the wheel (3,) [mm]: at +x by the centre distance in a driving ring, else at -x."""
        return np.array([self.centre_distance if self.ring_drives else -self.centre_distance, 0.0, 0.0])

    @property
    def mesh_azimuths(self) -> tuple[float, float]:
        """Azimuth of the mesh from either gear [rad]: 0, along +x."""
        return 0.0, 0.0

    def tip_clearance(self, origins: Array, scale: tuple[float, float]) -> float:
        """Smaller clearance [mm] between a tip circle and the mate's root circle, with the axes at given places.

        Args:
            origins: of driver and driven (2, 3) [mm].
            scale: growth of driver and driven.
        """
        ring, inner = scale if self.ring_drives else scale[::-1]
        between = origins[1, :2] - origins[0, :2]
        distance = math.hypot(*between)
        outside = ring * self.ring.root_radius - distance - inner * self.inner.tip_radius
        inside = ring * self.ring.tip_radius - distance - inner * self.inner.root_radius
        return min(outside, inside)

    @property
    def remedy(self) -> str:
        """Sentence on the change needed for zero backlash."""
        nearest = self.zero_backlash_centre_distance
        if math.isnan(nearest):
            return "no centre distance leaves backlash: the teeth are too thick together. Thin the teeth"
        return (
            f"zero backlash needs a centre distance of {nearest:.4f} mm for the nominal "
            "teeth. Close the centre distance or thin the teeth"
        )

    @property
    def interference(self) -> str:
        """The condition of interference that is violated, its numbers and the remedy; "" if none is."""
        return interference(InternalMesh(self.ring, self.inner, self.centre_distance))

    @property
    def interferes(self) -> bool:
        """True if a condition of interference is violated; quicker than `interference`."""
        return interferes(InternalMesh(self.ring, self.inner, self.centre_distance))

    @property
    def radially_assembled(self) -> bool:
        """True if the inner gear can be inserted along the line of centres; else only along its axis, or its helix."""
        return radially_assembled(InternalMesh(self.ring, self.inner, self.centre_distance))

    def refuse_interference(self) -> None:
        """Refuse interference, contact on undercut flanks, and a contact ratio below 1.

        Raises:
            GeometryError: with the violated condition, its numbers and the remedy.
        """
        if self.interference:
            raise GeometryError(self.interference)
        mesh = InternalMesh(self.ring, self.inner, self.centre_distance)
        start = self.inner.base_radius * math.hypot(1.0, mesh.inner_roll(self.ring.tip_roll))
        self.inner.refuse_undercut(start, "inner", f"at {2 * start:.4f} mm")
        self._refuse_short_contact()

    @property
    def touching_azimuths(self) -> tuple[float, float]:
        """Azimuths of the path of contact, widened for axes displaced by CONTACT_MARGIN p_b sin(alpha_w) [rad].

        If an axis is displaced by d, the path ends d/sin(alpha_w) off, as for external gears, and the line of centres
        and the working pressure angle turn by d/(a sin(alpha_w)), which is large if the numbers of teeth are close.
        """
        lowest, highest = self._azimuths_over(self.pinion.face_width)
        margin = CONTACT_MARGIN * (self.pinion.angular_pitch + self.pinion.base_pitch / self.centre_distance)
        return lowest - margin, highest + margin

    # positions --------------------------------------------------------------------------------------

    def driven_angle(self, driver_angle: Array) -> Array:
        """Wheel's turn [rad] with a space centred on the pinion's tooth: pi/z2 + (z1/z2) theta_1.

        Of helical gears while both face centres lie in one plane.
        """
        return math.pi / self.wheel.teeth + driver_angle / self.ratio

    def touching_angle(self, driver_angle: Array, flank: Flank, displaced: Displaced) -> Array:
        """Wheel's turn [rad] at which the flanks of a side touch, (trials,); tilts of the axes are neglected.

        From the line of action, r_b1 t_1 + r_b2 t_2 = (r_b1 + r_b2) tan alpha_w with the ring's radius negative and the
        rolls t = alpha_w + eta_b - sigma (azimuth off the mesh), of the ring alpha_w - eta_b + sigma (azimuth).

        Args:
            driver_angle: pinion's turn [rad], (trials,).
            flank: the pinion's flank.
            displaced: origins of the gears, and turns of their flanks.
        """
        away = displaced.origin[:, 1] - displaced.origin[:, 0]
        to_mesh = away if self.ring_drives else -away
        direction = np.arctan2(to_mesh[:, 1], to_mesh[:, 0])
        distance = np.sqrt(to_mesh[:, 0] ** 2 + to_mesh[:, 1] ** 2)
        working = np.arccos(np.minimum(-self.base_radii / distance, 1.0))
        along = self._along(working, displaced)
        turned = self.pinion.base_radius * (driver_angle - direction) - flank * along
        mate = 1 if flank == 1 else 0
        screwed = self.wheel.twist * away[:, 2] if self.wheel.helix_angle else 0.0
        return np.asarray(
            direction + mate * self.wheel.angular_pitch + turned / self.wheel.base_radius + screwed, dtype=np.float64
        )

    def mating_flank(self, flank: Flank) -> Flank:
        """Flank of the wheel that meets a flank of the pinion: the opposite one, by azimuth."""
        return opposite(flank)

    def mating_teeth(self, driver_teeth: NDArray[np.int64], flank: Flank) -> NDArray[np.int64]:
        """Wheel's teeth that meet a flank of the pinion's teeth k: k - 1 on the right flank, k on the left."""
        return driver_teeth - (1 if flank == 1 else 0)
