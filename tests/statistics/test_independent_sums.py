"""Sums of targets with very many features: each cluster's fit is that of numpy's least squares on it alone."""

from functools import reduce
from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray

from tol3d.statistics.estimates import IndependentSums, independent_shares
from tol3d.statistics.estimates.clusters import Clusters
from tol3d.statistics.estimates.lazy import sparse_products
from tol3d.statistics.estimates.linear_fit import LinearFit

Array = NDArray[np.float64]

CLUSTERS = Clusters(np.array([2, 1, 3, 2, 2, 1]), np.array([7, 4, 2, 4, 1, 0]))
"""Eleven features; parts 1 and 3 depend on each other."""
COLUMNS = [slice(0, 2), slice(2, 3), slice(3, 6), slice(6, 8), slice(8, 10), slice(10, 11)]


def seen(random: np.random.Generator, trials: int) -> tuple[Array, Array]:
    """Features (11, trials) off zero, one of them constant, and two targets."""
    features = random.normal(size=(11, trials)) + np.arange(11)[:, None]
    features[6] += 0.8 * (features[2] - 2.0)
    features[10] = 0.1
    weights = np.array([1.0, 0.3, -2.0, 0.5, 0.0, 0.1, 1.5, 0.0, -0.4, 0.2, 7.0])
    return features, np.stack([weights @ features + random.normal(size=trials), 5.0 - features[0]])


def gathered(features: Array, targets: Array, cuts: list[int]) -> tuple[IndependentSums, ...]:
    edges = [0, *cuts, features.shape[1]]
    blocks = [
        IndependentSums.of_each(
            features[:, a:b], targets[:, a:b], CLUSTERS, [CLUSTERS.all] * len(targets), sparse_products()
        )
        for a, b in pairwise(edges)
    ]
    return tuple(reduce(IndependentSums.merge, own) for own in zip(*blocks, strict=True))


def test_a_part_of_rounding_errors_has_no_effect() -> None:
    random = np.random.default_rng(9)
    features, targets = seen(random, 40)
    features[10] = 1e-16 * random.normal(size=40)
    fit = LinearFit.of(gathered(features, targets, [])[0], COLUMNS)
    assert fit is not None
    assert fit.effects[5] == 0.0


def test_each_cluster_has_the_least_squares_fit_of_its_features_alone() -> None:
    features, targets = seen(np.random.default_rng(1), 400)
    sums = gathered(features, targets, [0, 1, 130, 131])[0]
    fit = LinearFit.of(sums, COLUMNS)
    assert fit is not None
    y = targets[0] - targets[0].mean()
    for cluster in ([0], [1, 3], [2], [4], [5]):
        columns = np.concatenate([np.arange(11)[COLUMNS[part]] for part in cluster])
        x = features[columns] - features[columns].mean(axis=1, keepdims=True)
        expected, *_ = np.linalg.lstsq(x.T, y, rcond=1e-8)
        unknowns = np.linalg.matrix_rank(x, tol=1e-8)
        left = y - expected @ x
        covariance = np.linalg.pinv(x @ x.T, rcond=1e-8) * (left @ left) / (399 - unknowns)
        for part in cluster:
            own, place = next((each, k) for each in fit.fits for k in np.flatnonzero(each.parts == part))
            mine = np.flatnonzero(np.isin(columns, np.arange(11)[COLUMNS[part]]))
            assert own.coefficients[place] == pytest.approx(expected[mine], rel=1e-9, abs=1e-12)
            assert own.covariance[place] == pytest.approx(covariance[np.ix_(mine, mine)], rel=1e-8, abs=1e-14)
            assert fit.effects[part] == pytest.approx((expected[mine] @ x[mine]).std(), rel=1e-9, abs=1e-12)


def test_shares_of_independent_parts_are_those_of_the_variance_without_bias() -> None:
    """Var = 1 + 0.09, 4 + 2.25 and their covariance, 0.26, 0.2 and 1 of noise; 500 blocks of 100 trials."""
    random = np.random.default_rng(2)
    means = np.zeros(6)
    for _ in range(500):
        features, targets = seen(random, 100)
        share, error, _ = independent_shares(gathered(features, targets, [])[0])
        means += share / 500
        assert error[5] == 0.0  # constant
    # parts 1 and 3: y holds -2 x2 + 1.5 x6, x6 = 0.8 x2 + its own, so (1.2 - 2) x2 + 1.5 of its own
    whole = 1.09 + (0.64 + 2.25) + 0.26 + 0.2 + 1.0
    parts = np.array([1.09, -2.0 * -0.8, 0.26, 1.5 * (0.8 * -0.8 + 1.5), 0.2, 0.0]) / whole
    # sigma of a share of 100 trials is 0.1 at most, and 1 / 100 of second order is left of r^2's own bias
    assert np.abs(means - parts).max() < 5 * 0.1 / np.sqrt(500) + 0.01
    assert means[5] == 0.0


def test_a_target_of_one_feature_alone_is_all_its_own_and_others_have_what_chance_gives() -> None:
    features, targets = seen(np.random.default_rng(3), 500)
    share, error, unexplained = independent_shares(gathered(features, targets, [200])[1])
    assert share[0] == pytest.approx(1.0, abs=1e-9)
    assert unexplained == pytest.approx(0.0, abs=0.05)
    assert (np.abs(share[1:]) < 5 * np.maximum(error[1:], 1e-12)).all()


def test_some_of_the_parts_have_the_sums_of_a_block_of_their_own() -> None:
    features, targets = seen(np.random.default_rng(4), 50)
    picked = CLUSTERS.part(np.array([0, 3, 4]))
    (found,) = IndependentSums.of_each(features, targets[:1], CLUSTERS, [picked], sparse_products())
    own = features[[0, 1, 6, 7, 8, 9]]
    alone = Clusters(np.array([2, 2, 2]), np.array([0, 1, 2]))
    (expected,) = IndependentSums.of_each(own, targets[:1], alone, [alone.all], sparse_products())
    for mine, its in ((found.means, expected.means), (found.across, expected.across), (found.within, expected.within)):
        assert mine == pytest.approx(its, rel=1e-12, abs=1e-12)


def test_the_products_of_a_pair_are_the_same_bits_wherever_it_stands() -> None:
    random = np.random.default_rng(5)
    features, targets = random.normal(size=(7, 1300)), random.normal(size=(6, 1300))
    found = sparse_products().cross_products(features, targets)
    assert found == pytest.approx(features @ targets.T, rel=1e-12, abs=1e-11)
    turned = sparse_products().cross_products(features[::-1], targets[2:])
    assert np.array_equal(turned, found[::-1, 2:])


def test_too_few_trials_and_constant_targets_say_nothing() -> None:
    features, targets = seen(np.random.default_rng(6), 40)
    share, _, left = independent_shares(gathered(features[:, :4], targets[:, :4], [])[0])
    assert np.isnan(share).all()
    assert np.isnan(left)
    still, _, none = independent_shares(gathered(features, np.full((1, 40), 3.3), [7])[0])
    assert not still.any()
    assert none == 0.0
    assert LinearFit.of(gathered(features[:, :30], targets[:, :30], [])[0], COLUMNS) is None
