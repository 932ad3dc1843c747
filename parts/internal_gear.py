"""The solid of an internal spur or helical gear: a round rim, exact arcs, flanks as splines over the roll angle.

A helical gear's transverse section is swept along its helices, see twisted_solid.py.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import cadquery as cq
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge
from OCP.Geom import Geom_Curve
from OCP.TopoDS import TopoDS_Vertex

from tol3d.gears import LEFT, RIGHT, Flank, InternalGear
from tol3d.parts.named_solid import NamedEdge, NamedSolid, extruded
from tol3d.parts.tooth_edges import (
    SHORTEST_EDGE,
    SIDES,
    Point,
    arc,
    circle,
    flank_curve,
    flank_edge,
    flank_name,
    turned,
    vertex,
)
from tol3d.parts.twisted_solid import swept

Place = Literal["bottom", "form", "tip"]
_Corners = dict[tuple[Flank, Place], TopoDS_Vertex]


def build(gear: InternalGear) -> NamedSolid:
    """The ring as one valid solid in its own frame: z the axis, face centre z = 0, the middle of tooth 0 on +x.

    Faces: for tooth k (counted counter-clockwise) "tooth k tip" and, with right and left, "tooth k right flank" and
    "... fillet"; "space k root" between teeth k and k+1, unless a full round leaves none; "rim"; "front" (+z) and
    "back". The u parameter of a flank's face is the roll angle [rad], of a helical gear v is z, and it leaves the
    involute by at most FLANK_ERROR.

    Raises:
        GeometryError: no valid solid comes of it.
    """
    return swept(gear, [_rim(gear)], [list(_outline(gear))])


def build_straight(gear: InternalGear) -> NamedSolid:
    """The ring with its transverse section swept straight along z; of a spur gear the same as `build`.

    Raises:
        GeometryError: no valid solid comes of it.
    """
    return extruded([_rim(gear)], [list(_outline(gear))], gear.face_width)


def _rim(gear: InternalGear) -> NamedEdge:
    outside = circle(gear, (0.0, 0.0), gear.rim_diameter / 2)
    return NamedEdge("rim", cq.Edge(BRepBuilderAPI_MakeEdge(outside).Edge()))


def build_tooth(gear: InternalGear) -> NamedSolid:
    """Tooth 0 alone, cut out of the rim behind its fillets' ends: its faces are those of `build` to the last bit.

    Those of a helical ring are within the error of its helices, see twisted_solid.py, whose rim has finer ones.
    For gears of so many teeth that all of them would take minutes and gigabytes. The faces behind it are "cut" and
    "right cut", "left cut" beside it.

    Raises:
        GeometryError: no valid solid comes of it.
    """
    sides = _sides(gear)
    corners = _corners(gear, 0, sides)
    share = 1 + gear.module / gear.root_radius
    behind = {flank: vertex(gear, (share * side.bottom[0], share * side.bottom[1])) for flank, side in sides.items()}
    lines = (
        ("right cut", corners[RIGHT, "bottom"], behind[RIGHT]),
        ("cut", behind[RIGHT], behind[LEFT]),
        ("left cut", behind[LEFT], corners[LEFT, "bottom"]),
    )
    cut = [NamedEdge(name, cq.Edge(BRepBuilderAPI_MakeEdge(begin, end).Edge())) for name, begin, end in lines]
    return swept(gear, [*cut, *_tooth(gear, 0, sides, corners)], [])


# outline ------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Side:
    """One side of tooth 0: corners [mm] in the transverse plane, its fillet's centre and its flank."""

    bottom: Point
    centre: Point
    form: Point
    tip: Point
    flank: Geom_Curve

    def at(self, place: Place) -> Point:
        """One of its corners."""
        return {"bottom": self.bottom, "form": self.form, "tip": self.tip}[place]


def _sides(gear: InternalGear) -> dict[Flank, _Side]:
    return {flank: _side(gear, flank) for flank in (RIGHT, LEFT)}


def _side(gear: InternalGear, flank: Flank) -> _Side:
    curve = flank_curve(gear, flank)
    tip = curve.Value(gear.tip_roll)
    return _Side(
        bottom=gear.fillet_bottom(flank),
        centre=gear.fillet_centre(flank),
        form=gear.fillet_top(flank),
        tip=(tip.X(), tip.Y()),
        flank=curve,
    )


def _corners(gear: InternalGear, number: int, sides: dict[Flank, _Side]) -> _Corners:
    """Vertices of a tooth by flank and place: bottom and form (of the fillet), tip (of the flank)."""
    places: tuple[Place, ...] = ("bottom", "form", "tip")
    return {
        (flank, place): vertex(gear, turned(gear, number, side.at(place)))
        for flank, side in sides.items()
        for place in places
    }


def _outline(gear: InternalGear) -> Iterator[NamedEdge]:
    """The hollow's section, clockwise, from the last tooth to tooth 0."""
    sides = _sides(gear)
    corners = [_corners(gear, number, sides) for number in range(gear.teeth)]
    full_round = gear.root_arc <= SHORTEST_EDGE
    if full_round:
        before = corners[-1:] + corners[:-1]
        corners = [own | {(RIGHT, "bottom"): last[LEFT, "bottom"]} for own, last in zip(corners, before, strict=True)]
    root = circle(gear, (0.0, 0.0), gear.root_radius, up=-1.0)
    for number in reversed(range(gear.teeth)):
        yield from _tooth(gear, number, sides, corners[number])
        if not full_round:
            space = (number - 1) % gear.teeth
            yield arc(f"space {space} root", root, corners[number][RIGHT, "bottom"], corners[space][LEFT, "bottom"])


def _tooth(gear: InternalGear, number: int, sides: dict[Flank, _Side], corners: _Corners) -> Iterator[NamedEdge]:
    """The edges of one tooth, clockwise about the gear: left side inwards, tip, right side outwards."""
    flanks = {
        flank: flank_edge(gear, number, flank, side.flank, (corners[flank, "tip"], corners[flank, "form"]))
        for flank, side in sides.items()
    }
    fillets = {
        flank: circle(gear, turned(gear, number, side.centre), gear.fillet_radius, up=-1.0)
        for flank, side in sides.items()
    }
    names = {flank: f"tooth {number} {SIDES[flank]} fillet" for flank in sides}
    yield arc(names[LEFT], fillets[LEFT], corners[LEFT, "bottom"], corners[LEFT, "form"])
    yield NamedEdge(flank_name(number, LEFT), cq.Edge(flanks[LEFT].edge.wrapped.Reversed()))
    tip = circle(gear, (0.0, 0.0), gear.tip_radius, up=-1.0)
    yield arc(f"tooth {number} tip", tip, corners[LEFT, "tip"], corners[RIGHT, "tip"])
    yield flanks[RIGHT]
    yield arc(names[RIGHT], fillets[RIGHT], corners[RIGHT, "form"], corners[RIGHT, "bottom"])
