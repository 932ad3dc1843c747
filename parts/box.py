"""The solid of a box along the axes with its six faces named, and frames on them to cut into."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import cadquery as cq
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
from OCP.gp import gp_Pnt

from tol3d.errors import GeometryError
from tol3d.parts.details import Place
from tol3d.parts.named_solid import NamedSolid

LEAST_WALL: Final = 1e-3  # mm; far above OCC's point tolerance of 1e-7, and no machined wall is thinner

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
"""Sides of a part that lies flat: seen from the front with its top up, x points to the right."""


@dataclass(frozen=True)
class Box:
    """A box from its least corner to its largest [mm], with its sides by name."""

    low: Point
    high: Point
    sides: Mapping[str, Side]

    def level(self, side: Side) -> float:
        """Where the face of a side is along its axis [mm]."""
        return (self.high if side.sign > 0 else self.low)[side.axis]

    def depth(self, side: Side) -> float:
        """From a side to the opposite one [mm]."""
        return self.high[side.axis] - self.low[side.axis]

    def refuse_outside(self, words: str, side: Side, at: Place, reach: Place) -> None:
        """Raise unless what is round a place on a side lies within it.

        Args:
            words: what it is.
            side: of the box.
            at: the place [mm].
            reach: how far it reaches from there along both coordinates [mm].
        """
        for axis, place, half in zip(side.across, at, reach, strict=True):
            low, high = place - half, place + half
            if low - self.low[axis] < LEAST_WALL or self.high[axis] - high < LEAST_WALL:
                name = next(name for name, own in self.sides.items() if own == side)
                room = f"{self.low[axis]:g} mm to {self.high[axis]:g} mm"
                raise GeometryError(
                    f"{words} leaves the {name}: along {'xyz'[axis]} it reaches from {low:g} mm to {high:g} mm, "
                    f"the {name} from {room}"
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
