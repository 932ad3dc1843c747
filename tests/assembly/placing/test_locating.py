"""Parts on six locators."""

from typing import Any

import numpy as np
import pytest
from assembly.placing.built_by_numbers import Columns, assembly, feature, frame, moved_as_a_whole, pair, part, posed
from assembly.placing.rigid_search import solved_pose
from numpy.typing import NDArray

from tol3d.assembly.grammar.measures.gap import GapSpec
from tol3d.assembly.model import Assembly, Fix, Locate, Measured, Move, Point
from tol3d.assembly.model.moves import PointsOn
from tol3d.assembly.model.statuses import OK, SINGULAR
from tol3d.assembly.placing.locator_move import contacts_met
from tol3d.assembly.placing.method import placed, values
from tol3d.errors import InputError

Array = NDArray[np.float64]

NEST = (
    ((20, 15, 0), (0, 0, 1)),
    ((180, 15, 0), (0, 0, 1)),
    ((100, 90, 0), (0, 0, 1)),
    ((30, 0, 25), (0, 1, 0)),
    ((170, 0, 25), (0, 1, 0)),
    ((0, 50, 20), (1, 0, 0)),
)
"""Locators of a nest and their normals."""

ONE_SHOT = np.array([2, -1.5, 3, 1.2, -2, 0.8])


def nest(points_on: PointsOn, locators: Any = NEST) -> Assembly:
    """A part in a nest whose locators move along their normals; a corner is measured from the fixture along y."""
    columns = Columns()
    fixture, box, pairs = [], [], []
    for k, (point, normal) in enumerate(locators):
        fixture.append(feature(f"fixture.{k}", Point(), frame(point), [columns(np.reshape(normal, (3, 1)))]))
        box.append(feature(f"box.{k}", Point(), frame(point)))
        pairs.append(pair(f"box.{k}", f"fixture.{k}", normal))
    fixture.append(feature("fixture.corner", Point(), frame((200, 100, 40))))
    box.append(feature("box.corner", Point(), frame((200, 100, 40))))
    moves: list[Move] = [Fix("fixture", "fixture"), Locate("box", "box", tuple(pairs), points_on)]
    corner = Measured(GapSpec.reads, ("fixture.corner", "box.corner"), np.array([0.0, 1.0, 0.0]))
    return assembly(columns, [part("fixture", fixture), part("box", box)], moves, {"corner": corner})


def displacement(pose: Array, point: tuple[float, float, float]) -> Array:
    return np.asarray(pose[:3, :3] @ point + pose[:3, 3] - point)


@pytest.mark.parametrize(
    ("points_on", "point", "expected"),
    [
        ("fixture", (200, 100, 40), (2.408011807, -3.229549268, 1.044517202)),
        ("fixture", (100, 50, 60), (1.753270438, -1.713939689, 1.486799988)),
        ("part", (200, 100, 40), (2.302665, -3.338431, 1.142691)),
    ],
)
def test_one_shot_of_a_nest(points_on: PointsOn, point: tuple[float, float, float], expected: tuple[float]) -> None:
    pose = placed(nest(points_on), ONE_SHOT[None])["box"][0]
    # half of the last digit that is printed
    np.testing.assert_allclose(displacement(pose, point), expected, atol=6e-10 if points_on == "fixture" else 6e-7)


@pytest.mark.parametrize("points_on", ["part", "fixture"])
def test_both_ways_of_contact_agree_with_equations_solved_by_scipy(points_on: PointsOn) -> None:
    points, normals = (np.array([each[k] for each in NEST], dtype=float) for k in range(2))
    moved = points + ONE_SHOT[:, None] * normals

    def lacking(turn: Array, shift: Array) -> Array:
        if points_on == "part":
            return np.asarray(np.sum(normals * (points @ turn.T + shift - moved), axis=1))
        return np.asarray(np.sum(normals * ((moved - shift) @ turn - points), axis=1))

    expected = solved_pose(lacking, np.eye(4))
    np.testing.assert_allclose(placed(nest(points_on), ONE_SHOT[None])["box"][0], expected, atol=1e-10)


