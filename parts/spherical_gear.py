"""The solid of a ring-involute spherical gear: the profile of a spur gear turned about its pole."""

import math
from collections.abc import Iterator

import cadquery as cq
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge
from OCP.gp import gp_Ax1, gp_Ax3, gp_Dir, gp_Pln, gp_Pnt, gp_Trsf

from tol3d.errors import GeometryError
from tol3d.gears import LEFT, RIGHT, SpurGear
from tol3d.parts.details import LEAST_WALL
from tol3d.parts.named_solid import NamedEdge, NamedSolid
from tol3d.parts.spur_tooth import Tooth, corners_of, sides_of
from tol3d.parts.tooth_edges import SHORTEST_EDGE, arc, circle, vertex
from tol3d.parts.turned import AXIS, turned

WIDEST_REACH = math.radians(150)
RENAMED = {"tooth": "ring", "right": "inner", "left": "outer"}


def spherical_gear(
    gear: SpurGear, reach: float, *, tooth_at_pole: bool, bore: tuple[float, float] | None = None
) -> NamedSolid:
    """A convex gear about the origin, its pole at +z, its rings of teeth concentric circles about z [mm].

    Two gears of one module mesh where one has a tooth at its pole and the other a space. In any plane through z the
    section is that of the spur gear. Faces: at the pole "pole tip", "pole flank" and "pole fillet" or "pole root"; of
    ring k, counted from the pole from 1 on, "ring k tip", "ring k inner flank" (towards the pole), "ring k inner
    fillet" and the same with outer, each with a "... radial" where the fillet begins below the base circle; "root k"
    behind ring k, and "root 0" before ring 1 where a tooth is at the pole; "bottom"; "bore" and "bore floor". Tips and
    roots are spherical. The u parameter of a flank is its roll angle [rad].

    Args:
        gear: whose profile it is; its face width and its bore do not matter.
        reach: angle from the pole to the edge of the flat bottom [rad]; rings that do not end before it are left out.
        tooth_at_pole: whether a tooth is there, not a space.
        bore: diameter and depth of a blind hole along z from the bottom; None for none.

    Raises:
        GeometryError: no whole ring fits, a full round without roots, or a bore that leaves no wall.
    """
    sides = sides_of(gear)
    pole = 0.0 if tooth_at_pole else math.pi / gear.teeth
    # angles are those about z of the spur gear's section, in which the pole is at `pole`
    bottom = math.atan2(sides[LEFT].bottom[1], sides[LEFT].bottom[0])
    if not 0.0 < reach <= WIDEST_REACH:
        limits = f"more than 0 deg and at most {math.degrees(WIDEST_REACH):g} deg"
        raise GeometryError(f"reach: expected {limits}, got {math.degrees(reach):g} deg")
    if gear.root_arc <= SHORTEST_EDGE:
        raise GeometryError("root_fillet: the full round of a spur gear's space leaves no root to end the teeth in")
    rings = math.floor((reach + pole - bottom - LEAST_WALL / gear.root_radius) / gear.angular_pitch)
    if rings < 1:
        raise GeometryError(f"no ring of teeth ends within a reach of {math.degrees(reach):g} deg")
    edges = list(_section(gear, reach, rings, tooth_at_pole=tooth_at_pole, bore=bore))
    level = -gear.face_width / 2
    axis = gp_Ax1(gp_Pnt(0.0, 0.0, level), gp_Dir(math.cos(pole), math.sin(pole), 0.0))
    plane = gp_Pln(axis.Location(), gp_Dir(0.0, 0.0, 1.0))
    lying = turned(edges, "the spherical gear", plane, axis)
    upright = gp_Trsf()
    # its x, in the section across the pole, becomes that of the gear
    across = gp_Dir(-math.sin(pole), math.cos(pole), 0.0)
    upright.SetDisplacement(gp_Ax3(axis.Location(), axis.Direction(), across), gp_Ax3())
    return lying.moved(cq.Location(upright))


def _section(
    gear: SpurGear, reach: float, rings: int, *, tooth_at_pole: bool, bore: tuple[float, float] | None
) -> Iterator[NamedEdge]:
    """Half the section, from the pole counter-clockwise to the bottom and back along the axis."""
    sides, pole = sides_of(gear), 0.0 if tooth_at_pole else math.pi / gear.teeth
    tips, roots = (circle(gear, (0.0, 0.0), radius) for radius in (gear.tip_radius, gear.root_radius))

    def corner(radius: float, angle: float, beside: float = 0.0) -> object:
        """A vertex at an angle from the pole, and beside the ray to there [mm]."""
        cos, sin = math.cos(pole + angle), math.sin(pole + angle)
        return vertex(gear, (radius * cos - beside * sin, radius * sin + beside * cos))

    def line(name: str, begin: object, end: object) -> NamedEdge:
        return NamedEdge(name, cq.Edge(BRepBuilderAPI_MakeEdge(begin, end).Edge()))

    top = corner(gear.tip_radius if tooth_at_pole else gear.root_radius, 0.0)
    before = top
    if tooth_at_pole:
        corners = corners_of(gear, 0, sides)
        yield arc("pole tip", tips, top, corners[LEFT, "tip"])
        for own in Tooth(gear, 0, sides, corners).falling():
            yield NamedEdge(f"pole {own.name.split()[-1]}", own.edge)
        before = corners[LEFT, "bottom"]
    for number in range(1, rings + 1):
        corners = corners_of(gear, number, sides)
        tooth = Tooth(gear, number, sides, corners)
        name = f"root {number - 1}" if number > 1 or tooth_at_pole else "pole root"
        yield arc(name, roots, before, corners[RIGHT, "bottom"])
        yield from map(_renamed, tooth.rising())
        yield arc(f"ring {number} tip", tips, corners[RIGHT, "tip"], corners[LEFT, "tip"])
        yield from map(_renamed, tooth.falling())
        before = corners[LEFT, "bottom"]
    edge, height, wide = corner(gear.root_radius, reach), gear.root_radius * math.cos(reach), 0.0
    yield arc(f"root {rings}", roots, before, edge)
    foot = corner(height, 0.0)
    if bore is not None:
        wide, deep = bore[0] / 2, bore[1]
        _refuse_bore(gear, reach, *bore)
        foot = corner(height + deep, 0.0)
        mouth, end = corner(height, 0.0, wide), corner(height + deep, 0.0, wide)
        yield line("bottom", edge, mouth)
        yield line("bore", mouth, end)
        yield line("bore floor", end, foot)
    else:
        yield line("bottom", edge, foot)
    yield line(AXIS, foot, top)


def _refuse_bore(gear: SpurGear, reach: float, diameter: float, depth: float) -> None:
    radius, height = gear.root_radius, gear.root_radius * math.cos(reach)
    if not LEAST_WALL <= diameter / 2 <= radius * math.sin(reach) - LEAST_WALL:
        raise GeometryError(
            f"bore: expected less than the bottom, {2 * radius * math.sin(reach):.4f} mm, got {diameter:g} mm"
        )
    room = math.sqrt(radius**2 - (diameter / 2) ** 2) - height
    if not LEAST_WALL <= depth <= room - LEAST_WALL:
        raise GeometryError(f"bore_depth: expected less than {room:.4f} mm, up to the roots, got {depth:g} mm")


def _renamed(edge: NamedEdge) -> NamedEdge:
    return NamedEdge(" ".join(RENAMED.get(word, word) for word in edge.name.split()), edge.edge)
