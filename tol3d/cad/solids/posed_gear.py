"""Gears, shafts and arms, with their poses."""

from dataclasses import dataclass

from tol3d.cad.solids.built_shape import PosedShape
from tol3d.gears import Gear
from tol3d.numerics.arrays import Array

Point = tuple[float, float, float]
Collar = tuple[float, float, float]


@dataclass(frozen=True)
class ShaftBody:
    """A cylinder about z from start to end [mm], thicker at collars: diameter, start and end of each [mm]."""

    diameter: float
    start: float
    end: float
    collars: tuple[Collar, ...] = ()


@dataclass(frozen=True)
class ArmBody:
    """Round bars of one diameter [mm] from the z axis through points [mm] in the frame of the arm's shaft."""

    points: tuple[Point, ...]
    diameter: float


Body = ShaftBody | ArmBody


@dataclass(frozen=True, eq=False)
class PosedGear:
    """A gear, the name of its part, and its pose (4, 4) [mm]."""

    name: str
    gear: Gear
    world_from_part: Array

    @property
    def shape(self) -> Gear:
        """Built shape: the gear."""
        return self.gear


@dataclass(frozen=True, eq=False)
class PosedBody:
    """A shaft or an arm, its name, and its pose (4, 4) [mm]."""

    name: str
    shape: Body
    world_from_part: Array


PosedPart = PosedGear | PosedBody | PosedShape
