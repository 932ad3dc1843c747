"""Parts at rest on one-sided contacts, against scipy's linear programmes and against all sets of contacts."""

from contextlib import suppress
from itertools import combinations

import numpy as np
import pytest
from assembly.placing.built_by_numbers import posed
from assembly.placing.one_sided_parts import Contacts, pads, programme, random_contacts, random_pads
from assembly.placing.rigid_search import solved_pose
from numpy.typing import NDArray

from tol3d.assembly.model.moves import PointsOn
from tol3d.assembly.placing.road import answers, placed
from tol3d.errors import InputError

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


def relinearised(own: Contacts, heights: Array) -> tuple[Array, Mask, float]:
    """The pose (4, 4) at rest, which contacts carry, and the least of what they do, by programmes about poses found."""
    pose, foot = np.eye(4), own.points + heights[:, None] * own.normals
    carry, least = np.zeros(len(heights), dtype=bool), 0.0
    for _ in range(4):
        arms = own.points @ pose[:3, :3].T
        gaps = ((arms + pose[:3, 3] - foot) * own.normals).sum(axis=1)
        # about the part's origin, which the arms are of
        loads = programme(own, pose[:3, :3], arms, gaps)
        assert loads is not None
        carry, least = loads > 1e-7, float(loads[loads > 1e-7].min())

        def lacking(turn: Array, shift: Array, carry: Mask = carry) -> Array:
            return np.asarray(((own.points @ turn.T + shift - foot) * own.normals).sum(axis=1)[carry])

        pose = solved_pose(lacking, np.eye(4))
    return pose, carry, least


@pytest.mark.parametrize("seed", [*range(6), *(pytest.param(s, marks=pytest.mark.slow) for s in range(100, 600))])
def test_a_part_on_contacts_on_all_sides_rests_where_highs_lays_it(seed: int) -> None:
    rng = np.random.default_rng(seed)
    own = random_contacts(rng)
    heights = rng.normal(0, 0.1, (2, len(own.points)))
    model = own.rested()
    poses = placed(model, heights)["part"]
    carried = answers(model, heights, [])[1]["rest"]
    for pose, row, carriers in zip(poses, heights, carried, strict=True):
        if not np.abs(pose[:3, :3] - np.eye(3)).max() < 5e-3:
            continue  # arms are those of the drawing: tilts like that may change which contacts carry
        expected, carry, least = relinearised(own, row)
        if least < 0.02:
            continue  # and smaller ones may where a contact carries next to nothing
        assert carriers == " ".join(map(str, np.flatnonzero(carry) + 1))
        assert np.abs(pose - expected).max() < 1e-9


def rests_on_three(places: Array, heights: Array, at: Array) -> Array:
    """Height at the origin and slopes (3,) of the plane over pads that rests on three of them about a point."""
    for chosen in combinations(range(len(places)), 3):
        own = np.column_stack([np.ones(3), places[list(chosen)]])
        if abs(np.linalg.det(own)) < 1e-6:
            continue
        plane = np.linalg.solve(own, heights[list(chosen)])
        shares = np.linalg.solve(own.T, np.array([1.0, *at]))
        above = plane[0] + places @ plane[1:] - heights
        if shares.min() >= 0 and above.min() > -1e-9:
            return np.asarray(plane)
    raise AssertionError("some three pads carry")


@pytest.mark.parametrize("seed", [*range(10), *(pytest.param(s, marks=pytest.mark.slow) for s in range(100, 350))])
@pytest.mark.parametrize("points_on", ["part", "fixture"])
def test_a_plate_on_pads_rests_on_those_three_that_brute_force_finds(seed: int, points_on: PointsOn) -> None:
    """Pads that stand still and a plane that rides on the plate: finite. The reverse agrees to second order."""
    rng = np.random.default_rng(seed)
    own = random_pads(rng)
    pose = posed(rng.normal(0, 1, 3), rng.uniform(-50, 50, 3))
    model = own.rested(pose, points_on)
    heights = rng.normal(0, 0.05, (5, len(own.points)))
    for found, row in zip(placed(model, heights)["part"], heights, strict=True):
        height, *slopes = rests_on_three(own.points[:, :2], row, own.at[:2])
        moved = found @ np.linalg.inv(pose)
        z = moved[:3, 2] / moved[2, 2]
        seen = moved[:3, 3] @ z, *-z[:2]  # of the plate's plane at the origin
        second_order = 200 * float(np.square(slopes).sum())  # mm; the pads lie up to 140 mm from the middle
        assert seen == pytest.approx((height, *slopes), abs=1e-10 + (second_order if points_on == "part" else 0.0))


