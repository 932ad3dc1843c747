"""Distances of meshed solids against closed forms and a convex programme, poses at random."""

import numpy as np
import pytest
from assembly.clearances.meshed import ball, block, tube
from numpy.typing import NDArray
from scipy.optimize import nnls
from scipy.spatial.transform import Rotation

from tol3d.assembly.clearances.distances import PairDistances, turns_about
from tol3d.assembly.clearances.faces import SolidMesh
from tol3d.assembly.clearances.pair import SolidPair, solid_pair
from tol3d.assembly.model.statuses import OK, OVERLAP

Array = NDArray[np.float64]

FOUND = 1e-9  # mm; rounding of distances of triangles some 100 mm large


def posed(turns: Array, places: Array) -> Array:
    poses = np.tile(np.eye(4), (len(places), 1, 1))
    poses[:, :3, :3] = Rotation.from_rotvec(turns).as_matrix()
    poses[:, :3, 3] = places
    return poses


def whole(start: SolidMesh, end: SolidMesh) -> SolidPair:
    """A pair of which every triangle is asked, wherever it stands."""
    return SolidPair(start, end, np.eye(4), 0.0)


def read(pair: SolidPair, poses: Array) -> Array:
    values, codes = PairDistances(pair).of(poses)
    assert (codes == OK).all()
    return values


@pytest.mark.parametrize("steps", [8, 16, 32])
def test_balls_are_apart_by_their_centres_less_their_radii_within_the_chord_errors(steps: int) -> None:
    rng = np.random.default_rng(steps)
    pair = whole(ball(3.0, steps), ball(4.0, steps))
    places = rng.normal(size=(40, 3))
    places *= rng.uniform(7.2, 9.0, (40, 1)) / np.linalg.norm(places, axis=1, keepdims=True)
    off = read(pair, posed(rng.normal(size=(40, 3)), places)) - (np.linalg.norm(places, axis=1) - 7.0)
    assert off.min() > -FOUND  # both meshes lie inside
    assert off.max() < pair.chord_error


def test_the_error_of_a_reading_goes_with_the_square_of_the_step() -> None:
    rng = np.random.default_rng(3)
    turns, places = rng.normal(size=(200, 3)), rng.normal(size=(200, 3))
    places *= 8.0 / np.linalg.norm(places, axis=1, keepdims=True)
    largest = [float(read(whole(ball(3.0, n), ball(4.0, n)), posed(turns, places)).max()) - 1.0 for n in (12, 24)]
    assert largest[0] / largest[1] == pytest.approx(4.0, rel=0.25)  # the largest of 200 of each


def test_a_pin_in_a_hole_is_as_far_from_its_wall_as_the_clearance_less_its_offset() -> None:
    rng = np.random.default_rng(5)
    pair = whole(tube(9.0, 5.0, 10.0, 180), tube(4.8, 0.0, 30.0, 180))
    aside = rng.normal(size=(60, 2))
    aside *= rng.uniform(0.0, 0.15, (60, 1)) / np.linalg.norm(aside, axis=1, keepdims=True)
    spun = np.outer(rng.uniform(0, 2 * np.pi, 60), [0.0, 0.0, 1.0])
    values = read(pair, posed(spun, np.column_stack([aside, rng.uniform(-5, 5, 60)])))
    assert values == pytest.approx(0.2 - np.linalg.norm(aside, axis=1), abs=pair.chord_error)
    leaning = posed(np.array([[0.02, 0.0, 0.0]]), np.zeros((1, 3)))
    # its line x = 0, y = -z tan 0.02 passes the rims at z = +-5; the hole cuts it off square to its own axis
    by_hand = 5.0 - 5.0 * np.tan(0.02) - 4.8 / np.cos(0.02)
    assert read(pair, leaning) == pytest.approx(by_hand * np.cos(0.02), abs=2 * pair.chord_error)


def test_a_tilted_plate_is_nearest_where_its_lowest_corner_is() -> None:
    rng = np.random.default_rng(6)
    pair = whole(block((100.0, 80.0, 10.0)), block((60.0, 40.0, 4.0)))
    turns, places = rng.uniform(-0.02, 0.02, (80, 3)), rng.uniform(-1, 1, (80, 3)) + np.array([0, 0, 10.0])
    poses = posed(turns, places)
    corners = block((60.0, 40.0, 4.0)).vertices
    heights = np.einsum("ni,ci->nc", poses[:, 2, :3], corners) + poses[:, 2, 3, None]
    assert read(pair, poses) == pytest.approx(heights.min(axis=1) - 5.0, abs=FOUND)


