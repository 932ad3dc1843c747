"""Parts that are mated, relation by relation."""

from collections.abc import Sequence

import numpy as np
import pytest
from assembly.placing.built_by_numbers import Columns, assembly, feature, frame, moved_as_a_whole, part, posed, seeds
from assembly.placing.mated_parts import (
    END,
    FACE,
    FLOOR,
    HOLE,
    NOMINAL,
    PIN,
    REACH,
    SIDE,
    STOP,
    UNDER,
    WALL,
    Side,
    X,
    Z,
    axis,
    features_seen,
    mated,
    plane,
)
from assembly.placing.rigid_search import solved_pose
from numpy.typing import NDArray

from tol3d.assembly.grammar.measures.gap import GapSpec, PointPlaneSpec
from tol3d.assembly.model import Assembly, Axis, Contribution, Fix, Mate, Measured, Move, Point, Relation
from tol3d.assembly.model.statuses import NO_CONTACT, OK
from tol3d.assembly.placing.method import placed, values
from tol3d.errors import InputError

Array = NDArray[np.float64]


def corner() -> tuple[Assembly, Sequence[slice]]:
    return mated(
        [
            ("coincident", ("part.under", FACE, UNDER), ("base.floor", FACE, FLOOR)),
            ("coincident", ("part.side", FACE, SIDE), ("base.wall", FACE, WALL)),
            ("coincident", ("part.end", FACE, END), ("base.stop", FACE, STOP)),
        ]
    )


@pytest.mark.parametrize("seed", seeds(6))
def test_a_block_in_a_corner(seed: int) -> None:
    """Flush on the floor; turned in its plane along the wall; middles on the tilted planes of wall and stop."""
    made, slices = corner()
    row = np.random.default_rng(seed).normal(0, 0.4, made.width)
    from_world = np.linalg.inv(NOMINAL)
    own = [plane(from_world @ at, row[slices[2 * k]], REACH) for k, at in enumerate((UNDER, SIDE, END))]
    target = [plane(at, row[slices[2 * k + 1]], REACH) for k, at in enumerate((FLOOR, WALL, STOP))]
    floor = target[0][1]
    aside = np.linalg.svd(floor[None])[2][1:]

    def lacking(turn: Array, shift: Array) -> Array:
        heights = [n @ (turn @ p + shift - q) for (p, _), (q, n) in zip(own, target, strict=True)]
        flat, wall = aside @ turn @ own[1][1], aside @ target[1][1]
        azimuth = flat[0] * wall[1] - flat[1] * wall[0]
        return np.array([*heights, *(100 * aside @ turn @ own[0][1]), 100 * azimuth])

    np.testing.assert_allclose(placed(made, row[None])["part"][0], solved_pose(lacking, NOMINAL), atol=1e-10)


FIRST, SECOND, SECOND_PIN = frame((20, 30, 10)), frame((90, 50, 10)), frame((90, 50, 4))


@pytest.mark.parametrize("seed", seeds(4))
def test_a_pin_a_face_and_a_second_pin(seed: int) -> None:
    """Coaxial first; the face then only stops along the axis; the second pin turns, as near as it comes."""
    made, slices = mated(
        [
            ("coaxial", ("part.hole", HOLE, FIRST), ("base.pin", PIN, FIRST)),
            ("coincident", ("part.under", FACE, UNDER), ("base.floor", FACE, FLOOR)),
            ("coaxial", ("part.second hole", HOLE, SECOND), ("base.second pin", PIN, SECOND_PIN)),
        ]
    )
    row = np.random.default_rng(seed).normal(0, 0.2, made.width)
    from_world = np.linalg.inv(NOMINAL)
    hole, pin = axis(from_world @ FIRST, row[slices[0]], 20.0), axis(FIRST, row[slices[1]], 20.0)
    under, floor = plane(from_world @ UNDER, row[slices[2]], REACH), plane(FLOOR, row[slices[3]], REACH)
    second, its_pin = axis(from_world @ SECOND, row[slices[4]], 20.0), axis(SECOND_PIN, row[slices[5]], 20.0)
    aside = np.linalg.svd(pin[1][None])[2][1:]

    def abreast(turn: Array, shift: Array) -> Array:
        return np.asarray(its_pin[0] + (turn @ second[0] + shift - its_pin[0]) @ its_pin[1] * its_pin[1])

    def lacking(turn: Array, shift: Array) -> Array:
        across = aside @ (turn @ hole[0] + shift - pin[0])
        height = floor[1] @ (turn @ under[0] + shift - floor[0])
        reached, asked = (
            aside @ (point - (turn @ hole[0] + shift)) for point in (turn @ second[0] + shift, abreast(turn, shift))
        )
        line = (reached[0] * asked[1] - reached[1] * asked[0]) / 70
        return np.array([*across, *(100 * aside @ turn @ hole[1]), height, line])

    np.testing.assert_allclose(placed(made, row[None])["part"][0], solved_pose(lacking, NOMINAL), atol=1e-10)