def test_the_one_shot_of_four_pads() -> None:
    """Reference problem 7: h = (.10, -.04, .06, .02), centre of gravity (0, -20)."""
    own = pads(np.array([[-100.0, -60], [100, -60], [100, 60], [-100, 60]]), at=(0.0, -20.0))
    heights = np.array([[0.10, -0.04, 0.06, 0.02]])
    pose = placed(own.rested(points_on="fixture"), heights)["part"][0]
    z = pose[:3, 2] / pose[2, 2]
    plane = np.array([pose[:3, 3] @ z, *-z[:2]])
    assert plane == pytest.approx((0.08, -0.0007, 0.05 / 60), abs=1e-7)
    assert plane @ (1, -100, 60) - 0.02 == pytest.approx(0.18, abs=1e-5)
    assert plane @ (1, 0, -20) == pytest.approx(0.19 / 3, abs=1e-6)
    assert answers(own.rested(points_on="fixture"), heights, [])[1]["rest"].tolist() == ["1 2 3"]


def test_a_trial_has_the_same_bits_alone_and_among_others() -> None:
    own = random_contacts(np.random.default_rng(3)).rested()
    heights = np.random.default_rng(4).normal(0, 0.2, (50, own.width))
    together = placed(own, heights)["part"]
    for k in (0, 7, 49):
        assert np.array_equal(placed(own, heights[k : k + 1])["part"][0], together[k])


def test_one_sided_contacts_are_not_pierced() -> None:
    """Points on the part: gaps by the poses, of all contacts; those that carry are met."""
    for seed in range(5):
        rng = np.random.default_rng(seed)
        own = random_contacts(rng)
        heights = rng.normal(0, 0.5, (40, len(own.points)))
        model = own.rested()
        poses, carried = placed(model, heights)["part"], answers(model, heights, [])[1]["rest"]
        for pose, row, carriers in zip(poses, heights, carried, strict=True):
            moved = own.points @ pose[:3, :3].T + pose[:3, 3]
            gaps = ((moved - own.points) * own.normals).sum(axis=1) - row
            assert gaps.min() > -1e-10
            assert np.abs(gaps[[int(k) - 1 for k in carriers.split()]]).max() < 1e-10


@pytest.mark.parametrize("seed", [17, 58, *(pytest.param(s, marks=pytest.mark.slow) for s in range(200, 260))])
def test_contacts_that_hold_a_part_barely_are_met_too(seed: int) -> None:
    """Slanted normals and deviations of 0.3 mm on 80 mm: the gaps are linearised anew where once is not enough."""
    rng = np.random.default_rng(seed)
    while True:
        normals = np.repeat(np.eye(3)[[2, 1, 0]], rng.integers([3, 2, 1], [9, 6, 5]), axis=0)
        normals = normals + rng.normal(0, 0.3, normals.shape)
        normals /= np.linalg.norm(normals, axis=1)[:, None]
        force = -rng.uniform([0.2, 0.2, 0.5], 1.0)
        own = Contacts(rng.uniform(-80, 80, (len(normals), 3)), normals, force, rng.uniform(-30, 30, 3))
        with suppress(InputError):
            model = own.rested()
            heights = rng.normal(0, 0.3, (100, len(normals)))
            poses, carried = placed(model, heights)["part"], answers(model, heights, [])[1]["rest"]
            break
    found = np.isfinite(poses[:, 0, 0])
    room = np.array([programme(own, np.eye(3), own.points, -row) is not None for row in heights])
    assert np.mean(found & ~room) <= 0.01  # what clashes to first order clashes
    # turns of several degrees: lost where the drawing's lever arms and those of the pose want other contacts
    assert np.mean(room & ~found) < (0.01 if seed < 100 else 0.2)
    for pose, row, carriers in zip(poses[found], heights[found], carried[found], strict=True):
        gaps = ((own.points @ pose[:3, :3].T + pose[:3, 3] - own.points) * normals).sum(axis=1) - row
        assert gaps.min() > -1e-10
        assert np.abs(gaps[[int(k) - 1 for k in carriers.split()]]).max() < 1e-10
