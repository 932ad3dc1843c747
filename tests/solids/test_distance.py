"""Distances by FCL against closed forms: of balls, of pins side by side, of a ball over a plate of triangles."""

import numpy as np
import pytest
from numpy.typing import NDArray

from tol3d.cad.solids.distance import Nearest, NearestPoints, Surface, cylinder, mesh_surface, put, sphere
from tol3d.numerics import frames

Array = NDArray[np.float64]

FOUND = 1e-6  # mm; what FCL's own iterations end at between bodies without triangles
AS_IS = np.eye(3)


def nearest(first: Surface, second: Surface) -> Nearest:
    return NearestPoints().of(first, second)


@pytest.mark.parametrize("seed", range(5))
def test_balls_are_as_far_apart_as_their_centres_less_their_radii(seed: int) -> None:
    rng = np.random.default_rng(seed)
    first, second = sphere(3.0), sphere(4.5)
    towards = rng.normal(size=3)
    towards /= np.linalg.norm(towards)
    put(first, AS_IS, np.array([1.0, 2.0, 3.0]))
    put(second, AS_IS, np.array([1.0, 2.0, 3.0]) + 12.0 * towards)
    found = nearest(first, second)
    assert found.distance == pytest.approx(12.0 - 7.5, abs=FOUND)
    assert found.points[0] == pytest.approx(np.array([1.0, 2.0, 3.0]) + 3.0 * towards, abs=1e-3)


@pytest.mark.parametrize("apart", [8.0, 8.001, 20.0])
def test_pins_side_by_side_are_as_far_apart_as_their_axes_less_their_radii(apart: float) -> None:
    first, second = cylinder(3.0, 10.0), cylinder(4.5, 10.0)
    put(second, AS_IS, np.array([apart, 0.0, 0.0]))
    assert nearest(first, second).distance == pytest.approx(apart - 7.5, abs=FOUND)


def test_a_ball_over_a_plate_is_as_far_from_it_as_it_lies_high_whatever_frame_both_are_seen_in() -> None:
    plate = np.array([[-50.0, -50.0, 0.0], [50.0, -50.0, 0.0], [50.0, 50.0, 0.0], [-50.0, 50.0, 0.0]])
    surface = mesh_surface(plate, np.array([[0, 1, 2], [0, 2, 3]]))
    ball = sphere(2.0)
    turn = frames.about_vector(np.array([0.3, -0.2, 0.7]))
    put(surface, turn, np.array([4.0, 5.0, 6.0]))
    put(ball, AS_IS, frames.apply(turn, np.array([10.0, -20.0, 2.25])) + np.array([4.0, 5.0, 6.0]))
    assert nearest(surface, ball).distance == pytest.approx(0.25, abs=FOUND)


def test_what_overlaps_is_at_distance_0() -> None:
    first, second = sphere(3.0), sphere(3.0)
    put(second, AS_IS, np.array([5.9, 0.0, 0.0]))
    assert nearest(first, second).distance <= 0.0
