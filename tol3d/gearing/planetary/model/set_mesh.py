"""The gears of a planetary set and their meshes, as they are meant.

Axes are parallel, so that every transverse section of helical gears is a spur set, turned: gaps here are lengths along
the line of action in that section, of which the normals of the flanks have cos(beta_b).
"""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Final

from tol3d.gears.flank import RIGHT_HAND, Hand
from tol3d.gears.involute import inverse_involute, involute

EXTERNAL: Final = 1
INTERNAL: Final = -1


@dataclass(frozen=True)
class SetGear:
    """A gear of a set; of a ring the radii are positive and the tooth points inwards.

    Args:
        module: [mm], of a helical gear that of the normal section.
        pressure_angle: at the reference circle [rad], of a helical gear in the normal section.
        profile_shift: in modules; positive is a thicker tooth, of rings too.
        addendum: in modules.
        is_ring: whether it is an internal gear.
        helix_angle: at the reference cylinder [rad].
        hand: of the helix.
    """

    name: str
    teeth: int
    module: float
    pressure_angle: float
    profile_shift: float = 0.0
    addendum: float = 1.0
    is_ring: bool = False
    helix_angle: float = 0.0
    hand: Hand = RIGHT_HAND

    @property
    def twist(self) -> float:
        """kappa = h tan(beta)/r [rad/mm], by which it screws in a mate at rest as it slides."""
        return self.hand * math.sin(self.helix_angle) / (self.module * self.teeth / 2)

    @cached_property
    def transverse_pressure_angle(self) -> float:
        """alpha_t [rad], tan alpha_t = tan alpha_n/cos beta."""
        if self.helix_angle == 0.0:
            return self.pressure_angle
        return math.atan(math.tan(self.pressure_angle) / math.cos(self.helix_angle))

    @property
    def base_helix_cosine(self) -> float:
        """cos beta_b, sin beta_b = sin beta cos alpha_n; 1 of spur gears."""
        return math.sqrt(1.0 - (math.sin(self.helix_angle) * math.cos(self.pressure_angle)) ** 2)

    @property
    def along_action(self) -> float:
        """cos alpha_t/cos beta: along the line of action of an arc of the tooth thickness, in the normal section."""
        return math.cos(self.transverse_pressure_angle) / math.cos(self.helix_angle)

    @property
    def base_radius(self) -> float:
        """r_b [mm]."""
        return self.module * self.teeth * math.cos(self.transverse_pressure_angle) / 2 / math.cos(self.helix_angle)

    @property
    def tip_radius(self) -> float:
        """r_a [mm]."""
        outwards = -1.0 if self.is_ring else 1.0
        radius = self.teeth / 2 / math.cos(self.helix_angle)
        return self.module * (radius + outwards * (self.addendum + self.profile_shift))


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
        """alpha_wt with cos alpha_wt = base radii / a [rad], in the transverse section; ISO 21771-1:2024, 5.3."""
        return math.acos(self.base_radii / self.centre_distance)

    @property
    def clearance(self) -> float:
        """Gap of each flank of a tooth in the middle of its space, along the line of action [mm].

        j/2 = s (r_bC + s r_bP)(inv alpha_wt - inv alpha_0) with s = 1 of a sun, -1 of a ring, and tooth + tooth = pitch
        at alpha_0: inv alpha_0 = inv alpha_t + 2 s tan alpha_n (x_C + x_P)/(z_C + s z_P).
        """
        alpha = self.central.pressure_angle
        shifts = self.central.profile_shift + self.planet.profile_shift
        teeth = self.central.teeth + self.sense * self.planet.teeth
        tight = involute(self.central.transverse_pressure_angle) + self.sense * 2 * math.tan(alpha) * shifts / teeth
        return self.sense * self.base_radii * (involute(self.working_pressure_angle) - tight)

    @property
    def normal_backlash(self) -> float:
        """Nominal j_bn [mm]."""
        return 2 * self.clearance * self.central.base_helix_cosine

    @property
    def tight_centre_distance(self) -> float:
        """Centre distance without backlash [mm]: the least of a sun, the largest of a ring."""
        tight = involute(self.working_pressure_angle) - self.sense * self.clearance / self.base_radii
        return self.base_radii / math.cos(inverse_involute(tight)) if tight > 0.0 else self.base_radii
