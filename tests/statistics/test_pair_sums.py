"""Correlations gathered block by block are numpy's of the whole, pair by pair, whatever values trials lack."""

import itertools
from collections.abc import Sequence

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import stats

from tol3d.statistics.estimates import PairSums
from tol3d.statistics.estimates.lazy import quick_products
from tol3d.statistics.estimates.variance_shares import Products, RegressorSums, plain_products

Array = NDArray[np.float64]

CUTS = (0, 1, 400, 3000, 5000)  # where blocks begin, and their end; one has a single trial
ROUNDING = 1e-11  # of r: sums of 5000 products of order one, each rounded by 1e-16


def gathered(columns: Array, products: Products = plain_products) -> PairSums:
    first, *others = (PairSums.of([*columns[:, a:b]], products) for a, b in itertools.pairwise(CUTS))
    for other in others:
        first = first.merge(other)
    return first


def mixed(seed: int) -> Array:
    """Six columns of which some share what they are made of."""
    rng = np.random.default_rng(seed)
    own = rng.normal(size=(6, CUTS[-1]))
    own[1] += own[0]
    own[2] -= 2 * own[0]
    own[3] += rng.exponential(size=CUTS[-1]) * own[1]
    return np.asarray(
        own * [[1.0], [50.0], [1e-3], [7.0], [1.0], [300.0]] + [[0.0], [1e4], [3.0], [-50.0], [0.1], [1e6]]
    )


def lacking(columns: Array, how: str) -> Array:
    """The same, trials without some of their values."""
    rng, found = np.random.default_rng(3), columns.copy()
    if how == "alike":
        found[:, rng.random(found.shape[1]) < 0.3] = np.nan
    elif how == "one":
        found[2, found[0] > 0.5] = np.nan  # those that fail are others than those that do not
    elif how == "each its own way":
        found[rng.random(found.shape) < 0.2] = np.nan
    elif how == "never together":
        found[0, ::2] = found[1, 1::2] = np.nan
    elif how == "never":
        found[4] = np.nan
    return found


@pytest.mark.parametrize("products", [plain_products, quick_products()], ids=["plain", "compiled"])
@pytest.mark.parametrize("how", ["none", "alike", "one", "each its own way", "never together", "never"])
def test_each_pair_is_numpys_over_the_trials_that_have_both(how: str, products: Products) -> None:
    columns = lacking(mixed(1), how)
    sums = gathered(columns, products)
    r = sums.correlations
    for i, j in itertools.product(range(6), repeat=2):
        both = ~np.isnan(columns[i]) & ~np.isnan(columns[j])
        assert sums.counts[i, j] == np.count_nonzero(both)
        if not both.any():
            assert np.isnan(r[i, j])
            continue
        expected = np.corrcoef(columns[i, both], columns[j, both])[0, 1]
        assert r[i, j] == pytest.approx(expected, abs=ROUNDING)
        assert sums.means[i, j] == pytest.approx(columns[i, both].mean(), rel=1e-12, abs=1e-12)
        assert sums.squares[i, j] == pytest.approx(columns[i, both].var() * both.sum(), rel=1e-9)
    np.testing.assert_array_equal(r, r.T)
    known = np.diagonal(sums.counts) > 1
    np.testing.assert_array_equal(np.diagonal(r)[known], 1.0)


def test_a_spread_far_from_zero_keeps_its_digits() -> None:
    """A millionth of the mean: sums of plain products would have no digit left of it."""
    rng = np.random.default_rng(5)
    small = rng.normal(size=(2, CUTS[-1]))
    small[1] = np.round(0.6 * small[0] + 0.8 * small[1], 3)
    small[0] = np.round(small[0], 3)
    far = 2.0**30 + small  # a thousandth is 2e-7 of a unit off at most there
    expected = np.corrcoef(*small)[0, 1]
    assert gathered(far).correlations[0, 1] == pytest.approx(expected, abs=1e-6)


