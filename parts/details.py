"""Cuts and bosses of a part, by numbers: holes, slots and pins. Loads no CAD."""

import math
from dataclasses import dataclass
from typing import Final

from tol3d.errors import GeometryError

LEAST_WALL: Final = 1e-3  # mm; far above OCC's point tolerance of 1e-7, and no machined wall is thinner

Place = tuple[float, float]
"""Two coordinates of the part [mm]: x, y and z in this order without the one that a face is square to."""


class DetailError(GeometryError):
    """A detail is at fault.

    Args:
        sentence: what is wrong with it.
        name: its name.
    """

    def __init__(self, sentence: str, name: str) -> None:
        super().__init__(sentence)
        self.name = name


@dataclass(frozen=True)
class Round:
    """Round detail about an axis square to its face: a name, the place of the axis, a diameter [mm]."""

    name: str
    at: Place
    diameter: float

    @property
    def reach(self) -> Place:
        """Reach from its place along both coordinates [mm]."""
        return self.diameter / 2, self.diameter / 2


@dataclass(frozen=True)
class Hole(Round):
    """A drilled hole.

    Args:
        name: its wall's; the flat end of a blind hole is the face "NAME floor".
        at: its axis on the face.
        diameter: [mm].
        depth: [mm] of a blind hole, from the face; through the material if None.
        face: that it is drilled into.
    """

    depth: float | None = None
    face: str = "top"

    @property
    def words(self) -> str:
        """For messages."""
        return f"hole {self.name!r} (diameter {self.diameter:g} mm at {place_words(self.at)})"


@dataclass(frozen=True)
class Slot:
    """A milled slot with round ends.

    Args:
        name: its walls are "NAME left wall" and "NAME right wall" (looking onto the face, along the slot), its round
            ends "NAME start" and "NAME end", the flat end of a blind slot "NAME floor".
        at: its middle on the face.
        length: from end to end [mm].
        width: between the walls [mm].
        turned: from the face's first coordinate towards its second [rad].
        depth: [mm] of a blind slot, from the face; through the material if None.
        face: that it is milled into.
    """

    name: str
    at: Place
    length: float
    width: float
    turned: float = 0.0
    depth: float | None = None
    face: str = "top"

    @property
    def reach(self) -> Place:
        """Reach from its place along both coordinates [mm]."""
        straight = (self.length - self.width) / 2
        return (
            straight * abs(math.cos(self.turned)) + self.width / 2,
            straight * abs(math.sin(self.turned)) + self.width / 2,
        )

    @property
    def words(self) -> str:
        """For messages."""
        return f"slot {self.name!r} ({self.length:g} mm by {self.width:g} mm at {place_words(self.at)})"


@dataclass(frozen=True)
class Pin(Round):
    """A round pin that stands on the top, or on a rim: its side is the face "NAME", its end "NAME end".

    Args:
        name: its side's.
        at: its axis.
        diameter: [mm].
        height: above what it stands on [mm].
    """

    height: float

    @property
    def words(self) -> str:
        """For messages."""
        return f"pin {self.name!r} (diameter {self.diameter:g} mm at {place_words(self.at)})"


@dataclass(frozen=True)
class Bore(Round):
    """A bore through an end wall of a housing, and through the boss that it lies in; its wall is the face "NAME".

    Args:
        name: its wall's.
        at: x and y of its axis.
        diameter: [mm].
        wall: "front" (+z) or "back" (-z).
    """

    wall: str

    @property
    def words(self) -> str:
        """For messages."""
        return f"bore {self.name!r} (diameter {self.diameter:g} mm at {place_words(self.at)} of the {self.wall})"


@dataclass(frozen=True)
class Boss(Round):
    """A round boss on the outside of an end wall of a housing: its side is the face "NAME", its end "NAME end".

    Args:
        name: its side's.
        at: x and y of its axis.
        diameter: [mm].
        height: above the wall [mm].
        wall: "front" (+z) or "back" (-z).
    """

    height: float
    wall: str

    @property
    def words(self) -> str:
        """For messages."""
        return f"boss {self.name!r} (diameter {self.diameter:g} mm at {place_words(self.at)} of the {self.wall})"


@dataclass(frozen=True)
class Spigot:
    """A rectangular register below the seat of a cover, which reaches into an opening.

    Args:
        length, width, height: along x and y, and below the seat [mm].
        at: its middle on the seat.
    """

    length: float
    width: float
    height: float
    at: Place = (0.0, 0.0)

    @property
    def reach(self) -> Place:
        """Reach from its place along both coordinates [mm]."""
        return self.length / 2, self.width / 2

    @property
    def words(self) -> str:
        """For messages."""
        return f"the spigot ({self.length:g} mm by {self.width:g} mm at {place_words(self.at)})"


Detail = Hole | Slot | Pin | Bore | Boss


def place_words(at: Place) -> str:
    """A place for messages: [10, -5] mm."""
    return f"[{at[0]:g}, {at[1]:g}] mm"
