"""Faces of a CAD solid by their names or places, and the properties of each."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any, Final

import cadquery as cq
import numpy as np
from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeVertex
from OCP.BRepExtrema import BRepExtrema_DistShapeShape
from OCP.BRepTools import BRepTools
from OCP.gp import gp_Ax1, gp_Pnt
from scipy.optimize import minimize_scalar

from tol3d.cad.solids.pick import FaceKind, Pick, PickedFace, PickError, Triple
from tol3d.numerics.arrays import Array
from tol3d.parts.named_solid import NamedSolid
from tol3d.scene.nearest import nearest

KINDS: Final[dict[str, FaceKind]] = {"PLANE": "plane", "CYLINDER": "cylinder", "CONE": "cone", "SPHERE": "sphere"}
SAME_DISTANCE: Final = 1e-6
"""mm: faces whose distances from a point differ by less are as near as each other."""
MOST_SHOWN: Final = 6
MOST_LISTED: Final = 8
SAMPLES: Final = 181
"""Places on a curve that is neither line nor circle, between which its extremes are sought."""
REFINED: Final = 1e-9
"""Fraction of the length of such a curve to which its extremes are found; a point that far off is 1e-12 mm lower."""
ALONG: Final = 0.9
"""Cosine to the part's x beyond which a normal counts as along it; as in the frames of features by numbers."""


def pick_faces(solid: NamedSolid, picks: Sequence[Pick]) -> Iterator[PickedFace]:
    """The faces that picks mean, in their order.

    Raises:
        PickError: a pick means no face, or several.
    """
    for number, pick in enumerate(picks):
        name = _by_name(solid, pick, number) if pick.name else _by_place(solid, pick, number)
        yield _described(name, solid.faces[name], pick)


def _by_name(solid: NamedSolid, pick: Pick, number: int) -> str:
    if pick.name not in solid.faces:
        fitting = [name for name, face in solid.faces.items() if _fits(face, pick)] or [*solid.faces]
        words = f"expected a face of the solid, got {pick.name!r}, which it does not have"
        raise PickError(f"{words}{_known(pick.name, fitting, pick)}", number, "name")
    face = solid.faces[pick.name]
    if not _fits(face, pick):
        fitting = [name for name, own in solid.faces.items() if _fits(own, pick)]
        got = f"got {pick.name!r}, which is {_article(_word(face))}"
        raise PickError(
            f"expected a {' or '.join(pick.kinds)}, {got}{_known(pick.name, fitting, pick)}", number, "name"
        )
    return pick.name


def _known(name: str, fitting: Sequence[str], pick: Pick) -> str:
    """The nearest face that will do, and the first few of all."""
    listed = ", ".join(fitting[:MOST_LISTED]) + (", …" if len(fitting) > MOST_LISTED else "")
    kinds = " or ".join(pick.kinds)
    return f"{nearest(name, fitting)}; faces{f' of kind {kinds}' if kinds else ''}: {listed or 'none'}"


def _by_place(solid: NamedSolid, pick: Pick, number: int) -> str:
    """The nearest face of the kinds that will do.

    A point on an edge, or in the middle of a solid, may be as near to several.
    """
    fitting = {name: face for name, face in solid.faces.items() if _fits(face, pick)}
    if not fitting:
        there = sorted({_word(face) for face in solid.faces.values()})
        wanted = " or ".join(pick.kinds)
        raise PickError(f"expected a {wanted} of the solid, which has {', '.join(there)} only", number, "near")
    assert pick.near is not None
    distances = sorted((_nearest(face, pick.near)[0], name) for name, face in fitting.items())
    least = distances[0][0]
    tied = [name for distance, name in distances if distance < least + SAME_DISTANCE]
    if len(tied) > 1:
        shown = ", ".join(map(repr, tied[:MOST_SHOWN])) + (" …" if len(tied) > MOST_SHOWN else "")
        words = f"expected a point that one face is nearest to, got one that is {least:.6g} mm from each of {shown}"
        raise PickError(f"{words}; pick one by its name, or take a point that is nearer to it", number, "near")
    return str(tied[0])


def _fits(face: cq.Face, pick: Pick) -> bool:
    kind = KINDS.get(face.geomType())
    return kind is not None and (not pick.kinds or kind in pick.kinds)


def _word(face: cq.Face) -> str:
    return KINDS.get(face.geomType(), f"{face.geomType().lower()} face")


def _article(word: str) -> str:
    return f"{'an' if word[0] in 'aeiou' else 'a'} {word}"


def _nearest(face: cq.Face, point: Triple) -> tuple[float, Triple]:
    """Distance of a point from a face [mm], and the point of the face that is nearest."""
    vertex = BRepBuilderAPI_MakeVertex(gp_Pnt(*point)).Vertex()
    found = BRepExtrema_DistShapeShape(vertex, face.wrapped)
    return float(found.Value()), _triple(found.PointOnShape2(1))


# what a face is -------------------------------------------------------------------------------------


