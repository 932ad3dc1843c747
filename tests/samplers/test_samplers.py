"""Samplers: what their points fill, what a draw depends on, whether their stated errors are true, how fast they win."""

import json
import math
import re
import subprocess
import sys
from dataclasses import replace
from functools import reduce
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy
from gear_trials import drawn_trials, simulated
from hypothesis import given, settings
from hypothesis import strategies as st
from loose_summaries import typed_run
from places import ROOT
from printing import printed as of_rich

from tol3d import Scene, SceneError, load_scene
from tol3d.errors import InputError
from tol3d.gearing.methods.analytic import analytic_values
from tol3d.gearing.model import Model, Positions
from tol3d.gearing.stack_up import closed_form
from tol3d.gearing.system import gear_model
from tol3d.report.table import run_report
from tol3d.simulate import simulation_of
from tol3d.statistics.estimates import Moments
from tol3d.statistics.samplers import LatinHypercube, MonteCarlo, Sampler, Sobol, Stream
from tol3d.statistics.samplers.latin_hypercube import ROUNDS, permuted
from tol3d.statistics.samplers.monte_carlo import random_words
from tol3d.statistics.samplers.sobol import LinearPoints, plain_jumps
from tol3d.study.results.findings import findings
from tol3d.study.system.outcome import Columns
from tol3d.study.system.trials import Trials
from tol3d.study.tallies.replicated import Replicated, rows_of_replicates
from tol3d.study.tallies.sample import mean_interval, sigma_interval
from tol3d.study.tallies.tally import PILOT_TRIALS, Tally, grids_of
from tol3d.study.trials.columns import columns_of
from tol3d.study.trials.draws import drawn
from tol3d.study.trials.simulation import Simulation

SPUR_PAIR = (ROOT / "scenes" / "spur_pair.yaml").read_text(encoding="utf-8")
STUDY_LINE = "study: {trials: 2000, seed: 1, sampler: monte_carlo, engine: exact, witness: 20}"
A, B = Stream("a", "0", 0), Stream("b", "1", 1)
DIGIT = 2.0**-52


def scene_of(folder: Path, study: str, text: str = SPUR_PAIR) -> Scene:
    path = folder / "scene.yaml"
    assert STUDY_LINE in text
    path.write_text(text.replace(STUDY_LINE, study), encoding="utf-8")
    return load_scene(path)


def block_of(simulation: Simulation, first: int, count: int) -> Trials:
    return drawn(simulation, first, count)


# Sobol' -----------------------------------------------------------------------------------------------------------


def test_points_without_a_scramble_are_scipys() -> None:
    dimensions, count = 12, 2**13  # more than one page of the table
    expected = scipy.stats.qmc.Sobol(dimensions, scramble=False).random(count)
    jumps = plain_jumps(dimensions, 13)
    found = np.stack([LinearPoints.of(column).points(0, count) for column in jumps.T], axis=1)
    assert np.array_equal(found * DIGIT, expected)


def test_far_points_are_scipys_too() -> None:
    first, count = 5_000_001, 300
    expected = scipy.stats.qmc.Sobol(3, scramble=False).fast_forward(first).random(count)
    found = [LinearPoints.of(column).points(first, count) for column in plain_jumps(3, 23).T]
    assert np.array_equal(np.stack(found, axis=1) * DIGIT, expected)


@pytest.mark.parametrize("dimension", [0, 1, 5, 20])
@pytest.mark.parametrize("bits", [0, 3, 9, 13])
def test_every_run_of_2_to_the_k_scrambled_points_has_one_in_each_2_to_the_kth(dimension: int, bits: int) -> None:
    count = 2**bits
    sampler = Sobol(4, 4 * count, 21)
    for first in (0, 3 * count, 7 * count):  # of the first replicate and of the second
        drawn = sampler.uniforms(Stream("a", "0", dimension), first, count)
        assert np.array_equal(np.sort(np.floor(drawn * count)), np.arange(count))


