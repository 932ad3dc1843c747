"""Ears on the outside of what is swept along z: straight sides, a round end, and a seat for a ball in them."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import cadquery as cq
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeVertex
from OCP.GC import GC_MakeArcOfCircle
from OCP.gp import gp_Pnt

from tol3d.errors import GeometryError
from tol3d.parts.details import LEAST_WALL, DetailError
from tol3d.parts.named_boolean import cut
from tol3d.parts.named_solid import BACK, FRONT, NamedEdge, NamedSolid, extruded
from tol3d.parts.round_hole import RoundHole
from tol3d.parts.turned import AXIS, section, turned

Place = tuple[float, float]


@dataclass(frozen=True)
class Ear:
    """An ear: its sides are the faces "NAME left" and "NAME right", seen from the axis with +z up, its end "NAME end".

    Args:
        name: of it.
        angle: of its middle, from +x towards +y [rad].
    """

    name: str
    angle: float


@dataclass(frozen=True)
class Eared:
    """A disc with a bore and ears, all alike, swept along z from z = 0 [mm].

    Args:
        diameter: of the disc.
        bore: of its hole.
        thickness: along z.
        reach: from the axis to the centres of the seats.
        ear_width: between the sides of an ear, and twice the radius of its end.
        ball_diameter: of the seats.
    """

    diameter: float
    bore: float
    thickness: float
    reach: float
    ear_width: float
    ball_diameter: float

    def refuse(self, words: str) -> None:
        """Raise unless there is a wall everywhere."""
        ball, half, outside = self.ball_diameter / 2, self.ear_width / 2, self.diameter / 2
        if not all(LEAST_WALL <= size < math.inf for size in (self.bore, self.thickness, self.ball_diameter)):
            raise GeometryError(
                f"{words} with a bore of {self.bore:g} mm, {self.thickness:g} mm along z, with balls of "
                f"{self.ball_diameter:g} mm, has no volume"
            )
        if not self.bore / 2 + LEAST_WALL <= outside < math.inf:
            raise GeometryError(f"{words} of {self.diameter:g} mm leaves no wall round its bore of {self.bore:g} mm")
        if not ball + LEAST_WALL <= half <= outside - LEAST_WALL:
            raise GeometryError(
                f"ears {self.ear_width:g} mm wide leave no wall round balls of {self.ball_diameter:g} mm, or are wider "
                f"than {words} of {self.diameter:g} mm"
            )
        if not ball + LEAST_WALL <= self.thickness:
            raise GeometryError(
                f"{words}, {self.thickness:g} mm along z, has no floor below seats of {self.ball_diameter:g} mm"
            )
        if not self.root + LEAST_WALL <= self.reach < math.inf:
            raise GeometryError(
                f"ears with seats {self.reach:g} mm from the axis do not leave {words}: their sides begin at "
                f"{self.root:g} mm"
            )
        if not self.bore / 2 + ball + LEAST_WALL <= self.reach:
            raise GeometryError(f"seats {self.reach:g} mm from the axis break into the bore of {self.bore:g} mm")

    @property
    def root(self) -> float:
        """Start of the sides of an ear, along its middle [mm]."""
        return math.sqrt(max(0.0, (self.diameter / 2) ** 2 - (self.ear_width / 2) ** 2))

    def swept(self, ears: Sequence[Ear], rims: Sequence[str], words: str) -> NamedSolid:
        """The disc with its ears and without seats.

        Args:
            ears: counter-clockwise.
            rims: names of what is round between an ear and the next one.
            words: what is made, for messages.
        """
        self._refuse_near(ears, words)
        corners = [self._corners(ear) for ear in ears]
        vertices = [[BRepBuilderAPI_MakeVertex(self._point(*at)).Vertex() for at in own] for own in corners]
        edges = []
        for k, ear in enumerate(ears):
            ahead = (k + 1) % len(ears)
            right, outer, inner, left = vertices[k]
            end = (
                (self.reach + self.ear_width / 2) * math.cos(ear.angle),
                (self.reach + self.ear_width / 2) * math.sin(ear.angle),
            )
            after = ears[ahead].angle + (2 * math.pi if ahead <= k else 0.0)
            rim = _polar(self.diameter / 2, (ear.angle + after) / 2)
            edges += [
                NamedEdge(f"{ear.name} right", cq.Edge(BRepBuilderAPI_MakeEdge(right, outer).Edge())),
                NamedEdge(f"{ear.name} end", self._arc(corners[k][1], end, corners[k][2], outer, inner)),
                NamedEdge(f"{ear.name} left", cq.Edge(BRepBuilderAPI_MakeEdge(inner, left).Edge())),
                NamedEdge(rims[k], self._arc(corners[k][3], rim, corners[ahead][0], left, vertices[ahead][0])),
            ]
        bore = RoundHole("bore", (0.0, 0.0), self.bore).edge(-self.thickness / 2)
        flat = extruded(edges, [[bore]], self.thickness).moved(cq.Location(cq.Vector(0.0, 0.0, self.thickness / 2)))
        names = {FRONT: "top", BACK: "bottom"}
        return NamedSolid(flat.solid, {names.get(name, name): face for name, face in flat.faces.items()})

    def seated(self, base: NamedSolid, seats: Sequence[Ear], level: float, words: str) -> NamedSolid:
        """The same with hemispherical seats, each called as its ear, about centres at z = level [mm]."""
        ball = self.ball_diameter / 2
        tools = []
        for ear in seats:
            edges = section([(ear.name, 0.0, -ball), (AXIS, 0.0, ball)], {ear.name: (ball, 0.0)})
            place = cq.Vector(*_polar(self.reach, ear.angle), level)
            tools.append(turned(edges, "a ball").moved(cq.Location(place)))
        return cut(base, tools, words)

    def _refuse_near(self, ears: Sequence[Ear], words: str) -> None:
        half = math.asin(self.ear_width / self.diameter)
        rounded = [*ears, Ear(ears[0].name, ears[0].angle + 2 * math.pi)]
        for ear, near in pairwise(rounded):
            if near.angle - ear.angle - 2 * half < LEAST_WALL / self.diameter:
                raise DetailError(
                    f"ears {ear.name!r} and {near.name!r} of {words} overlap or meet: they are "
                    f"{math.degrees(near.angle - ear.angle):g} deg apart, and {math.degrees(2 * half):g} deg wide",
                    near.name,
                )

    def _corners(self, ear: Ear) -> tuple[Place, Place, Place, Place]:
        """Right side from the disc to the end, left side back."""
        half, cos, sin = self.ear_width / 2, math.cos(ear.angle), math.sin(ear.angle)
        places = (self.root, -half), (self.reach, -half), (self.reach, half), (self.root, half)
        first, second, third, fourth = ((x * cos - y * sin, x * sin + y * cos) for x, y in places)
        return first, second, third, fourth

    def _point(self, x: float, y: float) -> gp_Pnt:
        return gp_Pnt(x, y, -self.thickness / 2)

    def _arc(self, begin: Place, through: Place, end: Place, *vertices: object) -> cq.Edge:
        circle = GC_MakeArcOfCircle(self._point(*begin), self._point(*through), self._point(*end)).Value()
        return cq.Edge(BRepBuilderAPI_MakeEdge(circle, *vertices).Edge())


def _polar(radius: float, angle: float) -> Place:
    return radius * math.cos(angle), radius * math.sin(angle)
