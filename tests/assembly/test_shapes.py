"""Facts that shapes tell of themselves: small motions by their components, edges of faces, and what lies over them."""

import numpy as np
import pytest

from tol3d.assembly.model import Axis, Cone, Plane, Point, RoundPlane, Shape, Slot
from tol3d.assembly.model.feature import Flat

CONE = Cone(7.0, diameters=(5.0, 8.0))
SEEN: dict[Shape, tuple[str, str]] = {
    Point(): ("xyz", ""),
    Plane((3.0, 8.0)): ("z", "xy"),
    Slot((3.0, 8.0), 2.0): ("z", "xy"),
    RoundPlane(2.5): ("z", "xy"),
    Axis(7.0, 3.0): ("xy", "xy"),
    CONE: ("xyz", "xy"),
}
"""Axes along which a shape shifts and about which it turns visibly."""
ROUND, SQUARE = RoundPlane(2.5), Plane((3.0, 8.0))


@pytest.mark.parametrize("shape", SEEN, ids=lambda own: type(own).__name__)
def test_shift_and_turn_follow_from_the_components_of_a_small_motion(shape: Shape) -> None:
    shift, turn = np.array([0.3, -0.2, 0.7]), np.array([0.02, 0.05, -0.04])
    components = shape.moved(lambda point: shift + np.cross(turn, point))
    for found, motion, seen in zip((shape.origin_by, shape.turn_by), (shift, turn), SEEN[shape], strict=True):
        expected = np.where([axis in seen for axis in "xyz"], motion, 0.0)
        assert found @ components == pytest.approx(expected, abs=1e-15)


@pytest.mark.parametrize("face", [ROUND, SQUARE])
def test_no_point_of_a_tilted_edge_rises_above_its_rim_and_one_nearly_does(face: Flat) -> None:
    rises = np.array([0.03, -0.07])  # at the ends of x and y
    heights = face.edge(np.linspace(0.0, 2.0 * np.pi, 3601))[:, :2] @ (rises / face.reach)
    rise = np.linalg.norm(face.rim @ rises, axis=1).max()
    assert rise * (1.0 - 1e-6) <= heights.max() <= rise * (1.0 + 1e-12)


@pytest.mark.parametrize(("face", "inside"), [(ROUND, (1.7, -1.8)), (SQUARE, (-1.4, 3.9))])
def test_a_point_is_over_a_face_up_to_its_edge(face: Flat, inside: tuple[float, float]) -> None:
    for factor, is_over in ((1.0, True), (1.1, False)):
        place = factor * np.array(inside)
        assert all(np.linalg.norm(place[k]) <= face.reach[k.start] for k in face.together) == is_over