@given(seed=st.integers(0, 2**63 - 1), bits=st.integers(0, 10), replicate=st.integers(0, 5))
@settings(max_examples=15)
def test_the_first_two_dimensions_fill_every_elementary_rectangle_once(seed: int, bits: int, replicate: int) -> None:
    # the first two of Sobol's dimensions are a (0, m, 2)-net in base 2, which the scramble keeps
    count = 2**bits
    x, y = (Sobol(seed, count, 2).uniforms(stream, replicate * count, count) for stream in (A, B))
    for k in range(bits + 1):
        cell = np.floor(x * 2**k) * 2 ** (bits - k) + np.floor(y * 2 ** (bits - k))
        assert np.array_equal(np.sort(cell), np.arange(count))


def test_the_scramble_makes_the_first_point_uniform_over_replicates() -> None:
    # one point of each of n replicates: independent uniforms
    count = 4000
    first_points = Sobol(1, 2, 2).uniforms(A, 0, 2 * count)[::2]
    # Kolmogorov-Smirnov at 1e-6: 2.7 / sqrt(n)
    assert np.abs(np.sort(first_points) - (np.arange(count) + 0.5) / count).max() < 2.7 / math.sqrt(count)


def test_a_scramble_is_of_its_seed_stream_and_replicate() -> None:
    drawn = [
        Sobol(1, 64, 2).uniforms(A, 0, 64),
        Sobol(2, 64, 2).uniforms(A, 0, 64),
        Sobol(1, 64, 2).uniforms(A, 64, 64),
        Sobol(1, 64, 2).uniforms(replace(A, component="1"), 0, 64),
        Sobol(1, 64, 2).uniforms(replace(A, name="b"), 0, 64),
    ]
    assert len({values.tobytes() for values in drawn}) == len(drawn)


# Latin hypercube --------------------------------------------------------------------------------------------------


@given(seed=st.integers(0, 2**63 - 1), size=st.integers(1, 3000), replicate=st.integers(0, 3))
@settings(max_examples=50)
def test_each_stratum_holds_one_point(seed: int, size: int, replicate: int) -> None:
    drawn = LatinHypercube(seed, size).uniforms(A, replicate * size, size)
    assert np.array_equal(np.sort(np.floor(drawn * size)), np.arange(size))
    assert 0.0 < drawn.min() <= drawn.max() < 1.0


def test_a_permutation_is_of_its_seed_stream_and_replicate() -> None:
    drawn = [
        LatinHypercube(1, 64).uniforms(A, 0, 64),
        LatinHypercube(2, 64).uniforms(A, 0, 64),
        LatinHypercube(1, 64).uniforms(A, 64, 64),
        LatinHypercube(1, 64).uniforms(replace(A, component="1"), 0, 64),
        LatinHypercube(1, 64).uniforms(replace(A, name="b"), 0, 64),
    ]
    # the places inside the strata differ anyhow; which trial has which of 64! orders does so by the keys alone
    assert len({np.floor(values * 64).tobytes() for values in drawn}) == len(drawn)


def test_places_stay_inside_their_strata_in_the_largest_studies() -> None:
    size = 5 * 10**9
    sampler = LatinHypercube(1, size)
    drawn = sampler.uniforms(A, 10**9, 20_000)
    keys = random_words(ROUNDS, 1, A.name, A.component, "latin hypercube", "0", str(size))
    stratum = permuted(np.arange(10**9, 10**9 + 20_000, dtype=np.uint64), size, keys)
    assert np.array_equal(np.floor(drawn * size), stratum.astype(np.float64))


def shuffled(size: int, seed: int, name: str = "a") -> np.ndarray:
    keys = random_words(ROUNDS, seed, name)
    return permuted(np.arange(size, dtype=np.uint64), size, keys).astype(np.int64)


