"""Estimates against scipy and numpy on whole arrays, against closed forms, and their errors against repetition."""

import math
from functools import reduce

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from hypothesis.extra import numpy as nps
from numpy.typing import NDArray
from scipy import stats

from tol3d.statistics.estimates import (
    Agreement,
    Grid,
    LimitCounts,
    Moments,
    Proportion,
    RegressorSums,
    equivalent_ppk,
    pp,
    ppk,
    shares,
)

Array = NDArray[np.float64]

values_of = nps.arrays(np.float64, st.integers(1, 60), elements=st.floats(-100, 100))
cuts_of = st.lists(st.integers(0, 60), max_size=5).map(sorted)


def blocks(values: Array, cuts: list[int]) -> list[Array]:
    return np.split(values, [min(cut, len(values)) for cut in cuts])


# moments ----------------------------------------------------------------------------------------


@given(values_of, cuts_of)
def test_moments_of_blocks_merge_to_those_of_the_whole(values: Array, cuts: list[int]) -> None:
    merged = reduce(Moments.merge, (Moments.of(block) for block in blocks(values, cuts)))
    deviation = values - np.mean(values)
    reach = float(np.max(np.abs(values)))  # rounding of a sum of 60 values: 60 * 1e-16 * reach^k, tenfold
    finest = 5e-324  # between doubles near 0, where rounding is no share of them
    assert (merged.count, merged.minimum, merged.maximum) == (len(values), np.min(values), np.max(values))
    assert merged.mean == pytest.approx(np.mean(values), abs=1e-14 * reach + finest)
    for power, sum_of_powers in ((2, merged.m2), (3, merged.m3), (4, merged.m4)):
        assert sum_of_powers == pytest.approx(np.sum(deviation**power), rel=1e-11, abs=1e-12 * (2 * reach) ** power)


def test_moments_equal_scipy_far_from_zero() -> None:
    values = np.random.default_rng(1).gamma(2.0, 0.01, 5000) + 172.5
    merged = reduce(Moments.merge, (Moments.of(block) for block in np.array_split(values, 7)))
    # 172.5 of spread 0.014: a double leaves 2e-12 of the spread, times the power
    assert merged.sigma == pytest.approx(np.std(values, ddof=1), rel=1e-11)
    assert merged.skewness == pytest.approx(stats.skew(values), rel=1e-10)
    assert merged.excess_kurtosis == pytest.approx(stats.kurtosis(values), rel=1e-10)
    assert merged.mean_se == pytest.approx(stats.sem(values), rel=1e-11)


def test_a_constant_sample_has_exactly_no_spread() -> None:
    merged = Moments.of(np.full(1001, 0.1)).merge(Moments.of(np.full(77, 0.1)))
    assert (merged.mean, merged.sigma, merged.m4) == (0.1, 0.0, 0.0)
    assert math.isnan(merged.skewness)
    assert math.isnan(merged.excess_kurtosis)
    assert math.isnan(merged.sigma_se)


def test_an_empty_sample_merges_as_nothing() -> None:
    some = Moments.of(np.array([1.0, 4.0]))
    assert Moments().merge(some) == some == some.merge(Moments.of(np.empty(0)))
    assert math.isnan(Moments().sigma)
    assert math.isnan(Moments().mean_se)
    assert math.isnan(Moments.of(np.array([3.0])).sigma)


def test_a_nan_is_not_hidden() -> None:
    assert math.isnan(Moments.of(np.array([1.0, math.nan, 2.0])).merge(Moments.of(np.array([1.0]))).mean)


def test_bits_of_a_block_do_not_depend_on_its_memory_layout() -> None:
    table = np.random.default_rng(2).normal(size=(4097, 5))
    assert Moments.of(table[:, 3]) == Moments.of(table[:, 3].copy())
    by_row, by_column = (RegressorSums.of(t[:, :4], t[:, 4]) for t in (table, np.asfortranarray(table)))
    np.testing.assert_array_equal(by_row.comoments, by_column.comoments)
    np.testing.assert_array_equal(by_row.means, by_column.means)