def convex_distance(first: Array, second: Array) -> float:
    """Distance of the convex hulls of points, as the least |A x - B y|, x and y weights of sum 1."""
    heavy = 1e4
    sums = np.zeros((2, len(first) + len(second)))
    sums[0, : len(first)] = sums[1, len(first) :] = heavy
    weights, _ = nnls(np.vstack([np.hstack([first.T, -second.T]), sums]), [0.0, 0.0, 0.0, heavy, heavy], maxiter=1000)
    one, other = weights[: len(first)], weights[len(first) :]
    return float(np.linalg.norm(first.T @ one / one.sum() - second.T @ other / other.sum()))


def test_blocks_anywhere_are_apart_as_a_convex_programme_says() -> None:
    rng = np.random.default_rng(7)
    start, end = block((6.0, 4.0, 2.0)), block((5.0, 3.0, 1.0))
    places = rng.normal(size=(100, 3))
    places *= rng.uniform(8, 12, (100, 1)) / np.linalg.norm(places, axis=1, keepdims=True)
    poses = posed(rng.normal(size=(100, 3)), places)
    by_programme = [convex_distance(start.vertices, end.vertices @ own[:3, :3].T + own[:3, 3]) for own in poses]
    assert read(whole(start, end), poses) == pytest.approx(np.array(by_programme), abs=1e-6)  # its weights' sums


@pytest.mark.parametrize(
    ("start", "end", "nominal"),
    [
        (block((100.0, 80.0, 10.0)), tube(20.0, 12.0, 8.0, 60), (3.0, 5.0, 9.3)),
        (tube(9.0, 5.0, 10.0, 60), tube(4.6, 0.0, 30.0, 60), (0.1, 0.05, 0.0)),
        (ball(6.0, 20), block((10.0, 10.0, 10.0)), (8.5, 8.5, 8.5)),
        (tube(9.0, 5.0, 10.0, 40), tube(9.0, 4.0, 10.0, 44), (0.0, 0.0, 10.4)),
    ],
    ids=["over a face", "in a hole", "at a corner", "rim on rim"],
)
def test_the_triangles_that_are_needed_give_what_all_of_them_do(
    start: SolidMesh, end: SolidMesh, nominal: tuple[float, float, float]
) -> None:
    rng = np.random.default_rng(8)
    pose = np.eye(4)
    pose[:3, 3] = nominal
    distance = float(read(whole(start, end), pose[None])[0])
    reach = 0.4 * distance
    pair = solid_pair((start, end), pose, distance, np.full((2, 3), reach))
    turns = rng.normal(size=(400, 3)) * 0.1 * reach / np.abs(start.vertices).max()
    poses = posed(turns, pose[:3, 3] + rng.normal(size=(400, 3)) * reach / 4)
    poses = poses[(pair.moved(poses) <= reach).all(axis=(1, 2))]
    assert len(poses) > 200
    widest = sum(map(len, pair.levels[-1].faces))
    assert sum(map(len, pair.levels[0].faces)) <= widest < 0.8 * (len(start.triangles) + len(end.triangles))
    assert read(pair, poses) == pytest.approx(read(whole(start, end), poses), abs=1e-12)


def test_parts_that_have_moved_farther_are_read_by_all_of_their_triangles() -> None:
    start, end = block((20.0, 20.0, 20.0)), block((4.0, 4.0, 4.0))
    above = np.eye(4)
    above[2, 3] = 12.5
    pair = solid_pair((start, end), above, 0.5, np.full((2, 3), 0.1))
    beside = posed(np.zeros((1, 3)), np.array([[13.0, 0.0, 0.0]]))
    assert read(pair, beside) == pytest.approx([1.0], abs=FOUND)


def test_overlap_has_no_value_but_a_status() -> None:
    start, end = block((20.0, 20.0, 20.0)), block((4.0, 4.0, 4.0))
    above = np.eye(4)
    above[2, 3] = 12.5
    poses = posed(np.zeros((4, 3)), np.array([[0, 0, 12.5], [0, 0, 11.9], [0.0, 0, 0], [0, 0, 12.01]]))
    for reach in (0.1, 20.0):
        values, codes = PairDistances(solid_pair((start, end), above, 0.5, np.full((2, 3), reach))).of(poses)
        assert codes.tolist() == [OK, OVERLAP, OVERLAP, OK]  # cut by a face; wholly inside
        assert np.isnan(values[[1, 2]]).all()
        assert values[[0, 3]] == pytest.approx([0.5, 0.01], abs=FOUND)


def test_a_closed_mesh_goes_once_around_what_is_in_it() -> None:
    corners = ball(2.0, 9).corners
    assert turns_about(corners - [0.3, -0.4, 1.2]) == pytest.approx(1.0, abs=1e-12)
    assert turns_about(corners - [0.3, -2.4, 1.2]) == pytest.approx(0.0, abs=1e-12)
    hollow = tube(9.0, 5.0, 10.0, 20).corners
    assert turns_about(hollow - [0.0, 1.0, 0.0]) == pytest.approx(0.0, abs=1e-12)
    assert turns_about(hollow - [0.0, 7.0, 0.0]) == pytest.approx(1.0, abs=1e-12)