def test_the_permutation_looks_like_a_random_one() -> None:
    size = 20_000
    one, other = shuffled(size, 1), shuffled(size, 1, "b")
    assert abs(np.corrcoef(one, other)[0, 1]) < 4 / math.sqrt(size)
    assert abs(np.corrcoef(one, np.arange(size))[0, 1]) < 4 / math.sqrt(size)
    # steps from one to the next, modulo n, are uniform: chi-square of 50 cells, 1e-6 at either end
    counts = np.bincount(np.diff(one) % size * 50 // size, minlength=50)
    chi_square = float(np.sum((counts - counts.mean()) ** 2) / counts.mean())
    assert scipy.stats.chi2.ppf(1e-6, 49) < chi_square < scipy.stats.chi2.ppf(1 - 1e-6, 49)


@pytest.mark.slow
@pytest.mark.parametrize("size", [3, 5, 16])
def test_small_permutations_take_any_two_places_anywhere(size: int) -> None:
    keys = 4000
    pairs = [shuffled(size, seed)[:2] for seed in range(keys)]
    counts = np.zeros((size, size))
    np.add.at(counts, tuple(np.transpose(pairs)), 1)
    assert np.all(np.diag(counts) == 0)
    expected = keys / (size * (size - 1))
    chi_square = float(np.sum((counts[~np.eye(size, dtype=bool)] - expected) ** 2) / expected)
    assert chi_square < scipy.stats.chi2.ppf(1 - 1e-6, size * (size - 1) - 1)


# what a draw depends on -------------------------------------------------------------------------------------------

SAMPLERS: list[Sampler] = [
    MonteCarlo(3),
    Sobol(3, 2**7, 2),
    Sobol(3, 2**20, 2),
    Sobol(3, 1000, 2),
    LatinHypercube(3, 96),
    LatinHypercube(3, 10**6),
]


@pytest.mark.parametrize("sampler", SAMPLERS, ids=str)
@given(first=st.integers(0, 10**8), cuts=st.lists(st.integers(0, 500), max_size=4))
@settings(max_examples=20)
def test_any_cut_into_blocks_gives_the_same_bits(sampler: Sampler, first: int, cuts: list[int]) -> None:
    whole = sampler.uniforms(B, first, 500)
    ends = [0, *sorted(cuts), 500]
    parts = [sampler.uniforms(B, first + start, end - start) for start, end in pairwise(ends)]
    assert np.array_equal(np.concatenate(parts), whole)


@pytest.mark.parametrize("sampler", ["monte_carlo", "sobol", "latin_hypercube"])
def test_a_trial_of_a_model_is_the_same_alone(tmp_path: Path, sampler: str) -> None:
    model = simulation_of(scene_of(tmp_path, f"study: {{trials: 1024, sampler: {sampler}, engine: analytic}}"))
    whole = block_of(model, 0, 1024)
    for trial in (0, 63, 64, 1023):
        alone = block_of(model, trial, 1)
        assert np.array_equal(alone.deviations[0], whole.deviations[trial])
        assert alone.positions["gear pair"][0] == whole.positions["gear pair"][trial]


def test_a_contributor_more_changes_no_other_monte_carlo_draw(paper_model: Model) -> None:
    fewer = replace(paper_model, contributors=paper_model.contributors[1:])
    name = paper_model.contributors[0].name
    whole = drawn_trials(paper_model, 1, 0, 100).deviations
    kept = np.delete(whole, paper_model.component_slices[name], axis=1)
    assert np.array_equal(drawn_trials(fewer, 1, 0, 100).deviations, kept)
    for mesh, angle in drawn_trials(paper_model, 1, 0, 100).positions.items():
        assert np.array_equal(drawn_trials(fewer, 1, 0, 100).positions[mesh], angle)


# errors by replicates ---------------------------------------------------------------------------------------------

FIXED = Positions("at", 1, 1, 0.3)  # no wave of the turning gears for the points to resolve


def found(model: Model, sampler: Any, trials: int, seed: int) -> np.ndarray:
    """Errors of mean and sigma of one study against the closed form, and the standard errors it states [um]."""
    measure = replace(model.measures[0], positions=FIXED)
    parts = 1 if sampler == "monte_carlo" else 16
    simulation = simulated(model, sampler=sampler, trials=trials, seed=seed, replicates=parts)
    study = simulation.study
    values = 1e3 * analytic_values(model, measure, block_of(simulation, 0, trials))[:, 0]
    moments, form, rows = Moments.of(values), closed_form(model, measure), rows_of_replicates(study, 0, trials)
    assert form is not None
    errors = Replicated.of(values, rows, None, None) if rows else moments
    return np.array([moments.mean - 1e3 * form.mean, moments.sigma - 1e3 * form.sigma, errors.mean_se, errors.sigma_se])


@pytest.mark.slow
@pytest.mark.parametrize("sampler", ["sobol", pytest.param("latin_hypercube", marks=pytest.mark.slow)])
def test_the_stated_standard_errors_are_the_true_spread(paper_model: Model, sampler: str) -> None:
    studies, replicates = 200, 16
    squares = np.mean([found(paper_model, sampler, 1024, seed) ** 2 for seed in range(studies)], axis=0)
    # a mean square of n normal errors is known to sqrt(2 / n), one of n stated variances to sqrt(2 / (15 n)); 4 sigma
    bound = 4 * math.sqrt(2 / studies + 2 / ((replicates - 1) * studies))
    assert squares[2] / squares[0] == pytest.approx(1.0, abs=bound)
    assert squares[3] / squares[1] == pytest.approx(1.0, abs=bound)


def order(model: Model, sampler: str, studies: int) -> float:
    """p of (error of the mean) ~ N^-p over 2^8 ... 2^14 trials."""
    sizes = [2**8, 2**10, 2**12, 2**14]
    rms = [math.sqrt(np.mean([found(model, sampler, n, seed)[0] ** 2 for seed in range(studies)])) for n in sizes]
    return -float(np.polyfit(np.log(sizes), np.log(rms), 1)[0])


@pytest.mark.slow
def test_the_mean_converges_with_order_one_half_by_monte_carlo_and_more_than_nine_tenths_by_sobol(
    paper_model: Model,
) -> None:
    # rms of n errors: log known to 1 / sqrt(2 n) = 0.125; the slope through four sizes, whose logs have a standard
    # deviation of 1.55, to 0.125 / (1.55 sqrt(4)) = 0.04; 4 of them
    assert order(paper_model, "monte_carlo", 32) == pytest.approx(0.5, abs=0.16)
    assert order(paper_model, "sobol", 32) >= 0.9  # smooth integrands have 1 to 1.5


def test_replicates_that_blocks_cut_are_put_together_again(tmp_path: Path) -> None:
    study = replace(simulation_of(scene_of(tmp_path, STUDY_LINE)).study, sampler="sobol", trials=160, replicates=10)
    values = np.random.default_rng(1).normal(size=160)
    values[[5, 70]] = math.nan

    def tallied(first: int, last: int) -> Replicated:
        return Replicated.of(values[first:last], rows_of_replicates(study, first, last - first), -1.0, 1.0)

    whole = tallied(0, 160)
    cut = reduce(Replicated.merge, [tallied(a, b) for a, b in pairwise([0, 7, 30, 31, 100, 160])])
    by_hand = [part[~np.isnan(part)] for part in values.reshape(10, 16)]
    for replicated in (whole, cut):
        means, sigmas = [part.mean() for part in by_hand], [part.std(ddof=1) for part in by_hand]
        assert replicated.mean_se == pytest.approx(np.std(means, ddof=1) / math.sqrt(10), rel=1e-12)
        assert replicated.sigma_se == pytest.approx(np.std(sigmas, ddof=1) / math.sqrt(10), rel=1e-12)
    assert whole.limits == cut.limits


def test_a_share_beyond_a_limit_has_students_interval() -> None:
    generator = np.random.default_rng(2)
    values, rows = generator.normal(size=1600), {k: slice(100 * k, 100 * k + 100) for k in range(16)}
    shares = 1e6 * (values.reshape(16, 100) < -1.0).mean(axis=1)
    expected = scipy.stats.t.interval(0.95, 15, loc=shares.mean(), scale=shares.std(ddof=1) / 4)
    assert Replicated.of(values, rows, -1.0, None).below_interval_ppm == pytest.approx(expected)


def test_a_share_of_few_trials_has_the_wider_of_students_and_clopper_and_pearson_s_interval() -> None:
    """Two trials of 16 replicates of 100; a share that all of them miss is below 4.2 of 1600, less than either."""
    values, rows = np.zeros(1600), {k: slice(100 * k, 100 * k + 100) for k in range(16)}
    values[[5, 740]] = 9.0
    found = Replicated.of(values, rows, None, 2.5).above_interval_ppm
    alone = scipy.stats.binomtest(2, 1600).proportion_ci(0.95, "exact")
    assert found == pytest.approx((0.0, 1e6 * alone.high))  # Student's half is 2.131 sqrt(2)/1600: lower end cut at 0
    mirrored = Replicated.of(values, rows, 2.5, None).below_interval_ppm
    assert mirrored == pytest.approx((1e6 - 1e6 * alone.high, 1e6))


@pytest.mark.parametrize("replicates", [2, 4, 16])
def test_a_share_that_no_replicate_has_is_bounded_by_cantelli_s_inequality(replicates: int) -> None:
    """There a count of mean m = n p and variance n/(n - 1) m (1 - p) is 0 in all with a chance of 2.5 % at most."""
    rows = {k: slice(64 * k, 64 * k + 64) for k in range(replicates)}
    found = Replicated.of(np.zeros(64 * replicates), rows, None, 2.5).above_interval_ppm
    assert found is not None
    assert found[0] == 0.0
    p = found[1] / 1e6
    mean, variance = 64 * p, 64 / 63 * 64 * p * (1 - p)
    assert (variance / (variance + mean**2)) ** replicates == pytest.approx(0.025)
    assert p > scipy.stats.binomtest(0, 64 * replicates).proportion_ci(0.95, "exact").high


def latin(rng: np.random.Generator, sets: int) -> np.ndarray:
    """Latin hypercubes (sets, 64, 3), written for this test."""
    cells = np.argsort(rng.random((sets, 3, 64)), axis=2).transpose(0, 2, 1)
    return (cells + rng.random((sets, 64, 3))) / 64


def scrambled_net(rng: np.random.Generator, sets: int) -> np.ndarray:
    """Sobol' points (sets, 64, 3), scipy's, each set scrambled anew."""
    seeds = rng.integers(0, 2**31, sets).tolist()
    return np.stack([scipy.stats.qmc.Sobol(3, scramble=True, rng=seed).random(64) for seed in seeds])


def holds(interval: Any, value: float) -> bool:
    return bool(interval[0] <= value <= interval[1])


@pytest.mark.parametrize("points", [latin, pytest.param(scrambled_net, marks=pytest.mark.slow)])
def test_intervals_of_four_replicates_hold_the_truth_as_often_as_they_say(points: Any) -> None:
    """A sum of three uniforms: mean 3/2, sigma 1/2, d^3/6 beyond 3 - d; 1.96 errors hold 85.5 % of means.

    Of 300 studies 95 % hold it to 4 standard deviations of a binomial law, 5 %; few trials are beyond 2.94 and 2.4.
    """
    studies, replicates = 300, 4
    sums = points(np.random.default_rng(7), studies * replicates).sum(axis=2).reshape(studies, -1)
    rows = {k: slice(64 * k, 64 * k + 64) for k in range(replicates)}
    normal, held = 0, dict.fromkeys(("mean", "sigma", 2.94, 2.4, 2.0), 0)
    for values in sums:
        own = Replicated.of(values, rows, None, None)
        mean, sigma = (of(Moments.of(values), own) for of in (mean_interval, sigma_interval))
        held["mean"] += holds(mean, 1.5)
        held["sigma"] += holds(sigma, 0.5)
        normal += abs(values.mean() - 1.5) <= 1.96 * own.mean_se
        for limit in (2.94, 2.4, 2.0):
            interval = Replicated.of(values, rows, None, limit).above_interval_ppm
            held[limit] += holds(interval, 1e6 * (3 - limit) ** 3 / 6)
    error = 4 * math.sqrt(0.95 * 0.05 / studies)
    assert min(held.values()) / studies >= 0.95 - error
    if points is latin:  # whose replicates' means are near a normal
        assert held["mean"] / studies <= 0.95 + error
        assert normal / studies == pytest.approx(0.855, abs=4 * math.sqrt(0.855 * 0.145 / studies))


# in a summary and in print ----------------------------------------------------------------------------------------


def summary_of(simulation: Simulation) -> dict[str, Any]:
    """An analytic study in blocks of 300, as a run would fold them."""
    system, trials = simulation.system, simulation.study.trials

    def block(first: int, count: int) -> Columns:
        return columns_of(system, None, block_of(simulation, first, count))

    grids = grids_of(system, block(0, PILOT_TRIALS))
    parts = [
        Tally.of(simulation, grids, block(first, min(300, trials - first)), first) for first in range(0, trials, 300)
    ]
    summary = findings(simulation, None, reduce(Tally.merge, parts), lambda words: None)
    return {**summary, "timing": {"setup_s": 0.0, "simulate_s": 1.0, "trials_per_s": 1.0, "workers": 1}}


def printed(summary: dict[str, Any]) -> str:
    return of_rich(run_report(typed_run(summary)), 400)


def test_a_summary_says_by_what_its_errors_are_known(tmp_path: Path) -> None:
    model = simulation_of(
        scene_of(tmp_path, "study: {trials: 1024, seed: 2, sampler: sobol, replicates: 8, engine: analytic}")
    )
    summary = summary_of(model)
    own = summary["measures"]["normal backlash"]["analytic"]
    gears = gear_model(model.system)
    values = 1e3 * analytic_values(gears, gears.measures[0], block_of(model, 0, 1024))[:, 0].reshape(8, 128)
    assert own["error_by"] == "replicates"
    assert own["mean_se"] == pytest.approx(values.mean(axis=1).std(ddof=1) / math.sqrt(8), rel=1e-9)
    assert own["sigma_se"] == pytest.approx(values.std(axis=1, ddof=1).std(ddof=1) / math.sqrt(8), rel=1e-9)
    odds = 0.025 ** (-1 / 8) - 1
    assert own["below_limit_ppm_95"] == pytest.approx([0.0, 1e6 * odds / (127 + odds)])  # 5.3 sigma off: none is below
    assert own["mean_95"] == pytest.approx(scipy.stats.t.interval(0.95, 7, own["mean"], own["mean_se"]))
    low, high = scipy.stats.t.interval(0.95, 7, own["sigma"], own["sigma_se"])
    assert own["sigma_95"] == pytest.approx([low - own["sigma"] * (1 - math.sqrt(1023 / 1024)), high])
    assert summary["measures"]["normal backlash"]["contributors"][0]["geometric_percent_se"] is None
    text = printed(summary)
    assert "sampling error of 1024 trials of scrambled Sobol' points, by the spread of 8 replicates: mean ±" in text
    assert f"{scipy.stats.t.ppf(0.975, 7) * own['mean_se']:.3f} µm, sigma ±" in text
    assert "(95 % confidence, Student's t)" in text
    assert json.loads(json.dumps(summary["study"]))["sampler"] == "sobol"


def test_independent_trials_tell_their_errors_themselves(tmp_path: Path) -> None:
    model = simulation_of(scene_of(tmp_path, "study: {trials: 500, engine: analytic}"))
    summary = summary_of(model)
    own = summary["measures"]["normal backlash"]["analytic"]
    assert own["error_by"] == "sample"
    assert own["mean_se"] == pytest.approx(own["sigma"] / math.sqrt(500))
    assert "sampling error of 500 trials: mean ±" in printed(summary)


# the study in a scene ---------------------------------------------------------------------------------------------


def test_samplers_have_sixteen_replicates_if_nothing_is_said(tmp_path: Path) -> None:
    for sampler, parts in (("monte_carlo", 1), ("sobol", 16), ("latin_hypercube", 16)):
        study = simulation_of(scene_of(tmp_path, f"study: {{trials: 4096, sampler: {sampler}}}")).study
        assert (study.sampler, study.replicates, study.replicate_trials) == (sampler, parts, 4096 // parts)


@pytest.mark.parametrize(
    ("study", "words"),
    {
        "trials: 1000, sampler: sobol": "study.trials: expected a multiple of the 16 replicates, such as 992 or 1008, "
        "got 1000",
        "trials: 10, sampler: sobol": "study.trials: expected a multiple of the 16 replicates, such as 16, got 10",
        "trials: 9999999999, replicates: 3, sampler: sobol": "study.trials: expected at most 6442450944 for 3 "
        "replicates of Sobol' points, got 9999999999",
        "trials: 1000, replicates: 4": "study.replicates: expected none for monte_carlo, whose trials tell their error "
        "themselves, got 4",
        "trials: 1000, sampler: latin_hypercube, replicates: 1": "study.replicates: expected a number of at least 2, "
        "got 1",
        "sampler: sobl": "study.sampler: expected one of monte_carlo, sobol, latin_hypercube, got 'sobl'; "
        'did you mean "sobol"?',
        "trials: aut": "study.trials: expected a whole number or auto, got 'aut'; did you mean \"auto\"?",
        "trials: 2.5": "study.trials: expected a whole number or auto, got 2.5",
        "trials: auto": "study.until: expected the standard errors to stop at where trials are auto, such as",
        "trials: auto, sampler: sobol, until: {normal backlash: {mean: 1 um}}": "study.sampler: expected monte_carlo "
        "where trials are auto, for replicates need their size beforehand, got 'sobol'",
        "until: {normal backlash: {mean: 1 um}}": "study.trials: expected auto, for until is given, got 2000",
        "at_most: 500": "study.trials: expected auto, for at_most is given, got 2000",
        "trials: auto, until: {normal backlash: {}}": "study.until.normal backlash: expected mean, sigma or both, got "
        "neither",
        "trials: auto, until: {normal backlash: {mean: 0 um}}": "study.until.normal backlash.mean: expected a length "
        "of more than zero, got '0 um'",
        "trials: auto, until: {normal backlash: {mean: 0.1}}": "study.until.normal backlash.mean: expected a number "
        "with its unit",
        "trials: auto, until: {normal backlsh: {mean: 1 um}}": "study.until.normal backlsh: expected the name of a "
        "measure, got 'normal backlsh'; did you mean \"normal backlash\"?",
        "trials: auto, until: {lost motion: {sigma: 1 um}}": "study.until.lost motion.sigma: expected an angle with "
        "its unit, such as \"20 deg\" ('lost motion' is of kind angular_backlash), got '1 um'",
    }.items(),
)
def test_what_a_study_cannot_be_is_said(tmp_path: Path, study: str, words: str) -> None:
    with pytest.raises(SceneError) as caught:
        scene_of(tmp_path, f"study: {{{study}}}")
    assert len(caught.value.problems) == 1
    assert words in str(caught.value)


def test_a_curve_cannot_be_waited_for(tmp_path: Path) -> None:
    curve = SPUR_PAIR.replace("    lower_limit: 15 um", "    over: turn\n    take: curve\n    lower_limit: 15 um")
    with pytest.raises(SceneError, match="normal backlash: expected a measure of one value a trial"):
        scene_of(tmp_path, "study: {trials: auto, until: {normal backlash: {mean: 1 um}}}", curve)


def test_sobol_points_not_in_powers_of_two_are_warned_of(tmp_path: Path) -> None:
    model = simulation_of(scene_of(tmp_path, "study: {trials: 2000, sampler: sobol}"))
    (warning,) = model.warnings
    assert "take 1024 (16 replicates of 64) or 2048 (16 of 128) trials" in warning
    even = replace(model, study=replace(model.study, trials=2048))
    assert even.warnings == ()
    with pytest.raises(InputError, match="trials: expected a multiple of the 16 replicates, such as 992 or 1008"):
        replace(model.study, trials=1000)


def test_the_documents_studies_can_be_run(tmp_path: Path) -> None:
    document = (ROOT / "docs" / "scene.md").read_text(encoding="utf-8")
    studies = re.findall(r"```text\n(study:.*?)```", document, re.DOTALL)
    kinds = {simulation_of(scene_of(tmp_path, study)).study.sampler for study in studies}
    assert kinds == {"sobol", "monte_carlo"}


def test_monte_carlo_does_not_wait_for_scipys_statistics() -> None:
    code = (
        "import sys; from tol3d.statistics.samplers import MonteCarlo, Stream; import tol3d.simulate\n"
        "MonteCarlo(1).uniforms(Stream('a', '0', 0), 0, 10); print('scipy.stats' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "False\n"
