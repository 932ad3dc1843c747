"""The gears of a planetary set and their meshes, as they are meant."""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Final

from tol3d.gears.involute import inverse_involute, involute

EXTERNAL: Final = 1
INTERNAL: Final = -1


@dataclass(frozen=True)
class SetGear:
    """A gear of a set; of a ring the radii are positive and the tooth points inwards.

    Args:
        module: [mm].
        pressure_angle: at the reference circle [rad].
        profile_shift: in modules; positive is a thicker tooth, of rings too.
        addendum: in modules.
        is_ring: whether it is an internal gear.
    """

    name: str
    teeth: int
    module: float
    pressure_angle: float
    profile_shift: float = 0.0
    addendum: float = 1.0
    is_ring: bool = False

    @property
    def base_radius(self) -> float:
        """r_b [mm]."""
        return self.module * self.teeth * math.cos(self.pressure_angle) / 2

    @property
    def tip_radius(self) -> float:
        """r_a [mm]."""
        outwards = -1.0 if self.is_ring else 1.0
        return self.module * (self.teeth / 2 + outwards * (self.addendum + self.profile_shift))


@dataclass(frozen=True)
class SetMesh:
    """A central gear and a gear of the planets; every planet has such a mesh.

    Args:
        central: sun or ring.
        planet: a gear of the planets.
        centre_distance: [mm].
    """

    central: SetGear
    planet: SetGear
    centre_distance: float

    @property
    def name(self) -> str:
        """Name of both gears."""
        return f"{self.central.name}–{self.planet.name}"

    @property
    def sense(self) -> int:
        """EXTERNAL or INTERNAL."""
        return INTERNAL if self.central.is_ring else EXTERNAL

    @property
    def base_radii(self) -> float:
        """r_b of the central gear plus that of the planet, of a ring less [mm]; more than 0."""
        return self.central.base_radius + self.sense * self.planet.base_radius

    @property
    def facing(self) -> float:
        """Azimuth of the central gear's tooth 0 where nothing has turned [rad].

        Tooth 0 of the first planet points outwards there: a ring has a space for it, and a sun one for the tooth that
        planets with an even number of teeth have opposite; else they have a space there.
        """
        has_space = self.central.is_ring or self.planet.teeth % 2 == 0
        return math.pi / self.central.teeth if has_space else 0.0

    @cached_property
    def working_pressure_angle(self) -> float:
        """alpha_w with cos alpha_w = base radii / a [rad]; ISO 21771-1:2024, 5.3."""
        return math.acos(self.base_radii / self.centre_distance)

    @property
    def clearance(self) -> float:
        """Half the nominal normal backlash: gap of each flank of a tooth in the middle of its space [mm].

        j/2 = s (r_bC + s r_bP)(inv alpha_w - inv alpha_0) with s = 1 of a sun, -1 of a ring, and tooth + tooth = pitch
        at alpha_0: inv alpha_0 = inv alpha + 2 s tan alpha (x_C + x_P)/(z_C + s z_P).
        """
        alpha = self.central.pressure_angle
        shifts = self.central.profile_shift + self.planet.profile_shift
        teeth = self.central.teeth + self.sense * self.planet.teeth
        tight = involute(alpha) + self.sense * 2 * math.tan(alpha) * shifts / teeth
        return self.sense * self.base_radii * (involute(self.working_pressure_angle) - tight)

    @property
    def tight_centre_distance(self) -> float:
        """Centre distance without backlash [mm]: the least of a sun, the largest of a ring."""
        tight = involute(self.working_pressure_angle) - self.sense * self.clearance / self.base_radii
        return self.base_radii / math.cos(inverse_involute(tight)) if tight > 0.0 else self.base_radii