def _described(name: str, face: cq.Face, pick: Pick) -> PickedFace:
    kind = KINDS[face.geomType()]
    surface = BRepAdaptor_Surface(face.wrapped)
    nearest = _middle(face, surface) if pick.near is None else _nearest(face, pick.near)[1]
    normal = _normal(face, nearest)
    match kind:
        case "plane":
            return _flat(name, face, pick, nearest, normal)
        case "sphere":
            centre = _triple(surface.Sphere().Location())
            hole = _towards(normal, nearest, centre)
            radius = float(surface.Sphere().Radius())
            return PickedFace(
                name, kind, centre, (0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, 0.0), radius, hole, nearest, normal
            )
        case "cylinder":
            round_face = surface.Cylinder()
            return _turned(name, kind, face, round_face.Axis(), float(round_face.Radius()), nearest, normal)
        case "cone":
            cone = surface.Cone()
            found = _turned(name, kind, face, cone.Axis(), 0.0, nearest, normal)
            apex, tangent = np.array(_triple(cone.Apex())), abs(math.tan(float(cone.SemiAngle())))
            middle = (np.array(found.at) - apex) @ np.array(found.direction)
            start, end = (tangent * abs(float(middle) + half * found.extent[0]) for half in (-0.5, 0.5))
            return replace(found, radii=(start, end))


def _turned(
    name: str, kind: FaceKind, face: cq.Face, about: gp_Ax1, radius: float, nearest: Triple, normal: Triple
) -> PickedFace:
    """A cylinder or a cone, from the lowest to the highest of its edges along the axis."""
    origin, axis = np.array(_triple(about.Location())), np.array(_triple(about.Direction()))
    heights = [(np.array(place) - origin) @ axis for edge in face.Edges() for place in _places(edge, (axis,))]
    low, high = min(heights), max(heights)
    at = origin + (low + high) / 2 * axis
    if axis[int(np.argmax(np.abs(axis)))] < 0.0:
        axis = 0.0 - axis
    foot = origin + (np.array(nearest) - origin) @ axis * axis
    hole = _towards(normal, nearest, _floats(foot))
    length = float(high - low)
    return PickedFace(
        name, kind, _floats(at), _floats(axis), _floats(_x_of(axis, None)), (length, 0.0), radius, hole, nearest, normal
    )


def _flat(name: str, face: cq.Face, pick: Pick, nearest: Triple, normal: Triple) -> PickedFace:
    z = np.array(normal)
    x = _x_of(z, pick.along)
    y = np.cross(z, x)
    edges = face.outerWire().Edges()
    if len(edges) == 1 and edges[0].geomType() == "CIRCLE":
        centre, radius = _triple(edges[0].arcCenter()), float(edges[0].radius())
        sides = 2 * radius, 2 * radius
        return PickedFace(name, "plane", centre, normal, _floats(x), sides, radius, False, nearest, normal)
    outline = np.array([place for edge in edges for place in _places(edge, (x, y))])
    height = float(outline[0] @ z)
    low = np.array([(outline @ own).min() for own in (x, y)])
    high = np.array([(outline @ own).max() for own in (x, y)])
    middle = (low + high) / 2
    at = middle[0] * x + middle[1] * y + height * z
    sides = float(high[0] - low[0]), float(high[1] - low[1])
    return PickedFace(name, "plane", _floats(at), normal, _floats(x), sides, 0.0, False, nearest, normal)


def _places(edge: cq.Edge, directions: Sequence[Array]) -> Iterator[Triple]:
    """Points of an edge among which are its extremes along some directions."""
    yield _triple(edge.startPoint())
    yield _triple(edge.endPoint())
    kind = edge.geomType()
    if kind == "LINE":
        return
    if kind == "CIRCLE":
        centre, radius = np.array(_triple(edge.arcCenter())), float(edge.radius())
        for direction in directions:
            for sign in (-1.0, 1.0):
                place = _floats(centre + sign * radius * direction)
                if float(edge.distance(cq.Vertex.makeVertex(*place))) < SAME_DISTANCE:
                    yield place
        return
    places = np.linspace(0.0, 1.0, SAMPLES)
    points = np.array([_triple(place) for place in edge.positions(places.tolist())])
    for direction in directions:
        for sign in (-1.0, 1.0):
            best = int(np.argmax(sign * (points @ direction)))
            near = places[max(best - 1, 0)], places[min(best + 1, SAMPLES - 1)]

            def below(place: float, along: Array = sign * direction) -> float:
                return -float(np.array(_triple(edge.positionAt(place))) @ along)

            found = minimize_scalar(below, bounds=near, method="bounded", options={"xatol": REFINED})
            yield _triple(edge.positionAt(float(found.x)))


def _middle(face: cq.Face, surface: BRepAdaptor_Surface) -> Triple:
    """The point of the face's surface in the middle of its parameters."""
    first, last, low, high = BRepTools.UVBounds_s(face.wrapped)
    return _triple(surface.Value((first + last) / 2, (low + high) / 2))


def _normal(face: cq.Face, place: Triple) -> Triple:
    """Normal at a point of the face, out of the material."""
    return _floats(np.array(_triple(face.normalAt(cq.Vector(*place)))))


def _towards(normal: Triple, place: Triple, centre: Triple) -> bool:
    """True if a normal points to a centre: the material lies outside."""
    return bool(np.dot(normal, np.subtract(centre, place)) > 0.0)


def _x_of(z: Array, along: Triple | None) -> Array:
    """Across z, as near as may be to a direction; by default to the part's x, or its y."""
    wish = np.array(along) if along is not None else np.eye(3)[0] if abs(z[0]) < ALONG else np.eye(3)[1]
    across = wish - (wish @ z) * z
    return np.asarray(across / np.linalg.norm(across))


def _triple(point: Any) -> Triple:
    """Coordinates of OCC's and CadQuery's points and directions."""
    if isinstance(point, cq.Vector):
        return float(point.x), float(point.y), float(point.z)
    return float(point.X()), float(point.Y()), float(point.Z())


def _floats(vector: Array) -> Triple:
    """Vector without minus zeros."""
    x, y, z = (float(own) + 0.0 for own in vector)
    return x, y, z
