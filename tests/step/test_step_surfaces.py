"""Surfaces by the text: kinds, sides, units, and which faces are one."""

import math

import pytest

from tol3d.cad.step.feature import NamedFeature
from tol3d.cad.step.part21 import read_part21
from tol3d.cad.step.shape import kind_of, shape_of
from tol3d.cad.step.structure import Product, Solid, Structure
from tol3d.cad.step.surfaces import Surface, merged, surface_of
from tol3d.cad.step.units import Unit

INCH = Unit("in", "length", 25.4)
TEXT = """ISO-10303-21;HEADER;FILE_SCHEMA(('AP242'));ENDSEC;DATA;
#1=CARTESIAN_POINT('',(1.,2.,3.));
#2=DIRECTION('',(0.,0.,1.));
#3=DIRECTION('',(1.,0.,0.));
#4=AXIS2_PLACEMENT_3D('',#1,#2,#3);
#5=PLANE('',#4);
#6=CYLINDRICAL_SURFACE('',#4,0.5);
#7=TOROIDAL_SURFACE('',#4,2.,0.25);
#8=B_SPLINE_SURFACE_WITH_KNOTS('',1,1,(),.UNSPECIFIED.,.F.,.F.,.F.,(),(),(),(),.UNSPECIFIED.);
#11=ADVANCED_FACE('',(),#5,.T.);
#12=ADVANCED_FACE('',(),#5,.F.);
#13=ADVANCED_FACE('',(),#6,.F.);
#14=ADVANCED_FACE('',(),#7,.T.);
#15=ADVANCED_FACE('',(),#8,.T.);
ENDSEC;END-ISO-10303-21;"""


def test_numbers_are_converted_and_normals_point_out_of_the_material() -> None:
    file = read_part21(TEXT.encode())
    found = {face: surface_of(file, face, INCH) for face in (11, 12, 13, 14, 15)}
    assert found[11] == Surface("plane", (25.4, 50.8, pytest.approx(76.2)), (0.0, 0.0, 1.0))  # type: ignore[arg-type]
    assert found[12].direction == (0.0, 0.0, -1.0)
    assert (found[13].kind, found[13].radius, found[13].same_sense) == ("cylinder", 12.7, False)
    assert (found[14].kind, found[14].radius) == ("torus", 6.35)
    assert found[15].kind == "other"


def plane(z: float, up: bool = True) -> Surface:
    return Surface("plane", (7.0, -3.0, z), (0.0, 0.0, 1.0 if up else -1.0), same_sense=up)


def hole(x: float, radius: float = 2.0, along: float = 1.0, pin: bool = False) -> Surface:
    return Surface("cylinder", (x, 0.0, 40.0 * along), (0.0, 0.0, along), radius, pin)


TILT = math.radians(1e-3)


@pytest.mark.parametrize(
    ("first", "second", "one"),
    [
        (plane(0.0), Surface("plane", (-90.0, 5.0, 0.0), (0.0, 0.0, 1.0), same_sense=False), True),
        (plane(0.0), plane(0.01), False),
        (plane(0.0), plane(0.0, up=False), False),
        (plane(0.0), Surface("plane", (7.0, -3.0, 0.0), (0.0, math.sin(TILT), math.cos(TILT))), False),
        (hole(1.0), hole(1.0, along=-1.0), True),
        (hole(1.0), hole(1.01), False),
        (hole(1.0), hole(1.0, radius=2.01), False),
        (hole(1.0), hole(1.0, pin=True), False),
        (Surface("sphere", radius=1.0), Surface("sphere", direction=(1.0, 0.0, 0.0), radius=1.0), True),
        (Surface("cone", radius=1.0, slant=0.1), Surface("cone", radius=1.0, slant=0.1), True),
        (Surface("cone", radius=1.0, slant=0.1), Surface("cone", radius=1.0, slant=0.2), False),
        (Surface("torus", radius=1.0), Surface("cone", radius=1.0), False),
    ],
)
def test_faces_of_one_surface_are_merged(first: Surface, second: Surface, one: bool) -> None:
    assert len(merged([first, second])) == len(merged([second, first])) == (1 if one else 2)


@pytest.mark.parametrize(
    ("surfaces", "kind"),
    [
        ([], "nothing"),
        ([plane(0.0)], "plane"),
        ([plane(0.0), plane(5.0, up=False)], "slot"),
        ([plane(0.0), plane(5.0)], "planes"),
        ([plane(0.0), plane(5.0, up=False), plane(9.0)], "planes"),
        ([hole(0.0)], "cylinder"),
        ([hole(0.0), hole(9.0), hole(20.0)], "cylinders"),
        ([hole(0.0), hole(9.0, radius=3.0)], "round"),
        ([hole(0.0), plane(0.0)], "mixed"),
        ([Surface("sphere", radius=1.0)], "sphere"),
        ([Surface("cone", radius=1.0)], "cone"),
        ([Surface("cone", radius=1.0), Surface("cone", (9.0, 0.0, 0.0), radius=1.0)], "cones"),
        ([Surface("torus", radius=1.0)], "round"),
    ],
)
def test_surfaces_make_a_shape(surfaces: list[Surface], kind: str) -> None:
    assert kind_of(surfaces) == kind


def test_loose_faces_are_left_out_of_a_shape_that_has_others() -> None:
    solid = Solid(3, "", "MANIFOLD_SOLID_BREP", (11,))
    structure = Structure("x", {1: Product(1, "part", 2, (solid,), (12,))}, ())
    surfaces = {11: plane(0.0), 12: plane(1.0)}
    both = shape_of(NamedFeature(5, "", 2, ((11,), (12,))), surfaces, structure)
    assert (both.kind, both.loose) == ("plane", True)
    alone = shape_of(NamedFeature(5, "", 2, ((12,),)), surfaces, structure)
    assert (alone.kind, alone.loose) == ("plane", False)