@pytest.mark.parametrize("seed", seeds(4))
def test_points_swing_a_part_onto_planes(seed: int) -> None:
    """Flush on the floor, then two points on the wall and one at the stop."""
    points = frame((0, 20, 15)), frame((0, 70, 15)), frame((45, 0, 10))
    made, slices = mated(
        [
            ("coincident", ("part.under", FACE, UNDER), ("base.floor", FACE, FLOOR)),
            ("coincident", ("part.a", Point(), points[0]), ("base.wall", FACE, WALL)),
            ("coincident", ("part.b", Point(), points[1]), ("base.wall b", FACE, WALL)),
            ("distance", ("part.c", Point(), points[2]), ("base.stop", FACE, STOP)),
        ]
    )
    row = np.random.default_rng(seed).normal(0, 0.4, made.width)
    from_world = np.linalg.inv(NOMINAL)
    under, floor = plane(from_world @ UNDER, row[slices[0]], REACH), plane(FLOOR, row[slices[1]], REACH)
    riding = [from_world @ at for at in points]
    own = [at[:3, :3] @ row[slices[2 * k]] + at[:3, 3] for k, at in enumerate(riding, start=1)]
    target = [plane(at, row[slices[2 * k + 1]], REACH) for k, at in enumerate((WALL, WALL, STOP), start=1)]
    aside = np.linalg.svd(floor[1][None])[2][1:]

    def lacking(turn: Array, shift: Array) -> Array:
        heights = [n @ (turn @ p + shift - q) for p, (q, n) in zip([under[0], *own], [floor, *target], strict=True)]
        return np.array([*heights, *(100 * aside @ turn @ under[1])])

    np.testing.assert_allclose(placed(made, row[None])["part"][0], solved_pose(lacking, NOMINAL), atol=1e-10)


@pytest.mark.parametrize("seed", seeds(4))
def test_three_points_on_three_walls(seed: int) -> None:
    """Flush on the floor, then a point on each of three walls, the last one oblique: nothing lies abreast."""
    points = frame((0, 20, 15)), frame((45, 0, 10)), frame((80, 60, 5))
    walls = WALL, STOP, frame((80, 60, 20), (-0.6, 0.8, 0))  # 52 mm beside where the others meet
    names = "abc"
    made, slices = mated(
        [
            ("coincident", ("part.under", FACE, UNDER), ("base.floor", FACE, FLOOR)),
            *(
                ("coincident", (f"part.{name}", Point(), point), (f"base.wall {name}", FACE, wall))
                for name, point, wall in zip(names, points, walls, strict=True)
            ),
        ]
    )
    row = np.random.default_rng(seed).normal(0, 0.2, made.width)
    from_world = np.linalg.inv(NOMINAL)
    under, floor = plane(from_world @ UNDER, row[slices[0]], REACH), plane(FLOOR, row[slices[1]], REACH)
    riding = [from_world @ at for at in points]
    own = [at[:3, :3] @ row[slices[2 * k]] + at[:3, 3] for k, at in enumerate(riding, start=1)]
    target = [plane(at, row[slices[2 * k + 1]], REACH) for k, at in enumerate(walls, start=1)]
    aside = np.linalg.svd(floor[1][None])[2][1:]

    def lacking(turn: Array, shift: Array) -> Array:
        heights = [n @ (turn @ p + shift - q) for p, (q, n) in zip([under[0], *own], [floor, *target], strict=True)]
        return np.array([*heights, *(100 * aside @ turn @ under[1])])

    np.testing.assert_allclose(placed(made, row[None])["part"][0], solved_pose(lacking, NOMINAL), atol=1e-10)


def test_points_alone_are_sent_to_contacts() -> None:
    made, _ = mated(
        [
            ("coincident", (f"part.{k}", Point(), frame((20.0 * k, 30.0 * k * k, 0))), (f"base.floor {k}", FACE, FLOOR))
            for k in range(3)
        ]
    )
    with pytest.raises(InputError, match="three_two_one or six_plane"):
        placed(made, np.zeros((1, made.width)))