@pytest.mark.parametrize("law", [stats.norm, stats.uniform, stats.expon, stats.rayleigh])
def test_sigma_se_is_the_spread_of_sigma_over_repeated_samples(law: stats.rv_continuous) -> None:
    repeats, n = 3000, 400
    samples = law.rvs(size=(repeats, n), random_state=np.random.default_rng(3))
    moments = [Moments.of(sample) for sample in samples]
    spread = np.std([m.sigma for m in moments])
    # 4 standard errors of a standard deviation of 3000 (5 %), and the bias of order 1/n of a heavy fourth moment
    assert np.mean([m.sigma_se for m in moments]) == pytest.approx(spread, rel=4 / math.sqrt(2 * repeats) + 10 / n)


def test_sigma_se_of_a_normal_is_sigma_over_root_2n() -> None:
    n = 100_000
    moments = Moments.of(np.random.default_rng(4).normal(0, 3, n))
    # relative error of the fourth moment's estimate: sqrt(96 - ...)/3 / sqrt(n), halved: 4 errors = 2 %
    assert moments.sigma_se == pytest.approx(3 / math.sqrt(2 * n), rel=0.02)


# grid -------------------------------------------------------------------------------------------


@given(values_of, st.floats(0.001, 0.999))
def test_quantile_is_within_a_bin_of_the_order_statistic(values: Array, p: float) -> None:
    grid = Grid.empty(-101.0, 202 / 500, 500).add(values)
    exact = np.sort(values)[math.ceil(p * len(values)) - 1]
    quantile = grid.quantile(p)
    assert quantile is not None
    assert abs(quantile - exact) <= grid.width * (1 + 1e-12)


@given(values_of, cuts_of)
def test_grids_of_blocks_add_up_to_that_of_the_whole(values: Array, cuts: list[int]) -> None:
    empty = Grid.empty(-50.0, 120 / 64, 64)
    whole = empty.add(values)
    parts = [empty.add(block) for block in blocks(values, cuts)]
    for merged in (reduce(Grid.merge, parts), reduce(Grid.merge, reversed(parts))):
        np.testing.assert_array_equal(merged.counts, whole.counts)
        assert (merged.underflow, merged.overflow) == (whole.underflow, whole.overflow)
    assert whole.total == len(values)
    assert whole.underflow == np.sum(values < -50.0)
    # numpy.histogram closes its last bin, this grid does not
    inside = values[values < 70.0]
    oracle = np.histogram(inside, bins=64, range=(-50.0, 70.0))[0]
    assert np.max(np.abs(np.cumsum(whole.counts) - np.cumsum(oracle))) <= np.sum(on_an_edge(inside))


def on_an_edge(values: Array) -> NDArray[np.bool_]:
    """Values within rounding of an edge of that grid, which two computations may put on either side."""
    position = (values + 50.0) / 120.0 * 64
    return np.abs(position - np.round(position)) < 1e-9


def test_quantile_is_linear_inside_a_bin() -> None:
    grid = Grid.empty(0.0, 1.0, 10).add(np.array([2.0, 2.5, 2.9, 2.1, 7.5, 7.6]))
    assert grid.quantile(1 / 6) == pytest.approx(2.25)
    assert grid.quantile(4 / 6) == pytest.approx(3.0)
    assert grid.quantile(5 / 6) == pytest.approx(7.5)


def test_quantile_of_a_normal_sample() -> None:
    values = np.random.default_rng(6).normal(size=200_000)
    grid = Grid.empty(-20.0, 40 / 2**17).add(values)
    for p in (0.00135, 0.5, 0.99865):
        assert grid.quantile(p) == pytest.approx(np.quantile(values, p, method="inverted_cdf"), abs=grid.width)


def test_a_quantile_outside_the_grid_is_none() -> None:
    grid = Grid.empty(0.0, 0.25, 4).add(np.array([-3.0, 0.1, 0.2, math.inf]))
    assert (grid.underflow, grid.overflow, grid.total) == (1, 1, 4)
    assert grid.quantile(0.2) is None
    assert grid.quantile(0.8) is None
    assert grid.quantile(0.5) == pytest.approx(0.125)
    assert Grid.empty(0.0, 0.25, 4).quantile(0.5) is None


def test_values_at_edges_fall_into_the_bin_they_open() -> None:
    grid = Grid.empty(0.0, 1.0, 4).add(np.array([0.0, 1.0, 3.0, 4.0]))
    np.testing.assert_array_equal(grid.counts, [1, 1, 0, 1])
    assert grid.overflow == 1


