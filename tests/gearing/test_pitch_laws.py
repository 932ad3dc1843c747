"""Laws of pitch deviations: they close, keep their limits, fill them as stated, and have the moments that they say."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.stats import kstest

from tol3d.gearing.draws.normal_pitch_draw import NormalPitchDraw
from tol3d.gearing.draws.pitch_draw import Pattern, PitchDraw, PitchLimits, RandomWalk, RunOutAndRandom

Array = NDArray[np.float64]

LIMITS = PitchLimits(0.006, 0.017)
COUNT = 4000
PATTERNS: tuple[Pattern, ...] = (RandomWalk(), RunOutAndRandom(0.0), RunOutAndRandom(0.7), RunOutAndRandom(1.0))


def law(pattern: Pattern, sides: tuple[str, ...] = ("",), fill: tuple[float, float] = (0.5, 1.0)) -> PitchDraw:
    return PitchDraw(20, sides, pattern, LIMITS, fill)


def drawn(draw: PitchDraw, count: int = COUNT, seed: int = 3) -> Array:
    uniforms = np.random.default_rng(seed).random((draw.uniforms, count))
    return np.stack(draw.deviations(*uniforms))


def filled(index: Array) -> Array:
    pitches = index - np.roll(index, 1, axis=0)
    return np.maximum(np.abs(pitches).max(axis=0) / LIMITS.single, np.ptp(index, axis=0) / LIMITS.cumulative)


@pytest.mark.parametrize("pattern", PATTERNS, ids=lambda own: own.words)
def test_limits_are_filled_uniformly_between_both_shares_and_never_left(pattern: Pattern) -> None:
    index = drawn(law(pattern))
    share = filled(index)
    assert share.min() >= 0.5 - 1e-12
    assert share.max() <= 1.0 + 1e-12
    assert kstest(share, "uniform", args=(0.5, 0.5)).pvalue > 1e-4
    assert np.abs(index.mean(axis=0)).max() < 1e-17
    assert np.abs((index - np.roll(index, 1, axis=0)).sum(axis=0)).max() < 1e-16


@pytest.mark.parametrize("pattern", PATTERNS, ids=lambda own: own.words)
def test_mean_and_covariance_of_a_sample_are_those_that_the_law_says(pattern: Pattern) -> None:
    """Mean: 4.5 standard errors of 20 teeth. Covariance: the net is right to 1 %, a sample of 4000 x 20 likewise."""
    draw = law(pattern, ("right", "left"))
    index = drawn(draw)
    assert len(draw.components) == 40
    assert np.abs(index.mean(axis=1)).max() < 4.5 * draw.sigma / math.sqrt(COUNT)
    seen = index @ index.T / COUNT
    around = [np.mean([seen[k, (k + apart) % 20] for k in range(20)]) for apart in range(20)]
    assert around == pytest.approx(draw.covariance[0, :20], abs=0.05 * draw.sigma**2)
    assert np.abs(seen[:20, 20:]).max() < 5.5 * draw.sigma**2 / math.sqrt(COUNT)
    assert draw.distribution.sigma == pytest.approx(draw.sigma, rel=0.02)


def test_pitches_of_a_random_walk_are_alike_and_pull_each_other_back() -> None:
    """Normals on condition that z of them sum to zero correlate by -1/(z - 1), whatever they are scaled by."""
    index = drawn(law(RandomWalk()))
    pitches = index - np.roll(index, 1, axis=0)
    seen = np.asarray(np.corrcoef(pitches))
    assert np.mean(seen[~np.eye(20, dtype=bool)]) == pytest.approx(-1 / 19, abs=1e-3)
    assert pitches.std(axis=1) == pytest.approx(np.full(20, pitches.std()), rel=0.06)


@pytest.mark.parametrize("share", [0.0, 0.3, 0.7])
def test_the_wave_round_the_gear_has_its_share_of_the_variance(share: float) -> None:
    """The first order of white noise has 2 parts of 19."""
    index = drawn(law(RunOutAndRandom(share), fill=(1.0, 1.0)))
    power = np.abs(np.fft.rfft(index, axis=0)) ** 2
    power[1:-1] *= 2.0
    first = power[1] / power.sum(axis=0)
    alone = share + (1 - share) * 2 / 20
    assert np.mean(power[1]) / np.mean(power[1:].sum(axis=0)) == pytest.approx(
        alone / (share + (1 - share) * 0.95), abs=0.06
    )
    assert 0.0 < first.min() < first.max() < 1.0


def test_a_trial_alone_has_the_bits_that_it_has_among_others() -> None:
    for pattern in PATTERNS:
        draw = law(pattern, ("right", "left"))
        uniforms = np.random.default_rng(7).random((draw.uniforms, 300))
        whole = np.stack(draw.deviations(*uniforms))
        for trial in (0, 17, 299):
            alone = np.stack(draw.deviations(*uniforms[:, trial : trial + 1]))
            assert alone[:, 0].tobytes() == np.ascontiguousarray(whole[:, trial]).tobytes()


def test_ends_are_as_full_as_limits_get_along_the_steepest_direction() -> None:
    draw = law(RunOutAndRandom(0.5), fill=(0.5, 0.9))
    slopes = np.cos(2 * math.pi * np.arange(20) / 20)
    ends = draw.ends(lambda rows: rows @ slopes, turning=False)
    assert ends[0] == pytest.approx(-ends[1])
    assert filled(ends.T) == pytest.approx([0.9, 0.9])
    assert np.asarray(np.corrcoef(ends[0], slopes))[0, 1] == pytest.approx(1.0)


# normal pitches -------------------------------------------------------------------------------------------------


def normal(cpk: float, cumulative: float, sides: tuple[str, ...] = ("",)) -> NormalPitchDraw:
    return NormalPitchDraw(20, sides, RandomWalk(), PitchLimits(0.006, cumulative), (1.0, 1.0), cpk)


def test_normal_pitches_have_their_capability_and_sum_to_zero() -> None:
    """F_p far away: f_k normal with f_p/(3 cpk), each two correlate by -1/(z - 1)."""
    index = drawn(normal(1.33, 1.0))
    pitches = index - np.roll(index, 1, axis=0)
    sigma = 0.006 / (3 * 1.33)
    assert np.abs(pitches.sum(axis=0)).max() < 1e-16
    assert np.abs(index.mean(axis=0)).max() < 1e-17
    assert pitches.std() == pytest.approx(sigma, rel=4.5 / math.sqrt(2 * 19 * COUNT))
    for tooth in (0, 7, 19):
        assert kstest(pitches[tooth] / sigma, "norm").pvalue > 1e-4
    seen = np.asarray(np.corrcoef(pitches))
    assert np.mean(seen[~np.eye(20, dtype=bool)]) == pytest.approx(-1 / 19, abs=1e-3)


def test_gears_beyond_the_cumulative_limit_are_none() -> None:
    """A limit that a third of such gears exceeds; sorted gears, whose patterns are others too, spread 6 % less."""
    free, cut = drawn(normal(1.0, 1.0), 20_000), drawn(normal(1.0, 0.010), 20_000, seed=8)
    spread = np.ptp(free, axis=0)
    assert 0.2 < np.mean(spread > 0.010) < 0.7
    assert np.ptp(cut, axis=0).max() <= 0.010 * (1 + 1e-12)
    kept = free[:, spread <= 0.010]
    assert cut.std() == pytest.approx(1.06 * kept.std(), rel=0.02)


def test_normal_pitches_say_their_moments_and_are_the_same_alone() -> None:
    draw = normal(1.0, 0.014, ("right", "left"))
    index = drawn(draw)
    seen = index @ index.T / COUNT
    around = [np.mean([seen[k, (k + apart) % 20] for k in range(20)]) for apart in range(20)]
    assert around == pytest.approx(draw.covariance[0, :20], abs=0.05 * draw.sigma**2)
    uniforms = np.random.default_rng(7).random((draw.uniforms, 300))
    whole = np.stack(draw.deviations(*uniforms))
    for trial in (0, 17, 299):
        alone = np.stack(draw.deviations(*uniforms[:, trial : trial + 1]))
        assert alone[:, 0].tobytes() == np.ascontiguousarray(whole[:, trial]).tobytes()
    ends = draw.ends(lambda rows: rows[:, 0] - rows[:, 10], turning=False)
    assert ends[0] == pytest.approx(-ends[1])
    assert np.ptp(ends[0, :20]) <= 0.014 * (1 + 1e-12)
    assert ends[0, 0] > draw.sigma