def test_a_cylinder_lies_on_a_plane_by_the_radius_of_its_trial() -> None:
    """On the floor it is square to the wall's normal after the floor: axis parallel to the floor, one radius up."""
    columns = Columns()
    size = columns(np.ones((1, 1)))
    tilt = columns(count=3)
    base = [feature("base.floor", FACE, FLOOR, [tilt]), feature("base.wall", FACE, WALL)]
    bar = [
        feature("bar.end", FACE, frame((0, 40, 5), (-1, 0, 0))),
        feature("bar.axis", Axis(60.0, 10.0), frame((30, 40, 5), (1, 0, 0))),
    ]
    bar[1] = type(bar[1])(bar[1].name, "bar", bar[1].shape, bar[1].frame, size_by=(size,))
    relations = (Relation("coincident", "bar.end", "base.wall"), Relation("tangent", "bar.axis", "base.floor"))
    moves: list[Move] = [Fix("base", "base"), Mate("lay", "bar", relations)]
    height = {"height": Measured(PointPlaneSpec.reads, ("bar.axis", "base.floor"))}
    made = assembly(columns, [part("base", base), part("bar", bar)], moves, height)
    found, codes = values(made, np.array([[0.3, 0, 0, 0], [-0.2, 0.1, 0, 0.6]]), ["height"])["height"]
    np.testing.assert_array_equal(codes, 0)
    np.testing.assert_allclose(found, [5.15, 4.9], atol=1e-12)


BAR, ITS_AXIS = Axis(60.0, 10.0), frame((50, 40, 12), X)
SIDE_A, SIDE_B = frame((50, 50, 10), (0, -0.8, 0.6), X), frame((50, 30, 10), (0, 0.8, 0.6), X)
TRAY = frame((50, 40, 0), Z)
BAR_END, STOP_AT_END = frame((20, 40, 12), -X), frame((20, 40, 10), X)
TANGENTS: dict[str, tuple[str, Side, Side]] = {
    "a": ("tangent", ("part.bar", BAR, ITS_AXIS), ("base.a", FACE, SIDE_A)),
    "b": ("tangent", ("part.bar b", BAR, ITS_AXIS), ("base.b", FACE, SIDE_B)),
    "tray": ("tangent", ("part.bar", BAR, ITS_AXIS), ("base.tray", FACE, TRAY)),
    "end": ("coincident", ("part.end", FACE, BAR_END), ("base.end", FACE, STOP_AT_END)),
    "side": ("coincident", ("part.side", FACE, END), ("base.wall", FACE, STOP)),
}


@pytest.mark.parametrize("relations", ["tray", "a end", "tray end", "tray side", "a b", "a b end"])
@pytest.mark.parametrize("seed", seeds(3))
def test_what_lies_on_planes_before_anything_holds_a_direction(relations: str, seed: int) -> None:
    """A cylinder is square to its plane's normal and one radius above it; then a face is as flush as it goes."""
    asked = [TANGENTS[name] for name in relations.split()]
    made, slices = mated(asked)
    row = np.random.default_rng(seed).normal(0, 0.3, made.width)
    pose = placed(made, row[None])["part"][0]
    seen = []
    for (kind, _, _), (own, (origin, normal)) in zip(asked, features_seen(asked, row, slices), strict=True):
        direction = pose[:3, :3] @ own[1]
        height = normal @ (pose[:3, :3] @ own[0] + pose[:3, 3] - origin)
        assert height == pytest.approx(5.0 if kind == "tangent" else 0.0, abs=1e-12)
        if kind == "tangent":
            assert direction @ normal == pytest.approx(0, abs=1e-13)
        seen.append((direction, normal))
    if relations == "tray side":
        assert seen[1][0] @ seen[1][1] == pytest.approx(-1, abs=1e-13)
    elif relations.endswith(" end") and "b" not in relations:
        (_, normal), (face, target) = seen
        face, target = (each - each @ normal * normal for each in (face, target))
        np.testing.assert_allclose(np.cross(face, target), 0, atol=1e-13)  # nearest by a turn about the normal


