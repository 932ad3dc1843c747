"""Parts at rest on both methods: small displacements by scipy, what rocks, what finds no room."""

from itertools import combinations, pairwise

import numpy as np
import pytest
from assembly.placing.one_sided_parts import Contacts, pads, programme, random_contacts, random_pads
from numpy.typing import NDArray
from scipy.optimize import linprog
from scipy.stats import norm

from tol3d.assembly.model import Assembly
from tol3d.assembly.model.measures import Rocking
from tol3d.assembly.model.statuses import NO_BUILD, NOT_UNIQUE, OK
from tol3d.assembly.placing import method as placing
from tol3d.assembly.torsors import method as torsors

Array = NDArray[np.float64]

SEEN = [(np.array([30.0, -20.0, 50.0]), along) for along in np.eye(3)] + [(np.array([-60.0, 70.0, 10.0]), np.eye(3)[2])]


def exact(model: Assembly, heights: Array) -> tuple[Array, NDArray[np.int8]]:
    """Values and codes (measures, trials)."""
    found = placing.values(model, heights, list(model.measures))
    return np.array([own for own, _ in found.values()]), np.array([codes for _, codes in found.values()])


def linear(model: Assembly, heights: Array) -> Array:
    """Values (measures, trials)."""
    return np.array(list(torsors.values(model, heights, list(model.measures)).values()))


@pytest.mark.parametrize("seed", [*range(8), *(pytest.param(s, marks=pytest.mark.slow) for s in range(100, 400))])
def test_small_displacements_are_those_of_the_linear_programme(seed: int) -> None:
    """HiGHS says which contacts carry; six of them give shift and turn."""
    rng = np.random.default_rng(seed)
    own = random_contacts(rng)
    heights = rng.normal(0, 0.1, (4, len(own.points)))
    for row, found in zip(heights, linear(own.rested(seen=SEEN), heights).T, strict=True):
        loads = programme(own, np.eye(3), own.points, -row)
        assert loads is not None
        carry = np.argsort(-loads)[:6]
        assert loads[carry].min() > 1e-6
        rows = np.hstack([own.normals, np.cross(own.points, own.normals)])
        moved = np.linalg.solve(rows[carry], row[carry])
        expected = [along @ (moved[:3] + np.cross(moved[3:], at)) for at, along in SEEN]
        assert found == pytest.approx(expected, abs=1e-11)


@pytest.mark.parametrize("seed", [0, 1, 2, pytest.param(3, marks=pytest.mark.slow)])  # where a tilt lifts a contact
def test_both_methods_differ_by_terms_of_second_order_away_from_switches(seed: int) -> None:
    rng = np.random.default_rng(seed)
    model = random_contacts(rng).rested(seen=SEEN)
    heights = rng.normal(0, 0.2, (30, model.width))
    off = [np.abs(exact(model, s * heights)[0] - linear(model, s * heights)).max(axis=0) for s in (1.0, 0.5, 0.25)]
    carried = [placing.answers(model, s * heights, [])[1]["carries:rest"] for s in (1.0, 0.25)]
    same = carried[0] == carried[1]
    assert same.mean() > 0.8
    for coarse, fine in pairwise(off):
        assert np.median((coarse / fine)[same]) == pytest.approx(4.0, rel=0.1)


def over_poses(places: Array, heights: Array, at: Array, seen: Array) -> tuple[float, float]:
    """Least and largest height at a place of planes over pads that are as low as they can be at another, by HiGHS."""
    above = np.column_stack([np.ones(len(places)), places])
    pull, eye = np.array([1.0, *at]), np.array([1.0, *seen])
    low = linprog(pull, A_ub=-above, b_ub=-heights, bounds=(None, None), method="highs").fun
    ends = [
        linprog(sign * eye, A_ub=np.vstack([-above, pull]), b_ub=[*-heights, low + 1e-12], bounds=(None, None)).fun
        for sign in (1.0, -1.0)
    ]
    return ends[0], -ends[1]


FIVE = np.array([[-80.0, -50.0], [90.0, -60.0], [70.0, 60.0], [-90.0, 40.0], [0.0, 0.0]])
"""With the weight over the last one."""
SQUARE = np.array([[-100.0, -60.0], [100.0, -60.0], [100.0, 60.0], [-100.0, 60.0]])


