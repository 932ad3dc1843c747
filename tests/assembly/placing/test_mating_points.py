"""Parts that are mated by points, to points, axes and planes."""

import numpy as np
import pytest
from assembly.placing.built_by_numbers import frame, seeds
from assembly.placing.mated_parts import FACE, FLOOR, PIN, UNDER, WALL, Side, features_seen, mated
from numpy.typing import NDArray

from tol3d.assembly.model import Point
from tol3d.assembly.placing.method import placed
from tol3d.errors import InputError

Array = NDArray[np.float64]

SPOTS = frame((10, 10, 5)), frame((90, 20, 12)), frame((30, 70, 25))
RELATIONS: dict[str, tuple[str, Side, Side]] = {
    **{
        f"point {k}": ("coincident", (f"part.{k}", Point(), spot), (f"base.{k}", Point(), spot))
        for k, spot in enumerate(SPOTS)
    },
    "floor": ("coincident", ("part.under", FACE, UNDER), ("base.floor", FACE, FLOOR)),
    "pin": ("coincident", ("part.on pin", Point(), SPOTS[0]), ("base.pin", PIN, frame((10, 10, 0)))),
    "wall": ("coincident", ("part.at wall", Point(), frame((0, 70, 15))), ("base.wall", FACE, WALL)),
    "table": ("coincident", ("part.on table", Point(), SPOTS[2]), ("base.table", FACE, SPOTS[2])),
    "oblique": ("coincident", ("part.far", Point(), SPOTS[2]), ("base.oblique", PIN, frame((30, 70, 25), (1, 2, 3)))),
}

Seen = tuple[Array, Array, Array]


def trial(relations: list[str], seed: int) -> list[Seen]:
    """Features of a random trial, relation by relation: its place, its target, and the target's direction."""
    asked = [RELATIONS[name] for name in relations]
    made, slices = mated(asked)
    row = np.random.default_rng(seed).normal(0, 0.3, made.width)
    pose = placed(made, row[None])["part"][0]
    return [
        (pose[:3, :3] @ own[0] + pose[:3, 3], target, direction)
        for own, (target, direction) in features_seen(asked, row, slices)
    ]


@pytest.mark.parametrize("seed", seeds(3))
def test_three_points_on_three_points(seed: int) -> None:
    """The first one lies on its own; the line to the second points to it; the third is as near as a turn brings it."""
    (first, its_first, _), (second, its_second, _), (third, its_third, _) = trial(
        ["point 0", "point 1", "point 2"], seed
    )
    np.testing.assert_allclose(first, its_first, atol=1e-12)
    along = (its_second - first) / np.linalg.norm(its_second - first)
    np.testing.assert_allclose(np.cross(second - first, along), 0, atol=1e-11)
    assert along @ np.cross(third - first, its_third - first) / 60 == pytest.approx(0, abs=1e-11)
    assert (third - first) @ (its_third - first) > 0


@pytest.mark.parametrize("seed", seeds(3))
def test_two_points_then_a_plane(seed: int) -> None:
    """The third point swings about the line of the first two, up or down to the table."""
    seen = trial(["point 0", "point 1", "table"], seed)
    (first, its_first, _), (second, its_second, _), (third, table, normal) = seen
    np.testing.assert_allclose(first, its_first, atol=1e-12)
    np.testing.assert_allclose(np.cross(second - first, its_second - first) / 80, 0, atol=1e-11)
    assert normal @ (third - table) == pytest.approx(0, abs=1e-11)


@pytest.mark.parametrize(
    "start", [("floor", "pin"), ("pin", "floor"), ("floor", "point 0"), ("point 0", "floor")], ids=" ".join
)
@pytest.mark.parametrize("last", ["wall", "point 2", "oblique"])
@pytest.mark.parametrize("seed", seeds(2))
def test_what_a_turn_about_a_place_brings(start: tuple[str, str], last: str, seed: int) -> None:
    """The first is met, the second as far as it is free; the last as nearly as a turn about the normal goes."""
    seen = dict(zip([*start, last], trial([*start, last], seed), strict=True))
    (under, floor, normal), (point, its_target, direction) = seen["floor"], seen[last]
    pivot, target, along = seen["pin" if "pin" in start else "point 0"]
    aside = pivot - target
    if "pin" in start:
        np.testing.assert_allclose(np.cross(aside, along), 0, atol=1e-11)
    elif start[0] == "floor":  # the floor holds its height already
        np.testing.assert_allclose(aside - aside @ normal * normal, 0, atol=1e-11)
    else:
        np.testing.assert_allclose(aside, 0, atol=1e-11)
    if start[0] != "point 0":  # which holds the height already
        assert normal @ (under - floor) == pytest.approx(0, abs=1e-11)
    lacking, motion = point - its_target, np.cross(normal, point - pivot)
    if last == "wall":
        assert direction @ lacking == pytest.approx(0, abs=1e-11)
        return
    if last == "oblique":
        lacking = lacking - lacking @ direction * direction
    assert lacking @ motion / 60 == pytest.approx(0, abs=1e-11)


def test_a_second_point_on_what_holds_the_first_takes_nothing() -> None:
    again: tuple[str, Side, Side] = ("coincident", ("part.x", Point(), SPOTS[0]), ("base.x", Point(), SPOTS[0]))
    made, _ = mated([RELATIONS["floor"], RELATIONS["point 0"], again])
    with pytest.raises(InputError, match=r"part\.x and base\.x takes no freedom"):
        placed(made, np.zeros((1, made.width)))