def test_a_corner_follows_its_locators_as_their_coefficients_say() -> None:
    """Statics by hand: weights of the corner in the three, the two and the one; tilt moves what lies 40 above."""
    by_hand = np.array([0.1, 0.1, -0.2, -3 / 14, 17 / 14, 0.0])
    small = 1e-5 * np.eye(6)
    for points_on in ("part", "fixture"):
        up, down = (values(nest(points_on), each, ["corner"])["corner"][0] for each in (small, -small))
        # what is left of central differences: third order, 1e-5^2 / reach
        np.testing.assert_allclose((up - down) / 2e-5, by_hand, atol=1e-9)


NO_POSE = {(635, "fixture")}
"""Seeds for which scipy from 200 starts leaves 0.02 mm."""


def random_move(seed: int, points_on: PointsOn = "part") -> tuple[Assembly, Array, Array]:
    """A part on six random contacts with two parts that are fixed at random poses; deviations; what scipy finds."""
    random = np.random.default_rng(seed)
    while True:
        points, normals = random.uniform(-60, 60, (6, 3)), random.normal(size=(6, 3))
        normals /= np.linalg.norm(normals, axis=1)[:, None]
        rows = np.hstack([np.cross(points, normals) / 60, normals])
        if np.linalg.cond(rows) < 20:  # worse ones have builds that no pose meets
            break
    columns = Columns()
    poses = {name: posed(random.normal(size=3), random.uniform(-200, 200, 3)) for name in ("one", "two", "loose")}
    features: dict[str, list[Any]] = {name: [] for name in poses}
    pairs, seen = [], []
    for k, (point, normal) in enumerate(zip(points, normals, strict=True)):
        holder = ("one", "two")[int(random.integers(2))]
        target_from_loose = np.linalg.inv(poses[holder]) @ poses["loose"]
        at = target_from_loose @ [*point, 1.0]
        features[holder].append(feature(f"{holder}.{k}", Point(), frame(at[:3]), [columns(count=3)]))
        features["loose"].append(feature(f"loose.{k}", Point(), frame(point), [columns(count=3)]))
        along = target_from_loose[:3, :3] @ normal if points_on == "part" else normal
        locator = [columns(np.ones((1, 1)))]
        pairs.append(pair(f"loose.{k}", f"{holder}.{k}", along, locator))
        seen.append(holder)
    moves: list[Move] = [Fix("one", "one"), Fix("two", "two"), Locate("loose", "loose", tuple(pairs), points_on)]
    made = assembly(columns, [part(name, features[name], pose=poses[name]) for name in poses], moves)
    deviations = random.normal(0, 0.1, columns.width)

    feet, normals_there, riding, up = [], [], [], []
    used = dict.fromkeys(poses, 0)
    for k, holder in enumerate(seen):
        own = deviations[7 * k : 7 * k + 7]
        base = features[holder][used[holder]].frame
        used[holder] += 1
        turn, shift = poses[holder][:3, :3], poses[holder][:3, 3]
        feet.append(turn @ (base[:3, :3] @ own[:3] + base[:3, 3]) + shift)
        normals_there.append(turn @ pairs[k].normal if points_on == "part" else pairs[k].normal)
        its = features["loose"][k].frame
        riding.append(its[:3, :3] @ own[3:6] + its[:3, 3])
        up.append(own[6])

    def lacking(turn: Array, shift: Array) -> Array:
        if points_on == "fixture":  # planes on the part, seen from it: a part that is lifted leaves its points behind
            left = (np.array(feet) - shift) @ turn - np.array(riding)
            return np.asarray(np.sum(left * np.array(normals_there), axis=1) + np.array(up))
        reached = np.array(riding) @ turn.T + shift - np.array(feet)
        return np.asarray(np.sum(reached * np.array(normals_there), axis=1) - up)

    expected = solved_pose(lacking, poses["loose"])
    if (seed, points_on) in NO_POSE:
        return made, deviations, np.full((4, 4), np.nan)
    np.testing.assert_allclose(lacking(expected[:3, :3], expected[:3, 3]), 0, atol=1e-11)
    return made, deviations, expected


def agrees_with_scipy(seed: int, points_on: PointsOn) -> None:
    made, deviations, expected = random_move(seed, points_on)
    # condition 20 times rounding of scipy's 300 mm: 1e-12; a tenth of a picometre is asked for
    found = placed(made, deviations[None])["loose"][0]
    np.testing.assert_allclose(found[:3], expected[:3], atol=1e-10, rtol=0)