def test_a_grid_refuses_what_it_cannot_count() -> None:
    grid = Grid.empty(0.0, 0.25, 4)
    with pytest.raises(ValueError, match="NaN"):
        grid.add(np.array([0.5, math.nan]))
    with pytest.raises(ValueError, match="same grid"):
        grid.merge(Grid.empty(0.0, 0.5, 4))
    for lower, width in ((1.0, 0.0), (2.0, -1.0), (1.0, 1e-17), (0.0, math.inf), (0.0, math.nan)):
        with pytest.raises(ValueError, match="no width"):
            Grid.empty(lower, width, 100)


@given(values_of, st.integers(1, 30))
def test_a_histogram_keeps_every_value_and_its_place(values: Array, bins: int) -> None:
    grid = Grid.empty(-101.0, 0.202, 1000).add(values)
    picture = grid.histogram(bins)
    assert len(picture.counts) <= bins
    assert len(picture.edges) == len(picture.counts) + 1
    assert picture.counts.sum() == len(values)
    slack = 1e-9  # of rounding at an edge
    for edge, below in zip(picture.edges, np.concatenate([[0], np.cumsum(picture.counts)]), strict=True):
        assert np.sum(values < edge - slack) <= below <= np.sum(values < edge + slack)


def test_histograms_over_one_span_share_their_edges() -> None:
    random = np.random.default_rng(8)
    empty = Grid.empty(-10.0, 0.005, 4000)
    one, other = empty.add(random.normal(0, 1, 500)), empty.add(random.normal(0.3, 1.2, 500))
    span = (-2.0013, 3.1)
    picture, beside = one.histogram(40, span), other.histogram(40, span)
    np.testing.assert_array_equal(picture.edges, beside.edges)
    assert span[0] - empty.width <= picture.edges[0] <= span[0]
    assert span[1] <= picture.edges[-1] <= span[1] + 40 * empty.width
    assert len(one.histogram(40, (-99.0, 99.0)).counts) == 40
    assert one.histogram(40, (50.0, 60.0)).counts.sum() == 0


# limits -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(("count", "total"), [(0, 2000), (3, 2000), (999, 1000), (1000, 1000), (1, 1), (270, 10**7)])
def test_interval_is_that_of_clopper_and_pearson(count: int, total: int) -> None:
    oracle = stats.binomtest(count, total).proportion_ci(0.95, method="exact")
    low, high = Proportion(count, total).interval_ppm()
    assert (low / 1e6, high / 1e6) == pytest.approx((oracle.low, oracle.high), rel=1e-8)


def test_interval_of_none_in_n_has_its_closed_form() -> None:
    low, high = Proportion(0, 2000).interval_ppm(0.95)
    assert low == 0.0
    assert high == pytest.approx(1e6 * (1 - 0.025 ** (1 / 2000)), rel=1e-12)


def test_no_trials_say_nothing() -> None:
    assert Proportion(0, 0).ppm is None
    assert Proportion(0, 0).interval_ppm() == (0.0, 1e6)


def test_interval_covers_the_truth_as_often_as_it_says() -> None:
    p, n = 0.004, 500
    counts = np.arange(n + 1)
    covered = [low <= 1e6 * p <= high for low, high in (Proportion(int(k), n).interval_ppm() for k in counts[:40])]
    # k >= 40 at a mean of 2 has no weight; the sum over all k is exact, no sampling
    assert stats.binom(n, p).pmf(counts[:40]) @ np.array(covered) >= 0.95


@given(values_of, cuts_of, st.floats(-50, 50), st.floats(0, 50))
def test_limit_counts_merge_and_keep_failures_apart(values: Array, cuts: list[int], lower: float, width: float) -> None:
    upper = lower + width
    values = np.where(values > 90, math.nan, values)
    parts = [LimitCounts.of(block, lower, upper) for block in blocks(values, cuts)]
    merged = reduce(LimitCounts.merge, parts)
    assert merged == LimitCounts.of(values, lower, upper)
    good = [value for value in values if not math.isnan(value)]
    assert merged.below_limit == Proportion(sum(value < lower for value in good), len(values))
    assert merged.above_limit == Proportion(sum(value > upper for value in good), len(values))
    assert merged.failures == Proportion(len(values) - len(good), len(values))
    inside = sum(lower <= value <= upper for value in good)
    assert merged.out_of_limits == Proportion(len(values) - inside, len(values))


def test_a_value_at_a_limit_is_within_it() -> None:
    values = np.array([2.0, 5.0, 8.0, np.nextafter(2.0, 0.0), np.nextafter(8.0, 9.0)])
    assert LimitCounts.of(values, 2.0, 8.0) == LimitCounts(good=5, failed=0, below=1, above=1, out=2)


