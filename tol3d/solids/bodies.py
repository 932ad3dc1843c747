"""What is drawn of a train besides its gears: plain shafts and arms, described by their lengths."""

from dataclasses import dataclass

Point = tuple[float, float, float]
Collar = tuple[float, float, float]


@dataclass(frozen=True)
class ShaftBody:
    """A cylinder about z from start to end [mm], thicker where it has collars: diameter, start and end of each."""

    diameter: float
    start: float
    end: float
    collars: tuple[Collar, ...] = ()


@dataclass(frozen=True)
class ArmBody:
    """Round bars of a diameter [mm] from the z axis through points [mm] in the frame of the arm's shaft."""

    points: tuple[Point, ...]
    diameter: float


Body = ShaftBody | ArmBody