@pytest.mark.parametrize("points_on", ["part", "fixture"])
@pytest.mark.parametrize("seed", range(12))
def test_random_contacts_agree_with_scipy(seed: int, points_on: PointsOn) -> None:
    agrees_with_scipy(seed, points_on)


@pytest.mark.slow
@pytest.mark.parametrize("points_on", ["part", "fixture"])
@pytest.mark.parametrize("seed", range(100, 1100))
def test_a_thousand_random_contacts_agree_with_scipy(seed: int, points_on: PointsOn) -> None:
    agrees_with_scipy(seed, points_on)


def test_where_an_assembly_lies_changes_no_measure() -> None:
    deviations = np.random.default_rng(3).normal(0, 0.5, (50, 6))
    there = moved_as_a_whole(nest("part"), posed((0.4, -1.1, 0.7), (300, -120, 55)))
    here, elsewhere = (values(each, deviations, ["corner"])["corner"][0] for each in (nest("part"), there))
    np.testing.assert_allclose(elsewhere, here, atol=1e-12 * 300)


def test_a_trial_has_the_same_bits_alone_and_among_thousands() -> None:
    deviations = np.random.default_rng(4).normal(0, 0.5, (9000, 6))
    for points_on in ("part", "fixture"):
        together = placed(nest(points_on), deviations)["box"]
        for row in (0, 1, 8191, 8192, 8999):  # of two blocks
            alone = placed(nest(points_on), deviations[row : row + 1])["box"][0]
            np.testing.assert_array_equal(alone, together[row])


def test_what_is_not_a_number_is_a_fault_and_no_status(monkeypatch: pytest.MonkeyPatch) -> None:
    """A deviation, a pose that the contacts are told to have found, a measure; a failed trial's pose is none."""
    deviations = np.random.default_rng(5).normal(0, 0.5, (40, 6))
    deviations[7, 3:5] = (200, -200)
    values(nest("part"), deviations, ["corner"])
    for lost in (np.nan, np.inf):
        wrong = deviations.copy()
        wrong[31, 5] = lost
        with pytest.raises(FloatingPointError, match="a deviation is not a number in 1 trials"):
            values(nest("part"), wrong, ["corner"])

    def losing(*given: Array) -> None:
        contacts_met(*given)
        *_, shift, met = given
        shift[0, 12:13], shift[0, met == 0.0] = np.nan, np.nan

    monkeypatch.setattr("tol3d.assembly.placing.locator_move.contacts_met", losing)
    with pytest.raises(FloatingPointError, match="the pose of box is not a number in 1 trials"):
        values(nest("part"), deviations, ["corner"])
    monkeypatch.undo()
    monkeypatch.setattr(
        "tol3d.assembly.placing.method.reading", lambda *_: np.where(np.arange(40) % 20 == 7, np.nan, 1)
    )
    with pytest.raises(FloatingPointError, match=r"measures\.corner is not a number in 1 trials that nothing fails"):
        values(nest("part"), deviations, ["corner"])


def test_contacts_out_of_reach_are_singular_and_disturb_no_other() -> None:
    """Both side locators cannot lie 400 apart in height: no turn of two points 140 apart reaches that."""
    deviations = np.random.default_rng(5).normal(0, 0.5, (40, 6))
    good, _ = values(nest("part"), deviations, ["corner"])["corner"]
    deviations[7, 3:5] = (200, -200)
    found, codes = values(nest("part"), deviations, ["corner"])["corner"]
    bad = np.arange(40) == 7
    np.testing.assert_array_equal(codes, np.where(bad, SINGULAR, OK))
    np.testing.assert_array_equal(found, np.where(bad, np.nan, good))


@pytest.mark.parametrize(
    ("changed", "freedom"),
    [
        ({4: ((30, 0, 25), (0, 1, 0))}, "it turns about z through (30, 50, 0)"),
        ({5: ((100, 0, 25), (0, 1, 0))}, "it shifts along x"),
        ({2: ((100, 15, 0), (0, 0, 1))}, "it turns about x through (0, 15, "),
    ],
)
def test_contacts_that_leave_a_freedom_are_refused_by_its_name(changed: dict[int, Any], freedom: str) -> None:
    locators = [changed.get(k, each) for k, each in enumerate(NEST)]
    with pytest.raises(InputError, match="leave box free") as refused:
        placed(nest("part", locators), np.zeros((1, 6)))
    assert freedom in str(refused.value)