def test_without_a_limit_nothing_is_outside_but_what_failed() -> None:
    counts = LimitCounts.of(np.array([-1e9, 1e9, math.nan]), None, None, np.array([False, False, True]))
    assert (counts.below, counts.above, counts.good, counts.failed, counts.out) == (0, 0, 2, 1, 1)


def test_trials_that_lack_what_is_measured_are_below_a_lower_limit_and_out_of_any() -> None:
    """One of five trials is within 2 and 8, one below, one above, one is jammed and one was not measured."""
    values, lacking = np.array([5.0, 1.0, 9.0, math.nan, math.nan]), np.array([False, False, False, True, False])
    assert LimitCounts.of(values, 2.0, 8.0, lacking) == LimitCounts(good=3, failed=2, below=2, above=1, out=4)
    assert LimitCounts.of(values, None, 8.0, lacking) == LimitCounts(good=3, failed=2, below=0, above=1, out=3)
    assert LimitCounts.of(values, 2.0, None, lacking) == LimitCounts(good=3, failed=2, below=2, above=0, out=3)


def test_a_curve_below_one_limit_and_above_the_other_is_out_once() -> None:
    counts = LimitCounts.of_spans(np.array([1.0, 3.0]), np.array([9.0, 4.0]), 2.0, 8.0)
    assert (counts.below, counts.above, counts.out) == (1, 1, 1)


def test_the_equivalent_ppk_of_a_share_is_that_of_a_normal_with_as_much_out_on_one_side() -> None:
    for index in (1.33, 1.0, 0.3, -0.2):
        out = Proportion(round(1e9 * stats.norm.sf(3 * index)), 10**9)
        assert equivalent_ppk(out) == pytest.approx(index, abs=1e-5)
    assert equivalent_ppk(Proportion(0, 2000)) == pytest.approx(stats.norm.isf(0.5 / 2000) / 3)
    assert equivalent_ppk(Proportion(2000, 2000)) == pytest.approx(-stats.norm.isf(0.5 / 2000) / 3)
    assert equivalent_ppk(Proportion(0, 0)) is None


def test_performance_indices() -> None:
    # a process of sigma 1 centred between limits at +-4 sigma has 4/3 for both, and by one sigma off 1 for ppk
    assert pp(-4.0, 4.0, 1.0) == pytest.approx(4 / 3)
    assert ppk(-4.0, 4.0, 0.0, 1.0) == pytest.approx(4 / 3)
    assert ppk(-4.0, 4.0, 1.0, 1.0) == pytest.approx(1.0)
    assert ppk(-4.0, 4.0, -1.0, 1.0) == pytest.approx(1.0)
    assert ppk(15.0, None, 53.0, 7.0) == pytest.approx(38 / 21)
    assert ppk(None, 15.0, 53.0, 7.0) == pytest.approx(-38 / 21)
    assert pp(15.0, None, 7.0) is None
    assert ppk(None, None, 53.0, 7.0) is None
    assert pp(0.0, 1.0, 0.0) is None
    assert ppk(0.0, 1.0, 0.5, 0.0) is None


# shares -----------------------------------------------------------------------------------------


@given(nps.arrays(np.float64, st.tuples(st.integers(1, 30), st.just(3)), elements=st.floats(-10, 10)), cuts_of)
def test_feature_sums_of_blocks_merge_to_those_of_the_whole(rows: Array, cuts: list[int]) -> None:
    merged = reduce(RegressorSums.merge, (RegressorSums.of(block[:, :2], block[:, 2]) for block in blocks(rows, cuts)))
    deviations = rows - rows.mean(axis=0)
    assert merged.count == len(rows)
    np.testing.assert_allclose(merged.means, rows.mean(axis=0), rtol=0, atol=1e-13)
    np.testing.assert_allclose(merged.comoments, deviations.T @ deviations, rtol=0, atol=1e-10)


def test_another_feature_leaves_the_sums_of_the_others_as_they_were() -> None:
    x, y = np.random.default_rng(9).normal(size=(5000, 6)), np.random.default_rng(10).normal(size=5000)
    seen, without = RegressorSums.of(x, y).comoments, RegressorSums.of(x[:, :4], y).comoments
    np.testing.assert_array_equal(seen[np.ix_([0, 1, 2, 3, -1], [0, 1, 2, 3, -1])], without)


