"""Faces picked from CAD solids: frames, extents and sizes against the numbers that the solids were made of."""

import math

import cadquery as cq
import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from tol3d.cad.solids.named_faces import pick_faces
from tol3d.cad.solids.pick import Pick, PickedFace, PickError
from tol3d.parts.named_solid import NamedSolid, numbered

Array = NDArray[np.float64]

CLOSE = 1e-9  # mm
X, Y, Z = np.eye(3)


def workpiece(length: float, width: float, height: float, bore: float, pin: float) -> cq.Solid:
    """A block about the origin's z axis with a blind bore of half its height in its top, a pin and a ball."""
    block = cq.Workplane().box(length, width, height)
    hole = cq.Solid.makeCylinder(bore / 2, height / 2, cq.Vector(length / 4, 0, 0), cq.Vector(0, 0, 1))
    stud = cq.Solid.makeCylinder(pin / 2, height, cq.Vector(-length / 4, 0, height / 2), cq.Vector(0, 0, 1))
    ball = cq.Solid.makeSphere(pin, cq.Vector(0, 0, -height / 2), angleDegrees1=-90, angleDegrees2=90)
    (solid,) = block.cut(cq.Workplane(hole)).union(cq.Workplane(stud)).union(cq.Workplane(ball)).solids().vals()
    assert isinstance(solid, cq.Solid)
    return solid


def pose(rng: np.random.Generator) -> tuple[Array, Array]:
    """A random rotation (3, 3) and translation (3,) [mm]."""
    return np.asarray(Rotation.random(random_state=rng).as_matrix()), rng.uniform(-200.0, 200.0, 3)


def moved(solid: cq.Solid, rotation: Array, translation: Array) -> NamedSolid:
    plane = cq.Plane(triple(translation), triple(rotation[:, 0]), triple(rotation[:, 2]))
    return numbered(solid.moved(cq.Location(plane)))


def triple(vector: Array) -> tuple[float, float, float]:
    x, y, z = vector.tolist()
    return x, y, z


def one(solid: NamedSolid, pick: Pick) -> PickedFace:
    (face,) = pick_faces(solid, [pick])
    return face


@pytest.mark.parametrize("seed", range(8))
def test_faces_are_where_the_solid_was_made_and_moved_to(seed: int) -> None:
    rng = np.random.default_rng(seed)
    length, width, height = rng.uniform([80, 40, 20], [160, 80, 40])
    bore, pin = rng.uniform(4.0, 12.0, 2)
    turned, shifted = pose(rng)
    solid = moved(workpiece(length, width, height, bore, pin), turned, shifted)

    def near(*place: float) -> tuple[float, float, float]:
        return triple(turned @ np.array(place) + shifted)

    along = triple(turned @ X)
    top = one(solid, Pick(near=near(0.1, 0.2, height / 2 + 1.0), kinds=("plane",), along=along))
    assert top.at == pytest.approx(near(0, 0, height / 2), abs=CLOSE)
    assert top.direction == pytest.approx(turned @ Z, abs=1e-12)
    assert top.extent == pytest.approx((length, width), abs=CLOSE)
    assert top.radius == 0.0
    slanted = triple(turned @ (X + Y) / math.sqrt(2))
    diagonal = one(solid, Pick(near=near(0.1, 0.2, height / 2 + 1.0), kinds=("plane",), along=slanted))
    assert diagonal.extent == pytest.approx(((length + width) / math.sqrt(2),) * 2, abs=CLOSE)
    assert diagonal.at == pytest.approx(top.at, abs=CLOSE)

    side = one(solid, Pick(near=near(length / 2 + 1.0, 0.0, 0.1), kinds=("plane",), along=triple(turned @ Y)))
    assert side.direction == pytest.approx(turned @ X, abs=1e-12)
    assert side.extent == pytest.approx((width, height), abs=CLOSE)

    hole = one(solid, Pick(near=near(length / 4, 0.0, height / 4), kinds=("cylinder",)))
    assert hole.at == pytest.approx(near(length / 4, 0, height / 4), abs=CLOSE)
    assert abs(np.dot(hole.direction, turned @ Z)) == pytest.approx(1.0, abs=1e-12)
    assert max(hole.direction, key=abs) > 0.0
    assert (hole.extent[0], 2 * hole.radius, hole.hole) == pytest.approx((height / 2, bore, True), abs=CLOSE)

    stud = one(solid, Pick(near=near(-length / 4, 0.0, 2 * height), kinds=("cylinder",)))
    assert stud.at == pytest.approx(near(-length / 4, 0, height), abs=CLOSE)
    assert (stud.extent[0], 2 * stud.radius, stud.hole) == pytest.approx((height, pin, False), abs=CLOSE)
    end = one(solid, Pick(near=near(-length / 4, 0.1, 2 * height), kinds=("plane",)))
    assert (end.radius, *end.at) == pytest.approx((pin / 2, *near(-length / 4, 0, 1.5 * height)), abs=CLOSE)

    ball = one(solid, Pick(near=near(0, 0, -height), kinds=("sphere",)))
    assert (*ball.at, ball.radius, ball.hole) == pytest.approx((*near(0, 0, -height / 2), pin, False), abs=CLOSE)
    assert ball.normal == pytest.approx(turned @ -Z, abs=1e-9)
    assert ball.nearest == pytest.approx(near(0, 0, -height / 2 - pin), abs=1e-7)


