"""Shafts and what hangs on them: gears, arms, and the trains that they make."""

import math
from dataclasses import dataclass

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