def test_shares_are_those_of_least_squares_on_the_whole_sample() -> None:
    random, n = np.random.default_rng(10), 3000
    x = random.normal(5.0, 2.0, size=(n, 4))
    y = 3 * x[:, 0] - x[:, 1] + 0.5 * x[:, 2] ** 2 + np.sin(x[:, 3]) + random.normal(0, 0.3, n)
    features = np.column_stack([x[:, 0], x[:, 1], x[:, 2], x[:, 2] ** 2, x[:, 3]])
    parts = zip(np.array_split(features, 5), np.array_split(y, 5), strict=True)
    groups = {"a": slice(0, 1), "b": slice(1, 2), "c": slice(2, 4), "d": slice(4, 5)}
    result = shares(reduce(RegressorSums.merge, (RegressorSums.of(*part) for part in parts)), groups)
    fit = np.linalg.lstsq(np.column_stack([np.ones(n), features]), y, rcond=None)[0][1:]
    for name, group in groups.items():
        part = features[:, group] @ fit[group]
        # x and x^2 are correlated by 0.98, which costs two digits
        assert result.share[name] == pytest.approx(np.cov(part, y)[0, 1] / np.var(y, ddof=1), abs=1e-10)
    assert result.unexplained + sum(result.share.values()) == pytest.approx(1, abs=1e-12)


def test_shares_of_a_quadratic_law_tend_to_its_closed_form() -> None:
    random, n = np.random.default_rng(11), 50_000
    x, z = random.normal(size=(2, n))
    sums = RegressorSums.of(np.column_stack([x, x**2, z]), 2 * x + x**2 + z)
    result = shares(sums, {"x": slice(0, 2), "z": slice(2, 3)})
    # var(2x) = 4, var(x^2) = 2, var(z) = 1; 4 errors of a share, tails of x^2 doubling them
    assert result.share["x"] == pytest.approx(6 / 7, abs=8 * math.sqrt(6 / 49 / n))
    assert result.share["z"] == pytest.approx(1 / 7, abs=8 * math.sqrt(6 / 49 / n))
    assert result.unexplained == pytest.approx(0, abs=1e-10)


@pytest.mark.parametrize("noise", [0.0, 0.2, 1.0])
def test_share_error_is_the_spread_of_shares_over_repeated_samples(noise: float) -> None:
    repeats, n, coefficients = 2000, 500, np.array([0.8, 0.5, 0.3])
    random = np.random.default_rng(12)
    groups = {"a": slice(0, 1), "b": slice(1, 2), "c": slice(2, 3)}
    results = []
    for _ in range(repeats):
        x = random.normal(size=(n, 3))
        results.append(shares(RegressorSums.of(x, x @ coefficients + noise * random.normal(size=n)), groups))
    for name in groups:
        spread = np.std([result.share[name] for result in results])
        stated = np.mean([result.standard_error[name] for result in results])
        # 4 errors of a standard deviation of 2000 (6.3 %), and terms of order 1/n in small shares (5 %)
        assert stated == pytest.approx(spread, rel=0.115)


def test_share_error_of_one_contributor_is_that_of_a_squared_correlation() -> None:
    random, n = np.random.default_rng(13), 2000
    x = random.normal(size=n)
    y = x + random.normal(size=n)
    result = shares(RegressorSums.of(x[:, None], y), {"x": slice(0, 1)})
    r = np.corrcoef(x, y)[0, 1]
    assert result.share["x"] == pytest.approx(r**2, rel=1e-12)
    assert result.standard_error["x"] == pytest.approx(2 * r * (1 - r**2) / math.sqrt(n), rel=1e-12)


def test_constant_features_have_no_share() -> None:
    random = np.random.default_rng(14)
    x = random.normal(size=1000)
    noise_of_rounding = 172.5 + np.spacing(172.5) * random.integers(0, 2, 1000)
    sums = RegressorSums.of(np.column_stack([x, np.full(1000, 0.1), noise_of_rounding]), 2 * x)
    result = shares(sums, {"x": slice(0, 1), "constant": slice(1, 2), "rounding": slice(2, 3)})
    assert result.share["x"] == pytest.approx(1, abs=1e-12)
    assert (result.share["constant"], result.share["rounding"]) == (0.0, 0.0)
    about_zero = 1e-16 * random.normal(size=(40, 12))  # parts that are none by theory: they explain 12 of 40 by chance
    y = x[:40] + random.normal(size=40)
    both = shares(RegressorSums.of(np.column_stack([x[:40], about_zero]), y), {"x": slice(0, 1), "0": slice(1, 13)})
    alone = shares(RegressorSums.of(x[:40, None], y), {"x": slice(0, 1)})
    assert (both.share["x"], both.share["0"]) == (alone.share["x"], 0.0)
    nothing = shares(sums, {"constant": slice(1, 2)})
    assert (nothing.share["constant"], nothing.unexplained) == (0.0, 1.0)


