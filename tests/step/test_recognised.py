"""Splines that are planes, cylinders, cones, spheres or tori: by points alone, and in files that hold splines only."""

import math
from collections.abc import Callable
from pathlib import Path

import cadquery as cq
import numpy as np
import pytest
from foreign_parts import solid, step_file, turned
from OCP.BRepBuilderAPI import BRepBuilderAPI_NurbsConvert

from tol3d.cad.step.found_features import FoundFeature, by_place
from tol3d.cad.step.reading import read_step
from tol3d.cad.step.recognised import DEVIATION, Recognised, recognised

AXIS = np.array([2.0, -3.0, 6.0]) / 7.0
X = np.array([3.0, 2.0, 0.0]) / math.sqrt(13.0)
Y = np.cross(AXIS, X)
AT = np.array([31.0, -17.0, 5.5])
U, V = (own.ravel() for own in np.meshgrid(np.linspace(0.3, 2.9, 17), np.linspace(0.0, 1.0, 17)))


def round_about(radii: np.ndarray, heights: np.ndarray) -> np.ndarray:
    """Points at radii and heights about the axis, by U (n, 3)."""
    ring = np.outer(np.cos(U), X) + np.outer(np.sin(U), Y)
    return np.asarray(AT + radii[:, None] * ring + heights[:, None] * AXIS)


def normals_of(rise: np.ndarray) -> np.ndarray:
    """Normals that lean out of the plane across the axis by angles (n, 3)."""
    ring = np.outer(np.cos(U), X) + np.outer(np.sin(U), Y)
    return np.asarray(np.cos(rise)[:, None] * ring + np.sin(rise)[:, None] * AXIS)


def cylinder(noise: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    return round_about(12.5 + noise * np.sin(9 * U + 4 * V), 20.0 * V), normals_of(0.0 * V)


def cone() -> tuple[np.ndarray, np.ndarray]:
    """12 mm at the middle of 20 mm, widening by 0.2 mm a millimetre."""
    return round_about(10.0 + 4.0 * V, 20.0 * V), normals_of(0.0 * V - math.atan(0.2))


def torus() -> tuple[np.ndarray, np.ndarray]:
    rise = 0.4 + 1.5 * V
    return round_about(12.0 + 3.0 * np.cos(rise), 3.0 * np.sin(rise)), normals_of(rise)


def sphere() -> tuple[np.ndarray, np.ndarray]:
    rise = 0.1 + 0.9 * V
    return round_about(8.0 * np.cos(rise), 8.0 * np.sin(rise)), normals_of(rise)


def plane() -> tuple[np.ndarray, np.ndarray]:
    return AT + np.outer(40.0 * V, X) + np.outer(9.0 * U, Y), np.tile(AXIS, (len(U), 1))


def paraboloid() -> tuple[np.ndarray, np.ndarray]:
    """z = r²/40, with its normal's lean."""
    radii = 5.0 + 9.0 * V
    return round_about(radii, radii**2 / 40.0), normals_of(math.pi / 2 - np.arctan(-radii / 20.0))


@pytest.mark.parametrize("made", [plane, cylinder, cone, sphere, torus])
def test_points_of_a_surface_are_that_surface(made: Callable[[], tuple[np.ndarray, np.ndarray]]) -> None:
    found = recognised(*made())
    assert isinstance(found, Recognised)
    assert found.kind == made.__name__
    assert found.deviation < 1e-10
    across = np.cross(found.at - AT, AXIS)
    if found.kind == "plane":
        assert abs(found.axis @ AXIS) == pytest.approx(1.0, abs=1e-12)
        assert (found.at - AT) @ AXIS == pytest.approx(0.0, abs=1e-9)
        return
    assert np.linalg.norm(across) < 1e-8
    if found.kind != "sphere":
        assert abs(found.axis @ AXIS) == pytest.approx(1.0, abs=1e-12)
    height = float((found.at - AT) @ AXIS)
    sizes = {
        "cylinder": (12.5, 0.0, 0.0),
        "cone": (10.0 + 0.2 * height, math.atan(0.2), 0.0),
        "sphere": (8.0, 0.0, 0.0),
        "torus": (12.0, 0.0, 3.0),
    }[found.kind]
    assert (found.radius, found.half_angle, found.minor_radius) == pytest.approx(sizes, abs=1e-8)
    if found.kind in ("sphere", "torus"):
        assert height == pytest.approx(0.0, abs=1e-8)
    if found.kind == "cone":
        assert found.axis @ AXIS == pytest.approx(1.0, abs=1e-12)


def test_a_free_form_is_none_of_them() -> None:
    assert recognised(*paraboloid()) is None


@pytest.mark.parametrize(("noise", "taken"), [(0.6 * DEVIATION, True), (2.5 * DEVIATION, False)])
def test_a_spline_that_waves_is_a_cylinder_within_the_stated_deviation(noise: float, taken: bool) -> None:
    """The wave has no part that another radius, shift or lean takes away: its height is the deviation."""
    found = recognised(*cylinder(noise))
    assert (found is not None) is taken
    if found is not None:
        assert found.kind == "cylinder"
        assert found.deviation == pytest.approx(noise, rel=0.34)
        assert found.radius == pytest.approx(12.5, abs=noise)


def spun() -> cq.Shape:
    """A stepped shaft with a blind hole: cylinders, a cone, a torus in a corner, and a ball at its end."""
    outline = (
        cq.Workplane("XZ").moveTo(0, 0).lineTo(10, 0).lineTo(10, 12).threePointArc((8.585786438, 12.585786438), (8, 14))
        .lineTo(6, 22).lineTo(6, 30).threePointArc((6 / math.sqrt(2), 30 + 6 / math.sqrt(2)), (0, 36)).close()
    )  # fmt: skip
    return solid(outline.revolve(360, (0, 0, 0), (0, 1, 0)).faces("<Z").workplane().hole(5, 8))


def numbers(own: FoundFeature) -> tuple[float, ...]:
    return (own.radius, own.minor_radius, own.half_angle, own.turn)


def test_a_file_of_splines_alone_has_the_features_of_its_surfaces(tmp_path: Path) -> None:
    """Oracle: the same solid with its own surfaces; full turns are closed splines, on which Open CASCADE throws."""
    shape = turned(spun())
    splines = cq.Shape.cast(BRepBuilderAPI_NurbsConvert(shape.wrapped, True).Shape())
    content = step_file({"own": shape, "splines": splines}, tmp_path / "both.step")
    half = content.content.decode().count("B_SPLINE_SURFACE")
    own, others = (read_step(content).part(name) for name in ("own", "splines"))
    assert half >= len(others.features)
    for mine, other in zip(by_place(own.features), by_place(others.features), strict=True):
        assert other.kind == mine.kind
        curves = 1e-4 if mine.kind == "plane" else 1e-6  # mm; the circle about a plane is a sampled curve there
        assert (*other.at, other.length) == pytest.approx((*mine.at, mine.length), abs=curves)
        if mine.kind != "plane":
            assert numbers(other) == pytest.approx(numbers(mine), abs=1e-6)
    assert {feature.kind for feature in own.features} >= {"pin", "hole", "cone", "torus", "ball", "plane"}
    assert max(feature.deviation for feature in others.features) < 1e-6
