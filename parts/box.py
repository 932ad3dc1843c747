"""The solid of a box along the axes with its six faces named, and frames on them to cut into."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import cadquery as cq
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
from OCP.gp import gp_Pnt

from tol3d.errors import GeometryError
from tol3d.parts.details import LEAST_WALL, Place
from tol3d.parts.named_solid import NamedSolid

Point = tuple[float, float, float]


@dataclass(frozen=True)
class Side:
    """A side of a box: the axis (0, 1, 2) that its face is square to, and which end of it (1 or -1)."""

    axis: int
    sign: int

    @property
    def across(self) -> tuple[int, int]:
        """The other two axes."""
        first, second = (axis for axis in range(3) if axis != self.axis)
        return first, second


TOP_IS_Z: Final[Mapping[str, Side]] = {
    "top": Side(2, 1),
    "bottom": Side(2, -1),
    "left": Side(0, -1),
    "right": Side(0, 1),
    "front": Side(1, -1),
    "back": Side(1, 1),
}
"""Sides of a part whose top is at +z: seen from the front with its top up, x points to the right."""

TOP_IS_Y: Final[Mapping[str, Side]] = {
    "top": Side(1, 1),
    "bottom": Side(1, -1),
    "left": Side(0, -1),
    "right": Side(0, 1),
    "front": Side(2, 1),
    "back": Side(2, -1),
}
"""Sides of a part whose top is at +y, seen in the same way."""


@dataclass(frozen=True)
class Box:
    """A box from its least corner to its largest [mm], with its sides by name."""

    low: Point
    high: Point
    sides: Mapping[str, Side]

    def side(self, name: str, words: str) -> Side:
        """A side by its name.

        Raises:
            GeometryError: there is none; `words` says what is on it.
        """
        if name not in self.sides:
            raise GeometryError(f"{words} is on the {name!r}; expected one of {', '.join(self.sides)}")
        return self.sides[name]

    def level(self, side: Side) -> float:
        """Place of the face of a side along its axis [mm]."""
        return (self.high if side.sign > 0 else self.low)[side.axis]

    def depth(self, side: Side) -> float:
        """From a side to the opposite one [mm]."""
        return self.high[side.axis] - self.low[side.axis]

    def refuse_flat(self, words: str) -> None:
        """Raise unless the box has a volume; `words` says what it is."""
        sizes = [high - low for low, high in zip(self.low, self.high, strict=True)]
        if not all(LEAST_WALL <= size < math.inf for size in sizes):
            raise GeometryError(f"{words} of {' by '.join(f'{size:g} mm' for size in sizes)} has no volume")

    def refuse_outside(self, words: str, face: str, at: Place, reach: Place) -> None:
        """Raise unless what is round a place on a face lies within it.

        Args:
            words: what it is.
            face: of the box.
            at: the place [mm].
            reach: how far it reaches from there along both coordinates [mm].
        """
        for axis, place, half in zip(self.sides[face].across, at, reach, strict=True):
            low, high = place - half, place + half
            # not so turned round that NaN would pass
            if not (low - self.low[axis] >= LEAST_WALL and self.high[axis] - high >= LEAST_WALL):
                raise GeometryError(
                    f"{words} leaves the {face}: along {'xyz'[axis]} it reaches from {low:g} mm to {high:g} mm, "
                    f"the {face} from {self.low[axis]:g} mm to {self.high[axis]:g} mm"
                )

    def solid(self) -> NamedSolid:
        """As one, its faces by the names of its sides."""
        made = BRepPrimAPI_MakeBox(gp_Pnt(*self.low), gp_Pnt(*self.high))
        solid = cq.Solid(made.Solid())
        # what OCC calls top and bottom are ends of z, left and right those of y, back and front those of x
        ends = {
            Side(0, -1): made.BackFace(),
            Side(0, 1): made.FrontFace(),
            Side(1, -1): made.LeftFace(),
            Side(1, 1): made.RightFace(),
            Side(2, -1): made.BottomFace(),
            Side(2, 1): made.TopFace(),
        }
        outward = {face: face for face in solid.Faces()}
        return NamedSolid(solid, {name: outward[cq.Face(ends[side])] for name, side in self.sides.items()})
