"""A mesh of two gears."""

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Literal

import numpy as np

from tol3d.gears import Flank, Gear, GearPair
from tol3d.gears.flank import opposite


@dataclass(frozen=True)
class Mesh:
    """The move that turns the driven gear until the working flanks touch.

    World of the mesh: the frame of the driver at rest, turned so that the teeth meet at +x; the pair knows where the
    driven gear's frame lies in it. `working_flank` is the driver's; `azimuth` [rad] is where the teeth meet about the
    driver's axis, in the driver's frame at rest on its shaft.
    """

    name: str
    driver: str
    driven: str
    pair: GearPair
    working_flank: Flank
    housing: str | None = None
    azimuth: float = 0.0

    def gear(self, name: str) -> Gear:
        """The driver or the driven gear, by its name."""
        return self.pair.pinion if name == self.driver else self.pair.wheel

    @property
    def driven_flank(self) -> Flank:
        """The driven gear's flank that works."""
        return self.pair.mating_flank(self.working_flank)

    def resting_flank(self, side: Literal["drive", "back"]) -> Flank:
        """The driver's flank that touches on a side: the working one on the drive side."""
        return self.working_flank if side == "drive" else opposite(self.working_flank)

    @cached_property
    def rate(self) -> Fraction:
        """Turns of the driven gear per turn of the driver, each about its own z."""
        angles = self.pair.driven_angle(np.array([0.0, 1.0]))
        sense = 1 if angles[1] > angles[0] else -1
        return sense * Fraction(self.pair.pinion.teeth, self.pair.wheel.teeth)


@dataclass(frozen=True)
class Seat:
    """A gear in one of its meshes: builds have a place for each.

    Args:
        mesh, gear: names.
        azimuth: of the frame at rest in that mesh, in the frame of the gear's axis at rest on its shaft [rad].
        ahead: by which the gear's tooth 0 stands ahead of the one that the mesh counts as such [rad].
    """

    mesh: str
    gear: str
    azimuth: float = 0.0
    ahead: float = 0.0