def test_a_pair_whose_trials_lie_close_together_is_summed_by_itself() -> None:
    """Both are known only in trials that lie within 1e-5 about 100 of column 0, whose others are about 0."""
    rng = np.random.default_rng(7)
    x, y = rng.normal(size=(2, CUTS[-1]))
    near = rng.random(CUTS[-1]) < 0.1
    x[near] = 100.0 + np.round(1e-5 * x[near], 10)
    y[~near] = np.nan
    expected = np.corrcoef(x[near] - 100.0, y[near])[0, 1]
    assert gathered(np.stack([x, y])).correlations[0, 1] == pytest.approx(expected, abs=1e-7)  # 1e-14/1e-5 a value
    x[near] = 0.1
    constant = gathered(np.stack([x, y]))
    assert np.isnan(constant.correlations[0, 1])
    assert constant.correlations[0, 0] == 1.0


def test_constant_columns_and_single_trials_have_no_correlation() -> None:
    columns = np.stack([np.full(CUTS[-1], 0.1), np.arange(CUTS[-1]) / 3])
    np.testing.assert_array_equal(gathered(columns).correlations, [[np.nan, np.nan], [np.nan, 1.0]])
    alone = PairSums.of([np.array([1.0]), np.array([2.0])])
    assert np.isnan(alone.correlations).all()
    none = PairSums.of([np.zeros(0), np.zeros(0)])
    assert np.isnan(none.correlations).all()
    np.testing.assert_array_equal(none.merge(alone).means, alone.means)


def test_the_interval_is_that_of_scipy() -> None:
    columns = mixed(2)
    sums = gathered(columns)
    low, high = sums.interval()
    for i, j in itertools.combinations(range(6), 2):
        own = stats.pearsonr(columns[i], columns[j]).confidence_interval(0.95)
        assert (low[i, j], high[i, j]) == pytest.approx((own.low, own.high), abs=ROUNDING)
    assert (low[0, 0], high[0, 0]) == (1.0, 1.0)
    few, _ = PairSums.of([*columns[:, :3]]).interval()
    assert np.isnan(few).all()


def test_the_interval_holds_the_truth_in_95_of_100_samples() -> None:
    rng, truth, samples = np.random.default_rng(9), -0.6, 2000
    held = 0
    for _ in range(samples):
        x, noise = rng.normal(size=(2, 40))
        low, high = PairSums.of([x, truth * x + 0.8 * noise]).interval()
        held += bool(low[0, 1] <= truth <= high[0, 1])
    assert abs(held / samples - 0.95) < 5 * np.sqrt(0.95 * 0.05 / samples)


@pytest.mark.parametrize("products", [plain_products, quick_products()], ids=["plain", "compiled"])
@pytest.mark.parametrize("groups", [[range(6)], [range(1, 3), range(3, 6), range(1)], [[k] for k in range(6)]])
def test_sums_that_come_of_a_regression_are_those_of_the_columns(
    groups: list[Sequence[int]], products: Products
) -> None:
    """To the last bit where they are compiled; numpy's follow a pair's place among the rows, so to rounding."""
    columns = np.concatenate([mixed(seed) for seed in range(11, 15)], axis=1)
    features = np.random.default_rng(12).normal(size=(3, columns.shape[1]))
    every = np.arange(len(features))
    known = [RegressorSums.with_targets(features, columns[[*own]], products, [every] * len(own))[1] for own in groups]
    ordered = [k for own in groups for k in own]
    found = PairSums.of([*columns[ordered]], products, known).of_columns([ordered.index(k) for k in range(6)])
    expected = PairSums.of([*columns], products)
    for key in ("counts", "means", "squares", "comoments"):
        mine, its = getattr(found, key), getattr(expected, key)
        if products is plain_products and key in ("squares", "comoments"):
            sigma = np.sqrt(np.diagonal(expected.squares))
            np.testing.assert_allclose(mine / sigma, its / sigma, rtol=ROUNDING, atol=ROUNDING * sigma.max())
        else:
            np.testing.assert_array_equal(mine, its)
    np.testing.assert_allclose(found.correlations, np.corrcoef(columns), rtol=0, atol=ROUNDING)
