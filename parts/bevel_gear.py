"""The solid of a straight bevel gear: exact cones and planes, flanks ruled from the apex over a spline in q.

No cutting: every face is laid on its own surface and trimmed by edges that neighbours share, so names are known and
nothing has to be found again.
"""

import math
from collections.abc import Iterator, Sequence
from typing import Final

import cadquery as cq
from OCP.BRep import BRep_Builder
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakeVertex
from OCP.BRepLib import BRepLib
from OCP.BRepPrimAPI import BRepPrimAPI_MakePrism
from OCP.Geom import Geom_Circle, Geom_Curve, Geom_Plane, Geom_Surface
from OCP.Geom2d import Geom2d_Curve
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt, gp_Vec
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Edge, TopoDS_Shell, TopoDS_Solid, TopoDS_Vertex, TopoDS_Wire

from tol3d.errors import GeometryError
from tol3d.gears import LEFT, RIGHT, BevelGear, Flank
from tol3d.parts.bevel_cones import ENDS, HEEL, TOE, End, EndCone, across, apex_cone, falling, level, ray, upright
from tol3d.parts.bevel_flank import curve, flank_splines, greville, ruled, trace
from tol3d.parts.named_solid import NamedSolid
from tol3d.parts.tooth_edges import SHORTEST_EDGE, SIDES, flank_name

EDGE_TOLERANCE = 1e-6  # mm; what the ends of flanks, splines on three surfaces at once, may differ by
FRONT_FACE, MOUNTING_FACE, BORE = "front face", "mounting face", "bore"
FLANKS: Final[tuple[Flank, Flank]] = (RIGHT, LEFT)

Key = tuple[object, ...]
_Trace = tuple[Key, Geom2d_Curve]


def build(gear: BevelGear) -> NamedSolid:
    """The gear as one valid solid in its own frame: apex at the origin, z the axis, tooth 0 on +x.

    Teeth end on the front and back cones, which stand upright on the pitch line at the inner and the outer cone
    distance. Below the root these cones go on for a rim; there the blank ends in a flat face towards the apex and
    the mounting face behind the heel. Where the root cone lies below the base cone the flank goes on in its meridian.

    Faces: for tooth k (counted counter-clockwise) "tooth k tip", "tooth k toe" and "tooth k heel" (with half the
    space on either side), and with right and left "tooth k right flank" and, below the base cone, "tooth k right
    radial"; "space k root" between teeth k and k+1; "front face", "mounting face"; "bore" if there is one. The u
    parameter of a flank's face is the in-plane angle q [rad], v the distance from the apex [mm]; it leaves the
    spherical involute by at most FLANK_ERROR.

    Raises:
        GeometryError: no valid solid comes of it.
    """
    net = _Net(gear)
    faces = dict(net.faces())
    shell, builder, solid = TopoDS_Shell(), BRep_Builder(), TopoDS_Solid()
    builder.MakeShell(shell)
    for face in faces.values():
        builder.Add(shell, face.wrapped)
    shell.Closed(True)
    builder.MakeSolid(solid)
    builder.Add(solid, shell)
    BRepLib.UpdateTolerances_s(solid)
    whole = cq.Solid(solid)
    if not whole.isValid():
        raise GeometryError("the faces of the bevel gear do not close into a valid solid")
    return NamedSolid(whole, faces)


# the net of faces ---------------------------------------------------------------------------------------


