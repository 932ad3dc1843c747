"""The edges of a tooth of an external spur gear, in the plane z = -b/2: those of tooth 0, turned."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import cadquery as cq
import numpy as np
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge
from OCP.Geom import Geom_Curve
from OCP.TopoDS import TopoDS_Vertex

from tol3d.gears import LEFT, RIGHT, Flank, SpurGear
from tol3d.parts.named_solid import NamedEdge
from tol3d.parts.tooth_edges import (
    SHORTEST_EDGE,
    SIDES,
    Point,
    arc,
    circle,
    flank_curve,
    flank_edge,
    turned,
    vertex,
)

Corners = Mapping[tuple[Flank, str], TopoDS_Vertex]
"""Vertices of a tooth by flank and place: bottom, top (of the fillet), start and tip (of the flank)."""


@dataclass(frozen=True)
class Side:
    """One side of tooth 0, from the root circle up: corners [mm] in the transverse plane, and its curves."""

    bottom: Point
    centre: Point
    top: Point
    start: Point
    tip: Point
    flank: Geom_Curve

    @property
    def radial(self) -> bool:
        """True where a radial line leads from the fillet to the involute."""
        return bool(math.dist(self.top, self.start) > SHORTEST_EDGE)


def sides_of(gear: SpurGear) -> Mapping[Flank, Side]:
    """Both sides of tooth 0."""
    return {flank: _side(gear, flank) for flank in (RIGHT, LEFT)}


def _side(gear: SpurGear, flank: Flank) -> Side:
    ends = gear.flank_points(np.array([gear.form_roll, gear.tip_roll]), flank)
    (start_x, start_y), (tip_x, tip_y) = ends.tolist()
    return Side(
        bottom=gear.fillet_bottom(flank),
        centre=gear.fillet_centre(flank),
        top=gear.fillet_top(flank),
        start=(start_x, start_y),
        tip=(tip_x, tip_y),
        flank=flank_curve(gear, flank),
    )


def corners_of(gear: SpurGear, number: int, sides: Mapping[Flank, Side]) -> Corners:
    """The vertices of a tooth."""
    corners = {}
    for flank, side in sides.items():
        for place in ("bottom", "start", "tip"):
            corners[flank, place] = vertex(gear, turned(gear, number, getattr(side, place)))
        corners[flank, "top"] = vertex(gear, turned(gear, number, side.top)) if side.radial else corners[flank, "start"]
    return corners


@dataclass(frozen=True)
class Tooth:
    """The edges of one tooth."""

    gear: SpurGear
    number: int
    sides: Mapping[Flank, Side]
    corners: Corners

    def rising(self) -> Iterator[NamedEdge]:
        """Right side, from the root circle to the tip."""
        yield self._fillet(RIGHT, "bottom", "top")
        yield from self._radial(RIGHT, "top", "start")
        yield self._flank(RIGHT)

    def falling(self) -> Iterator[NamedEdge]:
        """Left side, from the tip to the root circle; its flank is walked against its roll."""
        upwards = self._flank(LEFT)
        yield NamedEdge(upwards.name, cq.Edge(upwards.edge.wrapped.Reversed()))
        yield from self._radial(LEFT, "start", "top")
        yield self._fillet(LEFT, "top", "bottom")

    def _fillet(self, flank: Flank, begin: str, end: str) -> NamedEdge:
        centre = turned(self.gear, self.number, self.sides[flank].centre)
        around = circle(self.gear, centre, self.gear.fillet_radius, up=-1.0)
        name = f"tooth {self.number} {SIDES[flank]} fillet"
        return arc(name, around, self.corners[flank, begin], self.corners[flank, end])

    def _radial(self, flank: Flank, begin: str, end: str) -> Iterator[NamedEdge]:
        if self.sides[flank].radial:
            edge = BRepBuilderAPI_MakeEdge(self.corners[flank, begin], self.corners[flank, end]).Edge()
            yield NamedEdge(f"tooth {self.number} {SIDES[flank]} radial", cq.Edge(edge))

    def _flank(self, flank: Flank) -> NamedEdge:
        ends = self.corners[flank, "start"], self.corners[flank, "tip"]
        return flank_edge(self.gear, self.number, flank, self.sides[flank].flank, ends)