def test_what_no_relation_asks_stays() -> None:
    """A plane alone: the least turn, and the middle of the face moves along the plane's normal only."""
    made, slices = mated([("coincident", ("part.under", FACE, UNDER), ("base.floor", FACE, FLOOR))])
    row = np.random.default_rng(9).normal(0, 0.4, made.width)
    pose = placed(made, row[None])["part"][0]
    centre, own = plane(np.linalg.inv(NOMINAL) @ UNDER, row[slices[0]], REACH)
    target = plane(FLOOR, row[slices[1]], REACH)[1]
    turn = pose[:3, :3] @ NOMINAL[:3, :3].T
    assert (np.trace(turn) - 1) / 2 == pytest.approx(-target @ NOMINAL[:3, :3] @ own, abs=1e-12)
    moved = (pose - NOMINAL)[:3, :3] @ centre + pose[:3, 3] - NOMINAL[:3, 3]
    np.testing.assert_allclose(np.cross(moved, target), 0, atol=1e-12)


def test_a_point_that_cannot_be_reached_is_no_contact() -> None:
    """An arm of 50 about a pin cannot come to a wall that lies 80 away; other trials keep their bits."""
    columns = Columns()
    away = columns(np.array([[1.0], [0], [0]]))
    base = [
        feature("base.floor", FACE, FLOOR),
        feature("base.pin", Axis(20.0), frame((20, 30, 0))),
        feature("base.wall", FACE, frame((20, 70, 0), (0, 1, 0)), [away]),
    ]
    arm = [
        feature("arm.under", FACE, frame((50, 40, 0), (0, 0, -1))),
        feature("arm.hole", Axis(20.0), frame((20, 30, 0))),
        feature("arm.tip", Point(), frame((50, 70, 0))),
    ]
    relations = tuple(
        Relation("coaxial" if own == "hole" else "coincident", f"arm.{own}", f"base.{target}")
        for own, target in (("under", "floor"), ("hole", "pin"), ("tip", "wall"))
    )
    moves: list[Move] = [Fix("base", "base"), Mate("swing", "arm", relations)]
    reach = {"x": Measured(GapSpec.reads, ("base.pin", "arm.tip"), np.array([1.0, 0, 0]))}
    made = assembly(columns, [part("base", base), part("arm", arm)], moves, reach)
    found, codes = values(made, np.array([[0.0], [-10.0], [40.0], [5.0]]), ["x"])["x"]
    np.testing.assert_array_equal(codes, [OK, OK, NO_CONTACT, OK])
    np.testing.assert_allclose(found[[0, 1, 3]], [30, 40, np.sqrt(2500 - 45**2)], atol=1e-12)
    assert np.isnan(found[2])


def test_a_relation_that_takes_nothing_is_refused() -> None:
    made, _ = mated(
        [
            ("coincident", ("part.under", FACE, UNDER), ("base.floor", FACE, FLOOR)),
            ("coincident", ("part.a", Point(), frame((10, 10, 0))), ("base.floor b", FACE, FLOOR)),
        ]
    )
    with pytest.raises(InputError, match=r"part\.a and base\.floor b takes no freedom"):
        placed(made, np.zeros((1, made.width)))


def test_relations_of_other_shapes_are_refused() -> None:
    made, _ = mated([("coaxial", ("part.a", Point(), FIRST), ("base.pin", PIN, FIRST))])
    with pytest.raises(InputError, match="expected axis on axis, got point on axis"):
        placed(made, np.zeros((1, made.width)))


def test_where_an_assembly_lies_changes_nothing_and_no_trial_another() -> None:
    made, _ = corner()
    rows = np.random.default_rng(10).normal(0, 0.4, (3000, made.width))
    there = posed((0.7, 0.2, -1.4), (-80, 210, 33))
    here, elsewhere = (placed(each, rows)["part"] for each in (made, moved_as_a_whole(made, there)))
    np.testing.assert_allclose(elsewhere, there @ here, atol=1e-12 * 300)
    for row in (0, 1999, 2999):
        np.testing.assert_array_equal(placed(made, rows[row : row + 1])["part"][0], here[row])


def test_contributions_add_up() -> None:
    columns = Columns()
    both: list[Contribution] = [columns(np.eye(3)[:, :1]), columns(np.array([[2.0], [0], [0]]))]
    base = [feature("base.floor", FACE, FLOOR, both)]
    made = assembly(
        columns,
        [part("base", base), part("part", [feature("part.under", FACE, frame((50, 40, 0), (0, 0, -1)))])],
        [Fix("base", "base"), Mate("mate", "part", (Relation("coincident", "part.under", "base.floor"),))],
    )
    np.testing.assert_allclose(placed(made, np.array([[0.1, 0.2]]))["part"][0, :3, 3], (0, 0, 0.5), atol=1e-15)