class _Net:
    """All vertices, edges and faces. Keys tell what they are: a tooth or space number, a flank, a place, an end."""

    def __init__(self, gear: BevelGear) -> None:
        self._gear = gear
        self._cones = {end: EndCone(gear, end) for end in ENDS}
        self._splines = {flank: flank_splines(gear, flank) for flank in FLANKS}
        self._radial = gear.root_angle < gear.base_angle - SHORTEST_EDGE / gear.outer_cone_distance
        start = max(gear.root_angle, gear.base_angle)
        self._polar = {"root": gear.root_angle if self._radial else start, "start": start, "tip": gear.tip_angle}
        self._half = {place: gear.half_angle_at(polar) for place, polar in self._polar.items()}
        self._surfaces: dict[Key, Geom_Surface] = {}
        self._vertices: dict[Key, TopoDS_Vertex] = {}
        self._edges: dict[Key, TopoDS_Edge] = {}
        numbers = range(gear.teeth)
        for number in numbers:
            self._add_surfaces(number)
            self._add_vertices(number)
        for number in numbers:
            self._add_arcs(number)
            for flank in FLANKS:
                self._add_flank_edges(number, flank)

    def _middle(self, number: int) -> float:
        """Azimuth [rad] of a tooth's middle."""
        return self._gear.angular_pitch * number

    def _wrapped(self, number: int) -> int:
        return number % self._gear.teeth

    def _add_surfaces(self, number: int) -> None:
        gear, middle = self._gear, self._middle(number)
        polars = (self._polar["root"], gear.tip_angle)
        reaches = [
            pick(cone.reach(polar) for cone in self._cones.values() for polar in (*polars, gear.pitch_angle))
            for pick in (min, max)
        ]
        for flank in FLANKS:
            self._surfaces["flank", number, flank] = ruled(self._splines[flank].direction, middle, reaches)
        self._surfaces["tip", number] = apex_cone(gear.tip_angle, middle)
        self._surfaces["root", number] = apex_cone(self._polar["root"], middle + gear.angular_pitch / 2)
        for end, cone in self._cones.items():
            self._surfaces[end, number] = cone.surface(middle)

    def _add_vertices(self, number: int) -> None:
        gear, middle = self._gear, self._middle(number)
        for end, cone in self._cones.items():
            for flank in FLANKS:
                for place, polar in self._polar.items():
                    point = cone.point(cone.v_at(polar), middle - flank * self._half[place])
                    self._vertices[number, flank, place, end] = BRepBuilderAPI_MakeVertex(point).Vertex()
                if not self._radial:
                    self._vertices[number, flank, "root", end] = self._vertices[number, flank, "start", end]
            for place, v in (("middle", cone.v_at(self._polar["root"])), ("rim", cone.rim)):
                point = cone.point(v, middle + gear.angular_pitch / 2)
                self._vertices[number, place, end] = BRepBuilderAPI_MakeVertex(point).Vertex()

    def _add_edge(
        self, key: Key, on: Geom_Curve, ends: tuple[Key, Key], reach: tuple[float, float], traces: Sequence[_Trace]
    ) -> None:
        """An edge along a curve between two vertices, with its traces on the curved surfaces that it trims."""
        begin, end = (self._vertices[name] for name in ends)
        edge = BRepBuilderAPI_MakeEdge(on, begin, end, *reach).Edge()
        for surface, drawn in traces:
            BRep_Builder().UpdateEdge(edge, drawn, self._surfaces[surface], TopLoc_Location(), EDGE_TOLERANCE)
        self._edges[key] = edge

    def _add_arcs(self, number: int) -> None:
        """Circles and straight lines of toe and heel; u = pi - (azimuth - middle) on their cones."""
        gear, middle, half_pitch = self._gear, self._middle(number), self._gear.angular_pitch / 2
        before, after = self._wrapped(number - 1), self._wrapped(number + 1)
        for end, cone in self._cones.items():
            tip, root, rim = cone.v_at(gear.tip_angle), cone.v_at(self._polar["root"]), cone.rim
            own: Key = (end, number)
            half = self._half["tip"]
            self._add_edge(
                (number, "tip", end),
                cone.circle(tip, middle),
                ((number, LEFT, "tip", end), (number, RIGHT, "tip", end)),
                (math.pi - half, math.pi + half),
                [(own, level(tip)), (("tip", number), falling(2 * math.pi, cone.reach(gear.tip_angle)))],
            )
            half, reach = self._half["root"], cone.reach(self._polar["root"])
            circle = cone.circle(root, middle)
            self._add_edge(
                (number, RIGHT, "root", end),
                circle,
                ((number, RIGHT, "root", end), (before, "middle", end)),
                (math.pi + half, math.pi + half_pitch),
                [(own, level(root)), (("root", before), falling(2 * math.pi + half_pitch, reach))],
            )
            self._add_edge(
                (number, LEFT, "root", end),
                circle,
                ((number, "middle", end), (number, LEFT, "root", end)),
                (math.pi - half_pitch, math.pi - half),
                [(own, level(root)), (("root", number), falling(2 * math.pi - half_pitch, reach))],
            )
            self._add_edge(
                (number, "rim", end),
                cone.circle(rim, middle),
                ((number, "rim", end), (before, "rim", end)),
                (math.pi - half_pitch, math.pi + half_pitch),
                [(own, level(rim))],
            )
            self._add_edge(
                (number, "spoke", end),
                cone.generator(middle + half_pitch),
                ((number, "rim", end), (number, "middle", end)),
                (rim, root),
                [(own, upright(math.pi - half_pitch)), ((end, after), upright(math.pi + half_pitch))],
            )

    def _add_flank_edges(self, number: int, flank: Flank) -> None:
        """The flank's curves at toe and heel, and the straight lines along the face."""
        gear, half_pitch = self._gear, self._gear.angular_pitch / 2
        middle, face = self._middle(number), ("flank", number, flank)
        for end, cone in self._cones.items():
            spline = self._splines[flank].ends[end]
            _, _, _, reach, azimuth, v = spline.c.T
            self._add_edge(
                (number, flank, "profile", end),
                curve(spline, middle),
                ((number, flank, "start", end), (number, flank, "tip", end)),
                (gear.form_q, gear.tip_q),
                [
                    (face, trace(spline, greville(spline), reach)),
                    ((end, number), trace(spline, math.pi - azimuth, v)),
                ],
            )
            if self._radial:
                self._add_edge(
                    (number, flank, "radial", end),
                    cone.generator(middle - flank * self._half["root"]),
                    ((number, flank, "root", end), (number, flank, "start", end)),
                    (cone.v_at(self._polar["root"]), cone.v_at(gear.base_angle)),
                    [((end, number), upright(math.pi + flank * self._half["root"]))],
                )
        space = number if flank == LEFT else self._wrapped(number - 1)
        on_root = (("root", space), upright(math.pi + flank * (half_pitch - self._half["root"])))
        on_tip = (("tip", number), upright(math.pi - flank * self._half["tip"]))
        traces: dict[str, list[_Trace]] = {
            "start": [(face, upright(gear.form_q))],
            "tip": [(face, upright(gear.tip_q)), on_tip],
        }
        if self._radial:
            traces["root"] = [on_root]
        else:
            traces["start"].append(on_root)
        for place, on in traces.items():
            polar = self._polar[place]
            self._add_edge(
                (number, flank, place),
                ray(polar, middle - flank * self._half[place]),
                ((number, flank, place, TOE), (number, flank, place, HEEL)),
                (self._cones[TOE].reach(polar), self._cones[HEEL].reach(polar)),
                on,
            )
        if not self._radial:
            self._edges[number, flank, "root"] = self._edges[number, flank, "start"]

    # faces

    def faces(self) -> Iterator[tuple[str, cq.Face]]:
        """Every face with its name, oriented outwards."""
        for number in range(self._gear.teeth):
            for flank in FLANKS:
                yield flank_name(number, flank), self._flank_face(number, flank)
                if self._radial:
                    yield f"tooth {number} {SIDES[flank]} radial", self._radial_face(number, flank)
            yield f"tooth {number} tip", self._tip_face(number)
            yield f"space {number} root", self._root_face(number)
            for end in ENDS:
                yield f"tooth {number} {end}", self._end_face(number, end)
        yield from self._blank_faces()

    def _face(self, surface: Geom_Surface, *edges: tuple[Key, bool], outwards: bool = True) -> cq.Face:
        """A face of a surface within edges in order (key, along it), turned over if its normal points inwards."""
        builder, wire = BRep_Builder(), TopoDS_Wire()
        builder.MakeWire(wire)
        for key, along in edges:
            edge = self._edges[key]
            builder.Add(wire, edge if along else edge.Reversed())
        wire.Closed(True)
        face = BRepBuilderAPI_MakeFace(surface, wire, True).Face()
        return cq.Face(face if outwards else face.Reversed())

    def _flank_face(self, number: int, flank: Flank) -> cq.Face:
        return self._face(
            self._surfaces["flank", number, flank],
            ((number, flank, "profile", TOE), True),
            ((number, flank, "tip"), True),
            ((number, flank, "profile", HEEL), False),
            ((number, flank, "start"), False),
            outwards=flank == RIGHT,
        )

    def _radial_face(self, number: int, flank: Flank) -> cq.Face:
        azimuth = self._middle(number) - flank * self._half["root"]
        plane = Geom_Plane(gp_Pnt(0.0, 0.0, 0.0), across(azimuth - flank * math.pi / 2))
        return self._face(
            plane,
            ((number, flank, "radial", TOE), True),
            ((number, flank, "start"), True),
            ((number, flank, "radial", HEEL), False),
            ((number, flank, "root"), False),
        )

    def _tip_face(self, number: int) -> cq.Face:
        return self._face(
            self._surfaces["tip", number],
            ((number, "tip", TOE), False),
            ((number, LEFT, "tip"), True),
            ((number, "tip", HEEL), True),
            ((number, RIGHT, "tip"), False),
        )

    def _root_face(self, space: int) -> cq.Face:
        after = self._wrapped(space + 1)
        return self._face(
            self._surfaces["root", space],
            ((space, LEFT, "root", TOE), False),
            ((after, RIGHT, "root", TOE), False),
            ((after, RIGHT, "root"), True),
            ((after, RIGHT, "root", HEEL), True),
            ((space, LEFT, "root", HEEL), True),
            ((space, LEFT, "root"), False),
        )

    def _end_face(self, number: int, end: End) -> cq.Face:
        before = self._wrapped(number - 1)
        radial = {flank: [((number, flank, "radial", end), flank == RIGHT)] if self._radial else [] for flank in FLANKS}
        return self._face(
            self._surfaces[end, number],
            ((before, "spoke", end), True),
            ((number, RIGHT, "root", end), False),
            *radial[RIGHT],
            ((number, RIGHT, "profile", end), True),
            ((number, "tip", end), False),
            ((number, LEFT, "profile", end), False),
            *radial[LEFT],
            ((number, LEFT, "root", end), False),
            ((number, "spoke", end), False),
            ((number, "rim", end), True),
            outwards=end == HEEL,
        )

    def _blank_faces(self) -> Iterator[tuple[str, cq.Face]]:
        """The flat faces and the bore between them; u falls as azimuths grow, so rims run clockwise from +z."""
        low, high = (self._cones[end].height(self._cones[end].rim) for end in ENDS)
        bore = self._gear.bore / 2
        mantle = None
        if bore > 0.0:
            circle = Geom_Circle(gp_Ax2(gp_Pnt(0.0, 0.0, low), gp_Dir(0.0, 0.0, 1.0)), bore)
            mantle = BRepPrimAPI_MakePrism(BRepBuilderAPI_MakeEdge(circle).Edge(), gp_Vec(0.0, 0.0, high - low))
            yield BORE, cq.Face(mantle.Shape())
        for name, end, up, height in ((FRONT_FACE, TOE, -1.0, low), (MOUNTING_FACE, HEEL, 1.0, high)):
            plane = Geom_Plane(gp_Pnt(0.0, 0.0, height), gp_Dir(0.0, 0.0, up))
            rims = [((number, "rim", end), end == TOE) for number in range(self._gear.teeth)]
            face = self._face(plane, *(rims if end == HEEL else reversed(rims)))
            if mantle is not None:
                hole = TopoDS_Wire()
                BRep_Builder().MakeWire(hole)
                edge = mantle.FirstShape() if end == TOE else mantle.LastShape()
                BRep_Builder().Add(hole, edge if end == TOE else edge.Reversed())
                face = cq.Face(BRepBuilderAPI_MakeFace(face.wrapped, hole).Face())
            yield name, face