def test_features_that_say_the_same_share_alike() -> None:
    x, z = np.random.default_rng(15).normal(size=(2, 1000))
    sums = RegressorSums.of(np.column_stack([x, 3 * x - 7, z]), x + z)
    twice = shares(sums, {"x": slice(0, 1), "same": slice(1, 2), "z": slice(2, 3)}).share
    once = shares(sums, {"x": slice(0, 1), "z": slice(2, 3)}).share
    assert twice["x"] == pytest.approx(once["x"] / 2, abs=1e-10)
    assert twice["same"] == pytest.approx(once["x"] / 2, abs=1e-10)
    assert twice["z"] == pytest.approx(once["z"], abs=1e-10)


def test_a_constant_target_and_too_few_trials_are_said() -> None:
    x, groups = np.random.default_rng(16).normal(size=(100, 1)), {"x": slice(0, 1)}
    still = shares(RegressorSums.of(x, np.full(100, 5.0)), groups)
    assert (still.share["x"], still.standard_error["x"], still.unexplained) == (0.0, 0.0, 0.0)
    for trials in (0, 1, 2):
        few = shares(RegressorSums.of(x[:trials], x[:trials, 0]), groups)
        assert math.isnan(few.share["x"])
        assert math.isnan(few.unexplained)
    enough = shares(RegressorSums.of(x[:3], x[:3, 0]), groups)
    assert enough.share["x"] == pytest.approx(1.0, rel=1e-12)


@given(st.floats(1e-6, 1e6), st.floats(1e-6, 1e6), st.floats(-1e3, 1e3))
def test_shares_do_not_depend_on_units(scale: float, target_scale: float, shift: float) -> None:
    x, z = np.random.default_rng(17).normal(size=(2, 200))
    groups, y = {"x": slice(0, 1), "z": slice(1, 2)}, x + 2 * z
    assume(abs(shift) < 1e6 * scale)  # a shift of more leaves too few digits of x
    plain = shares(RegressorSums.of(np.column_stack([x, z]), y), groups)
    scaled = shares(RegressorSums.of(np.column_stack([scale * x + shift, z]), target_scale * y), groups)
    assert scaled.share["x"] == pytest.approx(plain.share["x"], abs=1e-8)


# agreement --------------------------------------------------------------------------------------


@given(values_of, cuts_of)
def test_agreement_of_blocks_merges_to_that_of_the_whole(values: Array, cuts: list[int]) -> None:
    reference = np.cos(values)
    values = np.where(values > 90, math.nan, values)
    pairs = zip(blocks(values, cuts), blocks(reference, cuts), strict=True)
    merged = reduce(Agreement.merge, (Agreement.of(*pair) for pair in pairs))
    known = (values - reference)[~np.isnan(values)]
    assert (merged.count, merged.skipped) == (len(known), len(values) - len(known))
    assume(len(known) > 0)
    assert merged.max_abs == np.max(np.abs(known))
    assert merged.mean == pytest.approx(np.mean(known), abs=1e-12)
    assert merged.rms == pytest.approx(math.sqrt(np.mean(known**2)), rel=1e-12)


def test_agreement_has_the_sign_of_values_less_reference() -> None:
    agreement = Agreement.of(np.array([1.0, 2.0, math.nan]), np.array([0.5, 2.5, 1.0]))
    assert (agreement.mean, agreement.rms, agreement.max_abs, agreement.skipped) == (0.0, 0.5, 0.5, 1)
    assert Agreement.of(np.array([3.0]), np.array([1.0])).mean == 2.0


def test_no_trials_agree_on_nothing() -> None:
    nothing = Agreement.of(np.array([math.nan]), np.array([1.0]))
    assert (nothing.count, nothing.skipped, nothing.max_abs) == (0, 1, 0.0)
    assert math.isnan(nothing.mean)
    assert math.isnan(nothing.rms)