def test_a_cone_has_its_axis_and_length() -> None:
    cone = numbered(cq.Solid.makeCone(10.0, 4.0, 12.0, cq.Vector(1, 2, 3), cq.Vector(0, 1, 0)))
    face = one(cone, Pick(near=(1.0, 5.0, 30.0), kinds=("cylinder", "cone")))
    assert face.kind == "cone"
    assert (*face.at, *face.direction) == pytest.approx((1, 8, 3, 0, 1, 0), abs=CLOSE)
    assert (face.extent[0], face.hole, *face.radii) == pytest.approx((12.0, False, 10.0, 4.0), abs=CLOSE)


def test_rounded_and_notched_outlines_have_the_rectangle_around_them() -> None:
    plate = cq.Workplane().box(100, 60, 10).edges("|Z").fillet(15).faces(">X").workplane().rect(20, 20).cutBlind(-5)
    (solid,) = plate.solids().vals()
    assert isinstance(solid, cq.Solid)
    top = one(numbered(solid), Pick(near=(0, 0, 6.0), kinds=("plane",)))
    assert (*top.extent, *top.at) == pytest.approx((100, 60, 0, 0, 5), abs=CLOSE)
    slanted = one(numbered(solid), Pick(near=(0, 0, 6.0), kinds=("plane",), along=(1.0, 1.0, 0.0)))
    # corners of radius 15 about (35, 15): the furthest point along the diagonal lies on the arc
    reach = 2 * ((35 + 15) / math.sqrt(2) + 15)
    assert slanted.extent == pytest.approx((reach, reach), abs=CLOSE)


@pytest.mark.parametrize("degrees", [7.0, 20.0, 41.0])
def test_a_cylinder_that_is_cut_askew_reaches_from_end_to_end(degrees: float) -> None:
    slope = math.tan(math.radians(degrees))
    pin = cq.Workplane().circle(6.0).extrude(40.0)
    above = cq.Workplane().box(60, 60, 40).translate((0, 0, 20)).rotate((0, 0, 0), (0, 1, 0), -degrees)
    (solid,) = pin.cut(above.translate((0, 0, 15.0))).solids().vals()
    assert isinstance(solid, cq.Solid)
    face = one(numbered(solid), Pick(near=(6.0, 0, 5.0), kinds=("cylinder",)))
    length = 15.0 + 6.0 * slope
    assert (face.extent[0], *face.at) == pytest.approx((length, 0, 0, length / 2), abs=1e-8)


@pytest.mark.parametrize("turned", [0.0, 30.0, 77.0])
def test_an_ellipse_has_the_rectangle_around_it(turned: float) -> None:
    (solid,) = cq.Workplane().ellipse(50.0, 25.0).extrude(5.0).rotate((0, 0, 0), (0, 0, 1), turned).solids().vals()
    assert isinstance(solid, cq.Solid)
    top = one(numbered(solid), Pick(near=(0, 0, 6.0), kinds=("plane",)))
    cos, sin = math.cos(math.radians(turned)), math.sin(math.radians(turned))
    sides = 2 * math.hypot(50 * cos, 25 * sin), 2 * math.hypot(50 * sin, 25 * cos)
    assert (*top.extent, *top.at) == pytest.approx((*sides, 0, 0, 5), abs=1e-8)


def test_ties_and_what_is_not_there_are_refused_with_what_is() -> None:
    solid = numbered(workpiece(100.0, 60.0, 20.0, 8.0, 8.0))
    with pytest.raises(
        PickError, match=r"expected a point that one face is nearest to.*'face \d+', 'face \d+'"
    ) as tied:
        one(solid, Pick(near=(50.0, 0.0, 10.0)))
    assert (tied.value.number, tied.value.by) == (0, "near")
    with pytest.raises(PickError, match="expected a cone of the solid, which has cylinder, plane, sphere only"):
        one(solid, Pick(near=(0, 0, 0), kinds=("cone",)))
    with pytest.raises(PickError, match=r"expected a face of the solid, got 'face 99'.*did you mean") as missing:
        list(pick_faces(solid, [Pick(name="face 1"), Pick(name="face 99")]))
    assert (missing.value.number, missing.value.by) == (1, "name")
    known = [name for name, face in solid.faces.items() if face.geomType() == "CYLINDER"][:8]
    with pytest.raises(PickError, match=rf"; faces of kind cylinder: {', '.join(known)}"):
        one(solid, Pick(name="face 99", kinds=("cylinder",)))
    flat = next(name for name, face in solid.faces.items() if face.geomType() == "PLANE")
    with pytest.raises(PickError, match=f"expected a cylinder, got {flat!r}, which is a plane"):
        one(solid, Pick(name=flat, kinds=("cylinder",)))
