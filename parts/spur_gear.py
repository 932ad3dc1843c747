"""The solid of an external spur gear: exact arcs and lines, flanks as splines over the roll angle."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import cadquery as cq
import numpy as np
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge
from OCP.Geom import Geom_Curve
from OCP.TopoDS import TopoDS_Vertex

from tol3d.gears import LEFT, RIGHT, Flank, SpurGear
from tol3d.parts.named_solid import NamedEdge, NamedSolid, extruded
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

_Corners = dict[tuple[Flank, str], TopoDS_Vertex]


def build(gear: SpurGear) -> NamedSolid:
    """The gear as one valid solid in its own frame: z the axis, face centre z = 0, tooth 0 on +x.

    Faces: for tooth k (counted counter-clockwise) "tooth k tip" and, with right and left,
    "tooth k right flank", "... fillet" and, where the fillet begins below the base circle,
    "... radial"; "space k root" between teeth k and k+1, unless a full round leaves none;
    "bore" if there is one; "front" (+z) and "back". The u parameter of a flank's face is the roll
    angle [rad], and it leaves the involute by at most FLANK_ERROR.

    Raises:
        GeometryError: no valid solid comes of it.
    """
    bore = [[NamedEdge("bore", _hole(gear))]] if gear.bore > 0.0 else []
    return extruded(list(_outline(gear)), bore, gear.face_width)


def build_tooth(gear: SpurGear) -> NamedSolid:
    """Tooth 0 alone, cut off along the chord between its fillets' ends: its faces are those of `build` to the last bit.

    For gears of so many teeth that all of them would take minutes and gigabytes. The face beneath it is "cut".

    Raises:
        GeometryError: no valid solid comes of it.
    """
    sides: dict[Flank, _Side] = {RIGHT: _side(gear, RIGHT), LEFT: _side(gear, LEFT)}
    corners = _corners(gear, 0, sides)
    tooth = _Tooth(gear, 0, sides, corners)
    tip = arc("tooth 0 tip", circle(gear, (0.0, 0.0), gear.tip_radius), corners[RIGHT, "tip"], corners[LEFT, "tip"])
    chord = BRepBuilderAPI_MakeEdge(corners[LEFT, "bottom"], corners[RIGHT, "bottom"]).Edge()
    outline = [*tooth.rising(), tip, *tooth.falling(), NamedEdge("cut", cq.Edge(chord))]
    return extruded(outline, [], gear.face_width)


# outline ------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Side:
    """One side of tooth 0, from the root circle up: corners [mm] in the transverse plane, and its curves."""

    bottom: Point
    centre: Point
    top: Point
    start: Point
    tip: Point
    flank: Geom_Curve

    @property
    def radial(self) -> bool:
        """Whether a radial line leads from the fillet to the involute."""
        return bool(math.dist(self.top, self.start) > SHORTEST_EDGE)


def _side(gear: SpurGear, flank: Flank) -> _Side:
    ends = gear.flank_points(np.array([gear.form_roll, gear.tip_roll]), flank)
    (start_x, start_y), (tip_x, tip_y) = ends.tolist()
    return _Side(
        bottom=gear.fillet_bottom(flank),
        centre=gear.fillet_centre(flank),
        top=gear.fillet_top(flank),
        start=(start_x, start_y),
        tip=(tip_x, tip_y),
        flank=flank_curve(gear, flank),
    )


def _outline(gear: SpurGear) -> Iterator[NamedEdge]:
    """The transverse section, counter-clockwise, beginning at the root below the right flank of tooth 0."""
    sides: dict[Flank, _Side] = {RIGHT: _side(gear, RIGHT), LEFT: _side(gear, LEFT)}
    corners = [_corners(gear, number, sides) for number in range(gear.teeth)]
    full_round = gear.root_arc <= SHORTEST_EDGE
    if full_round:
        before = corners[-1:] + corners[:-1]
        corners = [own | {(RIGHT, "bottom"): last[LEFT, "bottom"]} for own, last in zip(corners, before, strict=True)]
    tip_circle, root_circle = (circle(gear, (0.0, 0.0), radius) for radius in (gear.tip_radius, gear.root_radius))
    for number, (own, following) in enumerate(zip(corners, corners[1:] + corners[:1], strict=True)):
        tooth = _Tooth(gear, number, sides, own)
        yield from tooth.rising()
        yield arc(f"tooth {number} tip", tip_circle, own[RIGHT, "tip"], own[LEFT, "tip"])
        yield from tooth.falling()
        if not full_round:
            yield arc(f"space {number} root", root_circle, own[LEFT, "bottom"], following[RIGHT, "bottom"])


def _corners(gear: SpurGear, number: int, sides: dict[Flank, _Side]) -> _Corners:
    """Vertices of a tooth by flank and place: bottom, top (of the fillet), start and tip (of the flank)."""
    corners = {}
    for flank, side in sides.items():
        for place in ("bottom", "start", "tip"):
            corners[flank, place] = vertex(gear, turned(gear, number, getattr(side, place)))
        corners[flank, "top"] = vertex(gear, turned(gear, number, side.top)) if side.radial else corners[flank, "start"]
    return corners


@dataclass(frozen=True)
class _Tooth:
    """The edges of one tooth: those of tooth 0, turned."""

    gear: SpurGear
    number: int
    sides: dict[Flank, _Side]
    corners: _Corners

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


def _hole(gear: SpurGear) -> cq.Edge:
    return cq.Edge(BRepBuilderAPI_MakeEdge(circle(gear, (0.0, 0.0), gear.bore / 2, up=-1.0)).Edge())
