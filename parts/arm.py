"""The solid of an arm: a hub on the shaft's axis, and round bars through its points with balls at the joints."""

from collections.abc import Iterator, Sequence
from typing import Final

import cadquery as cq
import numpy as np
from numpy.typing import NDArray
from OCP.BRepPrimAPI import BRepPrimAPI_MakeCylinder, BRepPrimAPI_MakeSphere
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt

from tol3d.errors import GeometryError
from tol3d.parts.named_boolean import fused
from tol3d.parts.named_solid import NamedSolid
from tol3d.parts.shaft import shaft

BALL_SHARE: Final = 1.2  # of the bars' diameter: a ball reaches over the ends of the bars that meet in it
HUB_SHARE: Final = 1.6  # of the bars' diameter
HUB_HEIGHT: Final = 1.3  # of the bars' diameter: the side of the hub, between its chamfers, takes a whole bar
SAME_PLACE: Final = 1e-3  # of the bars' diameter; a point nearer to the one before has no bar of its own

STRAIGHT: Final = 1e-6  # rad; bars that turn by less go straight on

Array = NDArray[np.float64]
Point = tuple[float, float, float]


def arm(points: Sequence[Point], diameter: float) -> NamedSolid:
    """Round bars from the z axis, at the height of the first point, through the points in their order [mm].

    Where it leaves the axis there is a hub about z, and at every point a ball. Faces, those that are left after
    the fusion: "hub side", "hub front" (+z), "hub back", their chamfers, "bar 1", "ball 1" and so on; a bar whose
    face falls into pieces has "bar 1", "bar 1 piece 2".

    Raises:
        GeometryError: no points, a diameter that is not above 0, or bars that make no valid solid.
    """
    if not (points and diameter > 0.0):
        raise GeometryError(f"an arm needs points and a diameter, got {len(points)} points and {diameter:g} mm")
    first, *others = _pieces(_places(points, diameter), diameter)
    return fused(first, others, "the arm")


def _places(points: Sequence[Point], diameter: float) -> list[Point]:
    """The hub's place on the axis and the points, without those where nothing goes on."""
    places = [(0.0, 0.0, points[0][2])]
    for point in points:
        if np.linalg.norm(np.subtract(point, places[-1])) > SAME_PLACE * diameter:
            places.append(point)
    return places


def _pieces(places: Sequence[Point], diameter: float) -> Iterator[NamedSolid]:
    height, half = places[0][2], HUB_HEIGHT * diameter / 2
    hub = shaft(HUB_SHARE * diameter, height - half, height + half)
    yield NamedSolid(hub.solid, {f"hub {name}": face for name, face in hub.faces.items()})
    spans = np.diff(places, axis=0)
    directions = spans / np.linalg.norm(spans, axis=1, keepdims=True)
    for number, (begin, end, span) in enumerate(zip(places[:-1], places[1:], spans, strict=True), start=1):
        along = gp_Ax2(gp_Pnt(*begin), gp_Dir(*span.tolist()))
        bar = cq.Solid(BRepPrimAPI_MakeCylinder(along, diameter / 2, float(np.linalg.norm(span))).Solid())
        yield NamedSolid(bar, {f"bar {number}": next(face for face in bar.Faces() if face.geomType() == "CYLINDER")})
        seam, pole = _out_of_the_way(-directions[number - 1], *directions[number : number + 1])
        turned = gp_Ax2(gp_Pnt(*end), gp_Dir(*pole.tolist()), gp_Dir(*seam.tolist()))
        ball = cq.Solid(BRepPrimAPI_MakeSphere(turned, BALL_SHARE * diameter / 2).Solid())
        yield NamedSolid(ball, {f"ball {number}": ball.Faces()[0]})


def _out_of_the_way(*bars: Array) -> tuple[Array, Array]:
    """Directions of the seam and the pole of a ball where no bar leaves it.

    A STEP file does not tell which side of its edges a sphere's face lies on: readers take the seam's.
    """
    middle = np.sum(bars, axis=0)
    if np.linalg.norm(middle) < STRAIGHT:
        middle = _across(bars[0])
    pole = np.cross(bars[0], middle)
    return -middle, pole if np.linalg.norm(pole) > STRAIGHT else _across(bars[0])


def _across(direction: Array) -> Array:
    """A vector square to a unit vector."""
    return np.cross(direction, np.eye(3)[np.argmin(np.abs(direction))])
