"""Nearest pairs of parts, for the analytic method, and their least distance."""

import numpy as np
import pytest
from assembly.clearances.meshed import ball, block, tube
from numpy.typing import NDArray

from tol3d.assembly.clearances.faces import SolidMesh
from tol3d.assembly.clearances.nearest import Displaced, facing, nominal_distance
from tol3d.assembly.model.measures import Facing

Array = NDArray[np.float64]

CHORD = 1e-3
UP, DOWN = 1.0, -1.0


def faced(start: SolidMesh, end: SolidMesh, at: tuple[float, float, float], sizes: tuple[float, float]) -> Facing:
    """Pairs of a part at the origin and one that shifts and turns about its middle by normals of these sigmas."""
    rng = np.random.default_rng(1)
    pose = np.eye(4)
    pose[:3, 3] = at
    shifts, turns = sizes[0] * rng.normal(size=(300, 3)), sizes[1] * rng.normal(size=(300, 3))
    torsors = np.hstack([shifts + np.cross(pose[:3, 3], turns), turns])
    displaced = Displaced(np.eye(4), pose, np.zeros((300, 6)), torsors)
    return facing((start, end), displaced, nominal_distance((start, end), pose), CHORD)


def least(found: Facing, shifts: Array) -> Array:
    """The least distance where the second part is shifted (n, 3), to first order."""
    return np.asarray((found.lengths + shifts @ found.normals.T).min(axis=1))


def test_two_plates_have_the_corners_of_the_smaller_one_over_the_other() -> None:
    found = faced(block((100.0, 60.0, 10.0)), block((40.0, 20.0, 5.0)), (5.0, 3.0, 8.0), (0.05, 1e-3))
    over_corners = {(x, y) for x in (-15.0, 25.0) for y in (-7.0, 13.0)}
    assert {(round(x, 6), round(y, 6)) for x, y, _ in found.starts[1:]} == over_corners
    assert found.starts[:, 2] == pytest.approx(np.full(5, 5.0), abs=1e-12)
    assert found.lengths == pytest.approx(np.full(5, 0.5), abs=1e-12)
    assert found.normals == pytest.approx(np.tile([0.0, 0.0, UP], (5, 1)), abs=1e-12)


def test_edges_that_cross_have_one_pair() -> None:
    """Blocks on their edges, one along x below and one along y above it."""
    lower, upper = block((80.0, 10.0, 10.0)), block((10.0, 80.0, 10.0))
    edge = np.sqrt(0.5)
    about_x = np.array([[1.0, 0.0, 0.0], [0.0, edge, -edge], [0.0, edge, edge]])
    about_y = np.array([[edge, 0.0, edge], [0.0, 1.0, 0.0], [-edge, 0.0, edge]])
    lower = SolidMesh(lower.vertices @ about_x.T, lower.triangles, 0.0)
    upper = SolidMesh(upper.vertices @ about_y.T, upper.triangles, 0.0)
    apart = 0.3
    found = faced(lower, upper, (2.0, 3.0, 2 * 10 * edge + apart), (0.01, 1e-5))
    assert found.starts[0] == pytest.approx([2.0, 0.0, 10 * edge], abs=1e-9)
    assert found.ends[0] == pytest.approx([0.0, -3.0, -10 * edge], abs=1e-9)
    assert found.normals[0] == pytest.approx([0.0, 0.0, UP], abs=1e-9)
    assert len(found.lengths) == 1


@pytest.mark.parametrize("steps", [120, pytest.param(180, marks=pytest.mark.slow)])  # finer: neighbours come as near
def test_a_ball_over_a_plate_has_one_pair(steps: int) -> None:
    found = faced(block((60.0, 60.0, 10.0)), ball(6.0, steps), (1.0, 2.0, 11.5), (0.05, 1e-3))
    assert len(found.lengths) == 1
    assert found.lengths == pytest.approx([0.5], abs=1e-9)
    assert found.normals[0] == pytest.approx([0.0, 0.0, UP], abs=1e-6)
    assert found.starts[0] == pytest.approx([1.0, 2.0, 5.0], abs=1e-6)


def test_a_pin_in_a_hole_has_pairs_all_around() -> None:
    """Least over n directions: c - |o| cos of half a step at most, and the polygons' own chord error."""
    hole, pin = tube(9.0, 5.0, 10.0, 720), tube(4.8, 0.0, 30.0, 720)
    found = faced(hole, pin, (0.0, 0.0, 0.0), (0.04, 1e-5))
    assert found.normals[:, 2] == pytest.approx(np.zeros(len(found.lengths)), abs=5e-5)  # as far as motions turn it
    rng = np.random.default_rng(9)
    shifts = np.column_stack([rng.normal(size=(200, 2)) * 0.04, np.zeros(200)])
    by_hand = 0.2 - np.hypot(shifts[:, 0], shifts[:, 1])
    chords = hole.chord_error + pin.chord_error
    off = least(found, shifts) - by_hand
    assert off.min() > -chords - 1e-9
    assert off.max() < chords + 2 * 0.1 * CHORD  # a pair is kept where it is nearer by a tenth of the chord error


def test_a_second_place_is_found_that_is_nearest_in_some_trials_only() -> None:
    """A block over a step: 0.5 mm above the lower, 0.6 mm beside the higher; shifts of some 0.1 mm."""
    lower = block((100.0, 60.0, 10.0))
    post = block((10.0, 60.0, 30.0))
    both = SolidMesh(
        np.concatenate([lower.vertices, post.vertices + np.array([40.0, 0.0, 20.5])]),
        np.concatenate([lower.triangles, post.triangles + len(lower.vertices)]),
        0.0,
    )
    found = faced(both, block((20.0, 20.0, 10.0)), (24.4, 0.0, 10.5), (0.1, 1e-5))
    directions = {tuple(np.round(own, 3) + 0.0) for own in found.normals}
    assert directions == {(0.0, 0.0, UP), (DOWN, 0.0, 0.0)}
    shifts = np.array([[0.0, 0.0, 0.0], [0.3, 0.0, 0.0], [0.0, 0.0, -0.2]])
    assert least(found, shifts) == pytest.approx([0.5, 0.3, 0.3], abs=1e-6)  # of edges that turn by 1e-5