@pytest.mark.parametrize("places", [FIVE, SQUARE], ids=["on one pad in the middle", "on two across"])
def test_what_rocks_is_read_over_all_poses_that_are_as_low(places: Array) -> None:
    """On one pad the poses fill a polygon: it tips every way until another pad stops it."""
    rng = np.random.default_rng(5)
    heights = rng.normal(0, 0.05, (40, len(places)))
    heights[:20, -1] += 0.2  # the middle pad stands proud; or one of four
    seen = [(np.array([x, y, 0.0]), np.eye(3)[2]) for x, y in ((40.0, 30.0), (-10.0, 55.0), (0.0, 0.0))]
    expected = np.array(
        [[over_poses(places, row, np.zeros(2), at[:2]) for row in heights] for at, _ in seen]
    )  # (measures, trials, ends)
    asked: dict[Rocking, Array] = {
        "least": expected[:, :, 0],
        "largest": expected[:, :, 1],
        "middle": expected.mean(axis=2),
    }
    for rocking, values in asked.items():
        model = pads(places).rested(points_on="fixture", seen=seen, rocking=rocking)
        found, codes = exact(model, heights)
        assert (codes == OK).all()
        assert np.abs(found - values).max() < 1e-5  # second order of tilts of 5e-3 over 100 mm
        assert np.abs(linear(model, heights) - values).max() < 1e-9
    found, codes = exact(pads(places).rested(points_on="fixture", seen=seen), heights)
    wide = np.ptp(expected, axis=2) > 1e-6
    assert wide[:2, :20].all()
    assert np.array_equal(codes == NOT_UNIQUE, wide)
    assert np.isfinite(found[~wide]).all()
    assert (codes[2] == OK).all()


def test_a_part_that_never_rocks_has_no_other_value_by_rocking() -> None:
    rng = np.random.default_rng(11)
    own = random_pads(rng)
    heights = rng.normal(0, 0.05, (200, len(own.points)))
    plain, codes = exact(own.rested(seen=SEEN), heights)
    assert (codes == OK).all()
    asked, _ = exact(own.rested(seen=SEEN, rocking="largest"), heights)
    assert np.array_equal(asked, plain)
    assert np.abs(linear(own.rested(seen=SEEN, rocking="largest"), heights) - asked).max() < 1e-2


@pytest.mark.parametrize("seed", range(3))
def test_of_many_pads_the_least_height_is_that_of_the_best_three(seed: int) -> None:
    """By duality the height at the weight is the largest over triangles about it of what their corners give there."""
    rng = np.random.default_rng(seed)
    places = rng.uniform(-100, 100, (12, 2))
    at = places.mean(axis=0)
    heights = rng.normal(0, 0.05, (100, 12))
    shares = []
    for chosen in combinations(range(12), 3):
        own = np.zeros(12)
        own[list(chosen)] = np.linalg.solve(np.vstack([np.ones(3), places[list(chosen)].T]), [1.0, *at])
        if own.min() >= 0:
            shares.append(own)
    expected = (heights @ np.array(shares).T).max(axis=1)
    model = pads(places, at=(at[0], at[1])).rested(points_on="fixture", seen=[(np.array([*at, 0.0]), np.eye(3)[2])])
    assert np.abs(linear(model, heights)[0] - expected).max() < 1e-12
    assert np.abs(exact(model, heights)[0][0] - expected).max() < 1e-5


def test_a_part_between_walls_that_are_too_near_does_not_build() -> None:
    """Three pads, a wall that it is pressed against, and one across with a mean room of 0.1; all normal, sigma 0.05."""
    points = np.array([[-50.0, -50, 0], [50, -50, 0], [0, 60, 0], [-60, 0, 0], [60, 0, 0]])
    normals = np.eye(3)[[2, 2, 2, 0, 0]] * np.array([1, 1, 1, 1, -1])[:, None]
    own = Contacts(points, normals, np.array([-0.3, 0.0, -1.0]), np.zeros(3))
    model = own.rested(seen=[(np.zeros(3), np.eye(3)[0]), (np.zeros(3), np.eye(3)[2])])
    count = 20_000
    heights = np.random.default_rng(2).normal(0, 0.05, (count, 5))
    heights[:, 4] -= 0.1
    found, codes = exact(model, heights)
    clashes = heights[:, 3] + heights[:, 4] > 0
    assert np.array_equal(codes[0] == NO_BUILD, clashes)
    assert np.array_equal(codes[0] == OK, ~clashes)
    share = norm.cdf(-0.1 / np.hypot(0.05, 0.05))
    assert abs(clashes.mean() - share) < 4 * np.sqrt(share * (1 - share) / count)
    assert np.isnan(found[:, clashes]).all()
    assert np.abs(found[0] - heights[:, 3])[~clashes].max() < 1e-3  # tilts of 4e-3, squared, over 60 mm
