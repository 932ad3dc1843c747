"""Parts at rest on one-sided contacts, against scipy's linear programmes and against all sets of contacts."""

from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
import pytest
from assembly.placing.built_by_numbers import Columns, assembly, feature, frame, pair, part, posed
from assembly.placing.rigid_search import solved_pose
from numpy.typing import NDArray
from scipy.optimize import linprog

from tol3d.assembly.model import Assembly, Fix, Point, Rest
from tol3d.assembly.model.moves import PointsOn
from tol3d.assembly.placing.road import answers, placed

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

DOWN = np.array([0.0, 0.0, -1.0])


@dataclass(frozen=True)
class Contacts:
    """Points of a part on planes of a base, nominally touching."""

    points: Array
    normals: Array
    force: Array
    at: Array

    def rested(self, pose: Array | None = None, points_on: PointsOn = "part") -> Assembly:
        """A part at rest; the deviations are the heights of locators, or of the points that stand still, in order."""
        columns, own = Columns(), np.eye(4) if pose is None else pose
        back = np.linalg.inv(own)
        base, moving, pairs = [], [], []
        for k, (at, normal) in enumerate(zip(self.points, self.normals, strict=True)):
            height = columns(normal[:, None])
            on_part = points_on == "part"
            base.append(feature(f"base.{k}", Point(), frame(at), () if on_part else [height]))
            moving.append(feature(f"part.{k}", Point(), frame(back[:3, :3] @ at + back[:3, 3])))
            direction = normal if on_part else back[:3, :3] @ normal
            locator = [replace(height, matrix=np.eye(1))] if on_part else []
            pairs.append(pair(f"part.{k}", f"base.{k}", direction, locator))
        at = back[:3, :3] @ self.at + back[:3, 3]
        move = Rest("rest", "part", tuple(pairs), self.force, at, points_on)
        return assembly(columns, [part("base", base), part("part", moving, pose=own)], [Fix("put", "base"), move])


def pads(places: Array, force: Array = DOWN, at: tuple[float, float] = (0.0, 0.0)) -> Contacts:
    """Pads at places (pads, 2), their normals up."""
    points = np.column_stack([places, np.zeros(len(places))])
    return Contacts(points, np.tile([0.0, 0.0, 1.0], (len(places), 1)), force, np.array([*at, 0.0]))


def random_pads(rng: np.random.Generator) -> Contacts:
    """Three to eight pads, the centre of gravity well within."""
    while True:
        places = rng.uniform(-100, 100, (rng.integers(3, 9), 2))
        shares = rng.dirichlet(np.ones(len(places)))
        if np.linalg.svd(places - places.mean(axis=0), compute_uv=False)[1] > 40:
            return pads(places, at=tuple(shares @ places))


def random_contacts(rng: np.random.Generator) -> Contacts:
    """Six to nine contacts on all sides, and a force that some of them balance, with some room to either side."""
    while True:
        counts = rng.integers(3, 6), rng.integers(2, 4), rng.integers(1, 3)
        normals = np.repeat(np.eye(3)[[2, 1, 0]], counts, axis=0) + rng.normal(0, 0.15, (sum(counts), 3))
        normals /= np.linalg.norm(normals, axis=1)[:, None]
        force = -np.array([rng.uniform(0.2, 1), rng.uniform(0.2, 1), rng.uniform(0.5, 1)])
        found = Contacts(rng.uniform(-80, 80, (len(normals), 3)), normals, force, rng.uniform(-30, 30, 3))
        held = programme(found, np.eye(3), found.points, np.zeros(len(normals)))
        if held is not None and np.sum(held > 0.02) == 6:
            return found


def programme(own: Contacts, turn: Array, points: Array, gaps: Array) -> Array | None:
    """What contacts carry by HiGHS (contacts,); None where they do not hold the part."""
    rows = np.hstack([own.normals, np.cross(points, own.normals) / 50])
    pull = np.concatenate([own.force, np.cross(turn @ own.at, own.force) / 50])
    found = linprog(-pull, A_ub=-rows, b_ub=gaps, bounds=(None, None), method="highs")
    return -np.asarray(found.ineqlin.marginals) if found.status == 0 else None


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
        expected, carry, least = relinearised(own, row)
        if least < 0.02:
            continue  # arms that are as nominally may choose others where a contact carries next to nothing
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
