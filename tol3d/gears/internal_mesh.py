"""An external gear in an internal one as their flanks touch: paths of the tips, and their gap to the mate.

Formulas stand in the plane of the gears, with the axis of the ring at the origin, the other axis at +x and the right
flank of the inner gear (its low azimuth) on the left flank of a ring's tooth. What holds for the other flanks is the
mirror image.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np

from tol3d.gears.cylindrical_gear import CylindricalGear
from tol3d.gears.flank import RIGHT
from tol3d.gears.internal_gear import InternalGear
from tol3d.gears.involute import involute
from tol3d.gears.spur_gear import SpurGear
from tol3d.numerics.arrays import Array


def tooth_half_angle(gear: CylindricalGear, radius: Array) -> Array:
    """Half the azimuth [rad] that a tooth takes at radii [mm] from its root to its tip, (n,).

    On the involute it is eta_b - inv alpha_R, inside eta_b + inv alpha_R; below the base circle the line is radial; on
    the fillet, of radius rho and with its centre at R_c, it is the centre's azimuth less arccos((R^2 + R_c^2 - rho^2)/
    (2 R R_c)).
    """
    sign = gear.iso_sign
    alpha = np.arccos(np.minimum(gear.base_radius / radius, 1.0))
    flank = gear.base_half_angle - sign * (np.tan(alpha) - alpha)
    fillet = gear.fillet_radius
    x, y = gear.fillet_centre(RIGHT)
    centre, azimuth = math.hypot(x, y), -math.atan2(y, x)
    cosine = (radius**2 + centre**2 - fillet**2) / (2 * radius * centre)
    round_off = azimuth - np.arccos(np.clip(cosine, -1.0, 1.0))
    top = math.hypot(*gear.fillet_top(RIGHT))
    return np.asarray(np.where(sign * (radius - top) < 0.0, round_off, flank))


STEPS: Final = 400  # of a tip corner's way through the mate's fillet: its bend over a step is 1e-5 of the fillet


@dataclass(frozen=True)
class InternalMesh:
    """Ring and inner gear at a centre distance [mm]."""

    ring: InternalGear
    inner: SpurGear
    centre_distance: float

    @cached_property
    def working_pressure_angle(self) -> float:
        """alpha_w [rad]: cos alpha_w = (r_b2 - r_b1)/a."""
        return math.acos((self.ring.base_radius - self.inner.base_radius) / self.centre_distance)

    @property
    def tangent(self) -> float:
        """a sin alpha_w [mm]: between where the line of action touches both base circles."""
        return self.centre_distance * math.sin(self.working_pressure_angle)

    # tips and roots -------------------------------------------------------------------------------

    @property
    def clearance_at_ring_root(self) -> float:
        """Between the inner gear's tip circle and the ring's root circle [mm]."""
        return self.ring.root_radius - self.centre_distance - self.inner.tip_radius

    @property
    def clearance_at_inner_root(self) -> float:
        """Between the ring's tip circle and the inner gear's root circle [mm]."""
        return self.ring.tip_radius - self.centre_distance - self.inner.root_radius

    # path of contact ------------------------------------------------------------------------------

    def inner_roll(self, ring_roll: float) -> float:
        """Roll [rad] of the inner gear's flank where it touches the ring's at that roll."""
        return (self.ring.base_radius * ring_roll - self.tangent) / self.inner.base_radius

    def ring_roll(self, inner_roll: float) -> float:
        """Roll [rad] of the ring's flank where it touches the inner gear's at that roll."""
        return (self.inner.base_radius * inner_roll + self.tangent) / self.ring.base_radius

    # tip corners ----------------------------------------------------------------------------------

    @cached_property
    def _phase(self) -> float:
        """r_b1 eta_1 + r_b2 eta_2 + (r_b2 - r_b1) inv alpha_w [mm]: r_b2 phi_2 = r_b1 phi_1 - this as flanks touch."""
        half = self.inner.base_radius * self.inner.base_half_angle + self.ring.base_radius * self.ring.base_half_angle
        bases = self.ring.base_radius - self.inner.base_radius
        return half + bases * involute(self.working_pressure_angle)

    @cached_property
    def tip_crossing(self) -> float:
        """Azimuth [rad] about the inner gear's axis where the tip circles cross; 0 or pi where they do not."""
        tip, ring_tip, distance = self.inner.tip_radius, self.ring.tip_radius, self.centre_distance
        cosine = (ring_tip**2 - tip**2 - distance**2) / (2 * distance * tip)
        return math.acos(max(-1.0, min(1.0, cosine)))

    def inner_tip_gap(self, azimuth: Array) -> tuple[Array, Array]:
        """Gap between the inner gear's tip corner and the ring's flank or fillet [mm], and its radius in the ring.

        Args:
            azimuth: of the corner about the inner gear's axis [rad], (n,).
        """
        tip = self.inner.tip_radius
        x, y = self.centre_distance + tip * np.cos(azimuth), tip * np.sin(azimuth)
        radius = np.hypot(x, y)
        tooth = azimuth + self.inner.tip_thickness / (2 * tip)
        mate = (self.inner.base_radius * tooth - self._phase) / self.ring.base_radius
        return radius * (np.arctan2(y, x) - mate - tooth_half_angle(self.ring, radius)), radius

    def ring_tip_gap(self, azimuth: Array) -> tuple[Array, Array]:
        """Gap between the ring's tip corner and the inner gear's flank or fillet [mm], and its radius there.

        Args:
            azimuth: of the corner about the ring's axis [rad], (n,).
        """
        tip = self.ring.tip_radius
        x, y = tip * np.cos(azimuth) - self.centre_distance, tip * np.sin(azimuth)
        radius = np.hypot(x, y)
        mate = azimuth - self.ring.tip_thickness / (2 * tip)
        tooth = (self.ring.base_radius * mate + self._phase) / self.inner.base_radius
        return radius * (tooth - tooth_half_angle(self.inner, radius) - np.arctan2(y, x)), radius

    @property
    def trimming_gap(self) -> float:
        """Gap between tip corners [mm] where the tip circles cross; negative: they trim each other.

        A corner's gap to the flank rises from 0 on the path of contact to where the flank's normal passes through the
        pitch point again, on the other tangent of the base circles, and falls from there on: it is least at the ends.
        With delta_1, delta_2 the azimuths of the crossing it is r_a2/z2 times
        z1 (inv alpha_a1 + delta_1) + (z2 - z1) inv alpha_w - z2 (inv alpha_a2 + delta_2), and the same with -delta.
        """
        ends = np.array([-self.tip_crossing, self.tip_crossing])
        return float(self.inner_tip_gap(ends)[0].min())

    @property
    def ring_fillet_gap(self) -> float:
        """Least gap [mm] of the inner gear's tip corner to the ring's fillets; inf where it does not get there."""
        form, tip = self.ring.form_radius, self.inner.tip_radius
        reach = (form**2 - tip**2 - self.centre_distance**2) / (2 * self.centre_distance * tip)
        if reach >= 1.0:
            return math.inf
        deepest = math.acos(max(-1.0, reach))
        return float(self.inner_tip_gap(np.linspace(-deepest, deepest, STEPS + 1)[1:-1])[0].min())

    @property
    def inner_fillet_gap(self) -> float:
        """Least gap [mm] of the ring's tip corner to the inner gear's fillets; inf where it does not get there."""
        form, tip = self.inner.form_radius, self.ring.tip_radius
        reach = (tip**2 + self.centre_distance**2 - form**2) / (2 * self.centre_distance * tip)
        if reach >= 1.0:
            return math.inf
        deepest = math.acos(max(-1.0, reach))
        return float(self.ring_tip_gap(np.linspace(-deepest, deepest, STEPS + 1)[1:-1])[0].min())
