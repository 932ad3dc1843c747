"""Meshes of two gears, shafts with gears and arms, and the trains that they make."""

import math
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
    """A gear in one of its meshes: builds have one entry for each.

    Args:
        mesh, gear: names.
        azimuth: of the frame at rest in that mesh, in the frame of the gear's axis at rest on its shaft [rad].
        ahead: by which the gear's tooth 0 stands ahead of the one that the mesh counts as such [rad].
    """

    mesh: str
    gear: str
    azimuth: float = 0.0
    ahead: float = 0.0


Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Carried:
    """A gear on a shaft.

    Args:
        gear: its name.
        at: where its frame's origin lies along the shaft's z [mm].
        backward: its z goes against the shaft's; their x axes agree then.
        phase: azimuth of its tooth 0 [rad], in its own frame, when the shaft is at 0.
    """

    gear: str
    at: float = 0.0
    backward: bool = False
    phase: float = 0.0

    @property
    def sense(self) -> int:
        """Turn of the gear about its own z for a turn of the shaft: 1 or -1."""
        return -1 if self.backward else 1


@dataclass(frozen=True)
class Shaft:
    """A shaft; diameter and ends along its z [mm] are for pictures and CAD only."""

    name: str
    carries: tuple[Carried, ...] = ()
    diameter: float | None = None
    start: float | None = None
    end: float | None = None


@dataclass(frozen=True)
class Arm:
    """A robot's arm on a shaft: named points and the centre of mass [mm], in the shaft's frame, the arm at 0.

    The diameter [mm] is for pictures and CAD only.
    """

    name: str
    on: str
    points: tuple[tuple[str, Vector], ...]
    centre_of_mass: Vector | None = None
    diameter: float | None = None

    def lever(self, point: str) -> float:
        """Distance of a point from the shaft's axis [mm]."""
        x, y, _ = dict(self.points)[point]
        return math.hypot(x, y)

    def torque(self, gravity: Vector, angle: float) -> float:
        """Torque of gravity (a direction in the shaft's frame) about the shaft's z, the arm turned [rad].

        Per weight [mm]. Without a centre of mass the last point stands for it.
        """
        x, y, _ = self.points[-1][1] if self.centre_of_mass is None else self.centre_of_mass
        cos, sin = math.cos(angle), math.sin(angle)
        return (cos * x - sin * y) * gravity[1] - (sin * x + cos * y) * gravity[0]


@dataclass(frozen=True)
class Train:
    """Shafts from a motor to an output.

    Args:
        name: the move's.
        driven: the shaft that the motor turns.
        output: the shaft at its end.
        held: the shaft that is held while lost motion is read.
        gravity: its direction in the world.
        sense: of the motor, 1 counter-clockwise about its shaft's z, or -1.
    """

    name: str
    driven: str
    output: str
    held: str
    gravity: Vector | None = None
    sense: int = 1
