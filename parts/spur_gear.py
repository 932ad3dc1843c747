"""The solid of an external spur or helical gear: exact arcs and lines, flanks as splines over the roll angle.

A helical gear's transverse outline is swept along its helices, see twisted_solid.py.
"""

from collections.abc import Iterator

import cadquery as cq
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge

from tol3d.gears import LEFT, RIGHT, SpurGear
from tol3d.parts.named_solid import NamedEdge, NamedSolid, extruded
from tol3d.parts.spur_tooth import Tooth, corners_of, sides_of
from tol3d.parts.tooth_edges import SHORTEST_EDGE, arc, circle
from tol3d.parts.twisted_solid import swept


def build(gear: SpurGear) -> NamedSolid:
    """The gear as one valid solid in its own frame: z the axis, face centre z = 0, tooth 0 on +x.

    Faces: for tooth k (counted counter-clockwise) "tooth k tip" and, with right and left,
    "tooth k right flank", "... fillet" and, where the fillet begins below the base circle,
    "... radial"; "space k root" between teeth k and k+1, unless a full round leaves none;
    "bore" if there is one; "front" (+z) and "back". The u parameter of a flank's face is the roll
    angle [rad], of a helical gear v is z, and it leaves the involute by at most FLANK_ERROR.

    Raises:
        GeometryError: no valid solid comes of it.
    """
    return swept(gear, list(_outline(gear)), _bore(gear))


def build_straight(gear: SpurGear) -> NamedSolid:
    """The gear with its transverse section swept straight along z; of a spur gear the same as `build`.

    Raises:
        GeometryError: no valid solid comes of it.
    """
    return extruded(list(_outline(gear)), _bore(gear), gear.face_width)


def _bore(gear: SpurGear) -> list[list[NamedEdge]]:
    return [[NamedEdge("bore", _hole(gear))]] if gear.bore > 0.0 else []


def build_tooth(gear: SpurGear) -> NamedSolid:
    """Tooth 0 alone, cut off along the chord between its fillets' ends: its faces are those of `build` to the last bit.

    For gears of so many teeth that all of them would take minutes and gigabytes. The face beneath it is "cut".

    Raises:
        GeometryError: no valid solid comes of it.
    """
    sides = sides_of(gear)
    corners = corners_of(gear, 0, sides)
    tooth = Tooth(gear, 0, sides, corners)
    tip = arc("tooth 0 tip", circle(gear, (0.0, 0.0), gear.tip_radius), corners[RIGHT, "tip"], corners[LEFT, "tip"])
    chord = BRepBuilderAPI_MakeEdge(corners[LEFT, "bottom"], corners[RIGHT, "bottom"]).Edge()
    outline = [*tooth.rising(), tip, *tooth.falling(), NamedEdge("cut", cq.Edge(chord))]
    return swept(gear, outline, [])


# outline ------------------------------------------------------------------------------------------


def _outline(gear: SpurGear) -> Iterator[NamedEdge]:
    """The transverse section, counter-clockwise, beginning at the root below the right flank of tooth 0."""
    sides = sides_of(gear)
    corners = [corners_of(gear, number, sides) for number in range(gear.teeth)]
    full_round = gear.root_arc <= SHORTEST_EDGE
    if full_round:
        before = corners[-1:] + corners[:-1]
        corners = [{**own, (RIGHT, "bottom"): last[LEFT, "bottom"]} for own, last in zip(corners, before, strict=True)]
    tip_circle, root_circle = (circle(gear, (0.0, 0.0), radius) for radius in (gear.tip_radius, gear.root_radius))
    for number, (own, following) in enumerate(zip(corners, corners[1:] + corners[:1], strict=True)):
        tooth = Tooth(gear, number, sides, own)
        yield from tooth.rising()
        yield arc(f"tooth {number} tip", tip_circle, own[RIGHT, "tip"], own[LEFT, "tip"])
        yield from tooth.falling()
        if not full_round:
            yield arc(f"space {number} root", root_circle, own[LEFT, "bottom"], following[RIGHT, "bottom"])


def _hole(gear: SpurGear) -> cq.Edge:
    return cq.Edge(BRepBuilderAPI_MakeEdge(circle(gear, (0.0, 0.0), gear.bore / 2, up=-1.0)).Edge())
