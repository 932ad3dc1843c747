"""Ends of a deviation where slopes at the mean tell its direction, and where they do not."""

from functools import partial

import numpy as np
import pytest
from numpy.typing import NDArray

from tol3d.assembly.zones.catalogue import axis
from tol3d.statistics.distributions.uniform import Uniform
from tol3d.study.system.draw import Each
from tol3d.study.system.steepest import along, steepest_ends

Array = NDArray[np.float64]

RADIUS = 2.0
FURTHEST = partial(along, RADIUS)


def ends_of(matrix: list[list[float]], offset: list[float]) -> Array:
    """Ends over a ball, of the size of matrix · x + offset."""
    lines, place = np.array(matrix), np.array(offset)
    count = lines.shape[1]
    return steepest_ends(
        lambda rows: np.linalg.norm(rows @ lines.T + place, axis=1), np.zeros(count), np.full(count, RADIUS), FURTHEST
    )


def test_a_linear_measure_has_one_pair_along_its_slopes() -> None:
    slopes = np.array([3.0, 4.0])
    ends = steepest_ends(lambda rows: rows @ slopes + 7.0, np.array([1.0, 5.0]), np.array([0.5, 2.0]), FURTHEST)
    np.testing.assert_allclose(ends, [[1.2, 1.6], [-1.2, -1.6]], atol=1e-14)


def test_the_size_of_a_vector_is_followed_across_its_axes_and_in_all_directions() -> None:
    """By (x + y) it grows by 5 times sqrt 2 a unit, by z by 1: slopes at 0 are none."""
    ends = ends_of([[5.0, 5.0, 0.0], [0.0, 0.0, 1.0]], [0.0, 0.0])
    assert ends.shape == (6, 3)
    np.testing.assert_allclose(np.abs(ends[0]), RADIUS * np.array([0.5, 0.5, 0.0]) ** 0.5, atol=1e-14)
    np.testing.assert_allclose(ends[1::2], -ends[::2], atol=1e-14)
    grown = np.linalg.norm(ends[::2] @ [[5.0, 0.0], [5.0, 0.0], [0.0, 1.0]], axis=1)
    assert float((grown**2).sum()) == pytest.approx(RADIUS**2 * (50.0 + 1.0))  # whatever the directions


def test_a_vector_that_is_off_already_is_looked_at_across_too() -> None:
    """Off by 10 along x: it grows by x at once, by y with the square."""
    ends = ends_of([[1.0, 0.0], [0.0, 3.0]], [10.0, 0.0])
    np.testing.assert_allclose(np.abs(ends), RADIUS * np.array([[1, 0], [1, 0], [0, 1], [0, 1]]), atol=1e-14)


def test_what_fails_beside_the_mean_has_no_ends() -> None:
    ends = steepest_ends(lambda rows: np.where(rows[:, 0] > 0, np.nan, 1.0), np.zeros(2), np.ones(2), FURTHEST)
    assert np.isnan(ends).all()


@pytest.mark.parametrize("noise", [0.0, 1e-12, -1e-12])
def test_rounding_decides_no_direction(noise: float) -> None:
    """Two features alike, the size of whose sum is read: the first is looked at, whichever comes out larger."""
    rounding = noise * np.array([1.0, -2.0, 3.0, -1.0])

    def size(rows: Array) -> Array:
        return np.hypot(rows[:, 0] + rows[:, 2], rows[:, 1] + rows[:, 3]) + rows @ rounding

    ends = steepest_ends(size, np.zeros(4), np.full(4, RADIUS), FURTHEST)
    np.testing.assert_allclose(ends[0], RADIUS * np.array([0.5, 0.0, 0.5, 0.0]) ** 0.5, atol=1e-9)


@pytest.mark.parametrize("noise", [0.0, 1e-12, -1e-12])
def test_of_several_features_that_act_alike_to_both_sides_each_is_looked_at(noise: float) -> None:
    """Their effects by size are found, not the direction of rounding; a sum has one pair as ever."""
    draw = Each(Uniform(-2.0, 2.0), ("a", "b", "c"))
    factors, rounding = np.array([1.0, 3.0, 0.5]), noise * np.array([1.0, -1.0, 2.0])
    ends = draw.ends(lambda rows: np.abs(rows) @ factors + rows @ rounding, turning=False)
    grown = np.abs(ends) @ factors
    assert sorted(grown.tolist()) == pytest.approx([1.0, 1.0, 2.0, 2.0, 6.0, 6.0])
    np.testing.assert_allclose(ends.sum(axis=0), 0.0, atol=1e-14)
    together = draw.ends(lambda rows: rows @ factors + rows @ rounding, turning=False)
    np.testing.assert_allclose(together[0], 2.0 * factors / np.linalg.norm(factors), atol=1e-9)


@pytest.mark.parametrize("noise", [0.0, 1e-12, -1e-12])
def test_each_component_of_an_axis_is_looked_at_by_itself(noise: float) -> None:
    """A zone of diameter 4, each of whose coordinates grows by its own factor to both sides."""
    factors, rounding = np.array([1.0, 3.0, 0.5, 2.0]), noise * np.array([1.0, -2.0, 3.0, -1.0])
    ends = steepest_ends(
        lambda rows: np.abs(rows) @ factors + rows @ rounding, np.zeros(4), np.full(4, RADIUS), axis(4.0).furthest
    )
    grown = np.abs(ends) @ factors
    assert sorted(grown.tolist()) == pytest.approx([1.0, 1.0, 2.0, 2.0, 4.0, 4.0, 6.0, 6.0])


def test_an_end_of_an_axis_that_does_not_matter_follows_the_other_only_as_far_as_it_must() -> None:
    np.testing.assert_allclose(axis(4.0, 1.6).furthest(np.array([0.0, 0.0, 1.0, 0.0])), [0.4, 0.0, 2.0, 0.0])
