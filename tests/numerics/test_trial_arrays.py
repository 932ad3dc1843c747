"""Arrays of trials that belong together: added up, and summed by trial, against sums of numbers one by one."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.arrays import TrialArrays

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Inner(TrialArrays):
    planes: Array


@dataclass(frozen=True)
class Outer(TrialArrays):
    inner: Inner
    lengths: Array


def drawn(seed: int, trials: int) -> Outer:
    rng = np.random.default_rng(seed)
    return Outer(Inner(rng.normal(size=(trials, 3, 2))), rng.normal(size=trials))


def test_one_plus_a_multiple_of_another_is_so_in_every_array() -> None:
    one, two = drawn(1, 4), drawn(2, 4)
    found = one.plus(two, -2.5)
    for trial in range(4):
        assert found.lengths[trial] == one.lengths[trial] - 2.5 * two.lengths[trial]
        for row in range(3):
            for axis in range(2):
                at = trial, row, axis
                assert found.inner.planes[at] == one.inner.planes[at] - 2.5 * two.inner.planes[at]


def test_sums_by_trial_are_those_of_its_values_times_their_weights() -> None:
    """Trial 1 has two values, trial 2 none, as a range whose extremes are both at the first position has none."""
    own, rows, weights = drawn(3, 4), np.array([0, 1, 1, 3]), np.array([1.0, 1.0, -1.0, 0.5])
    found = own.summed(rows, weights, 4)
    for trial in range(4):
        of = [k for k in range(4) if rows[k] == trial]
        assert found.lengths[trial] == sum(weights[k] * own.lengths[k] for k in of)
        np.testing.assert_array_equal(
            found.inner.planes[trial], sum((weights[k] * own.inner.planes[k] for k in of), np.zeros((3, 2)))
        )


def test_no_values_are_sums_of_0_for_all_trials() -> None:
    found = drawn(4, 3)[:0].summed(np.array([], dtype=np.int64), np.array([]), 3)
    assert found.inner.planes.shape == (3, 3, 2)
    assert not found.inner.planes.any()
    assert found.lengths.tolist() == [0.0, 0.0, 0.0]
