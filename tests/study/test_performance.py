"""Ppk by what the trials allow: against known quantiles of skewed laws, and never against the verdict."""

import math
from typing import Any

import numpy as np
import pytest
from loose_summaries import typed_measure, typed_run
from places import SCENES
from printing import printed
from scipy import stats

from tol3d import load_scene
from tol3d.report.verdict import verdict_table
from tol3d.statistics.estimates import Grid, Moments
from tol3d.statistics.estimates.moments import kurtosis_se, skewness_se
from tol3d.study.runs.summary.judged import AcceptedPpk, JudgedMeasure
from tol3d.study.runs.summary.sample import Sample as SampleSummary
from tol3d.study.runs.summary.values import as_json
from tol3d.study.system.outcome import Outcome
from tol3d.study.system.plain import PlainMeasure
from tol3d.study.tallies.performance import FEWEST, Side
from tol3d.study.tallies.sample import Sample, sample_summary
from tol3d.study.trials.overrides import simulation_of
from tol3d.study.trials.study import PpkBy

MM = 1e-3  # one um, as limits are stated
LOW, MIDDLE, HIGH = 0.00135, 0.5, 0.99865


def summary(
    values: np.ndarray, lower: float | None = None, upper: float | None = None, asked: PpkBy | None = None
) -> SampleSummary:
    """Summary of values [um] and limits [um], nan of builds that failed."""
    limits = [None if limit is None else limit * MM for limit in (lower, upper)]
    measure = PlainMeasure("gap", "gap", lower_limit=limits[0], upper_limit=limits[1])
    return sample_summary(measure, Sample.of(measure, Outcome(values), Grid.empty(-40.0, 1e-3, 80_000), {}), asked)


LAWS = {
    "exponential": (stats.expon(), None, 6.0),
    "rayleigh": (stats.rayleigh(), 0.0, 3.5),
    "truncated normal": (stats.truncnorm(0.0, 3.0), -0.1, 3.0),
    "uniform": (stats.uniform(-1.0, 2.0), -0.9, 1.2),
}


@pytest.mark.parametrize(("law", "lower", "upper"), LAWS.values(), ids=LAWS)
def test_ppk_of_a_law_that_is_not_normal_is_that_of_its_quantiles(law: Any, lower: float | None, upper: float) -> None:
    """(U - x50)/(x99.865 - x50), (x50 - L)/(x50 - x0.135) of ISO 22514-2, the smaller; errors of the quantiles by n."""
    n = 100_000
    own = summary(law.rvs(n, random_state=3), lower, upper)
    low, middle, high = law.ppf([LOW, MIDDLE, HIGH])
    sides = [(upper - middle) / (high - middle)]
    sides += [] if lower is None else [(middle - lower) / (middle - low)]
    errors = [math.sqrt(p * (1 - p) / n) / law.pdf(law.ppf(p)) for p in (LOW, MIDDLE, HIGH)]
    bound = 5 * max(sides) * max((errors[2] + errors[1]) / (high - middle), (errors[0] + errors[1]) / (middle - low))
    assert own.ppk_by == "quantiles"
    assert own.ppk == pytest.approx(min(sides), abs=bound)
    if lower is not None:
        assert own.pp == pytest.approx((upper - lower) / (high - low), rel=5 * (errors[0] + errors[2]) / (high - low))


def test_a_uniform_law_between_its_own_ends_has_ppk_1_and_none_out() -> None:
    """It said 0.58, 1/sqrt(3), beside OK."""
    own = summary(stats.uniform(-1.0, 2.0).rvs(5000, random_state=1), -1.0, 1.0)
    assert own.ppk == pytest.approx(1 / (2 * HIGH - 1), abs=0.02)
    assert own.ppk_reason == "excess kurtosis -1.20"


def test_values_of_a_normal_law_have_ppk_by_mean_and_sigma() -> None:
    """Five standard errors are passed by chance once in two million; limits at 6 sigma lie beyond what n tells."""
    for seed in range(100):
        values = np.random.default_rng(seed).normal(size=1000)
        own = summary(values, -6.0, 6.0)
        assert own.ppk_by == "mean and sigma"
        assert own.ppk_reason is None
        assert own.ppk == pytest.approx((6 - abs(values.mean())) / (3 * values.std(ddof=1)))


def test_standard_errors_of_skewness_and_kurtosis_are_those_of_samples_of_a_normal_law() -> None:
    values = np.random.default_rng(4).normal(size=(40_000, 12))
    for error, found in ((skewness_se(12), stats.skew(values, 1)), (kurtosis_se(12), stats.kurtosis(values, 1))):
        # a variance of N values is known to sqrt((k - 1)/N), k their kurtosis
        bound = 4 * math.sqrt((stats.kurtosis(found, fisher=False) - 1) / len(found))
        assert found.var() / error**2 == pytest.approx(1.0, abs=bound)
    assert skewness_se(2) == kurtosis_se(3) == math.inf


def test_replicates_that_vary_more_than_independent_trials_set_the_error() -> None:
    """0.3 of skewness is 7.7 standard errors of 4000 independent trials, and 2 of replicates: half have none."""
    rng = np.random.default_rng(2)
    straight, skewed = rng.normal(size=2000), rng.gamma(11.0, size=2000)  # a gamma law's skewness is 2/sqrt(11)
    parts = [Moments.of(part / part.std()) for own in (straight, skewed) for part in np.split(own - own.mean(), 4)]
    whole = Moments()
    for part in parts:
        whole = whole.merge(part)
    assert Side(whole, (), lambda p: None).not_normal.startswith("skewness 0.3")
    assert Side(whole, parts, lambda p: None).not_normal == ""


SHAPES = {
    "triangular": stats.triang(0.5, -1.0, 2.0),
    "uniform": stats.uniform(-1.0, 2.0),
    "exponential": stats.expon(),
    "normal": stats.norm(),
    "student": stats.t(5),
    "bathtub": stats.beta(0.8, 0.8, -1.0, 2.0),
}


@pytest.mark.parametrize("law", SHAPES.values(), ids=SHAPES)
def test_verdict_and_ppk_do_not_contradict_each_other(law: Any) -> None:
    """NOT OK by 0.27 % has more than half of that beyond a limit, so a Ppk below 1; OK has none below 0.8."""
    seen = set()
    for n in (1365, 1500, 4000):
        values = law.rvs(n, random_state=n)
        for out in (1e-5, 3e-4, 1e-3, 2e-3, 4e-3, 0.01, 0.1):
            own = summary(values, law.ppf(out / 2), law.ppf(1 - out / 2))
            shown = {"take": "value", "analytic": as_json(own), "lower_limit": -1.0, "upper_limit": 1.0}
            verdict = JudgedMeasure.of(typed_measure(shown)).verdict
            assert own.ppk is not None
            assert not (verdict == "OK" and own.ppk < 0.8), (n, out)
            assert not (verdict == "NOT OK" and own.ppk >= 1.0), (n, out)
            seen.add(verdict)
    assert {"OK", "NOT OK"} <= seen


def test_a_normal_law_that_the_trials_refute_gives_no_ppk() -> None:
    """Nothing of a triangular law lies beyond its ends; a normal one of its sigma would have 1.4 % there."""
    own = summary(stats.triang(0.5, -1.0, 2.0).rvs(1400, random_state=1), -1.0, 1.0)
    assert own.ppk_by == "quantiles"
    assert own.ppk_reason is not None
    assert own.ppk_reason.startswith("a normal law would have 1.")
    assert own.ppk == pytest.approx(1.0, abs=0.1)


def test_quantiles_of_too_few_trials_give_no_ppk_and_say_so() -> None:
    """Less than one of 740 trials lies beyond an outer quantile."""
    values = stats.expon().rvs(FEWEST, random_state=1)
    few, enough = summary(values[1:], None, 9.0), summary(values, None, 9.0)
    assert (few.ppk, few.ppk_by) == (None, "quantiles")
    assert few.ppk_reason is not None
    assert few.ppk_reason.endswith("; under 741 trials")
    assert enough.ppk == pytest.approx((9.0 - math.log(2)) / (math.log(1 / LOW) - math.log(2)), rel=0.5)


def test_where_builds_failed_ppk_is_by_the_share_out_and_the_verdict_says_why() -> None:
    values = np.random.default_rng(1).normal(size=2000)
    values[:4] = np.nan
    own = summary(values, -6.0, 6.0, "sigma")  # asked for or not
    assert own.ppk == pytest.approx(stats.norm.isf(4 / 2000) / 3)
    shown = {"take": "value", "analytic": as_json(own), "lower_limit": -6.0, "upper_limit": 6.0, "unit": "um"}
    text = printed(verdict_table(typed_run({"trials": 2000, "measures": {"gap": shown}})), 200)
    assert "0.96  share out (4 failed)" in text


def test_a_study_may_ask_by_what_ppk_is_taken() -> None:
    values = stats.expon().rvs(2000, random_state=1)
    by_sigma, by_quantiles = (summary(values, None, 9.0, asked) for asked in ("sigma", "quantiles"))
    assert by_sigma.ppk == pytest.approx((9.0 - values.mean()) / (3 * values.std(ddof=1)))
    assert by_sigma.ppk_reason == by_quantiles.ppk_reason == "as asked"
    assert by_quantiles.ppk == summary(values, None, 9.0).ppk
    assert simulation_of(load_scene(SCENES / "every_field.yaml")).study.ppk_by == "quantiles"


# intervals ----------------------------------------------------------------------------------------

STUDIES = 200
MISSED = int(stats.binom(STUDIES, 0.025).ppf(0.9995))  # studies whose bound may lie on the wrong side of the truth


def missed(law: Any, n: int, limits: tuple[float | None, float], asked: PpkBy | None, truth: float) -> tuple[int, int]:
    """Studies with the true Ppk below and above their interval, of a law."""
    below, above, random = 0, 0, np.random.default_rng(n)
    for _ in range(STUDIES):
        low, high = summary(law.rvs(n, random_state=random), *limits, asked).ppk_95 or (None, None)
        below += low is not None and truth < low
        above += high is not None and truth > high
    return below, above


@pytest.mark.parametrize(
    ("law", "n", "lower", "upper"),
    [
        (stats.norm(1.0, 2.0), 30, -5.0, 12.0),  # the lower limit decides
        (stats.norm(1.0, 2.0), 200, -7.0, 9.0),  # both may
        (stats.gamma(11), 150, None, 25.0),  # skewness 0.6
        (stats.uniform(-1.0, 3.0), 100, -1.3, 2.4),
    ],
)
def test_ppk_by_mean_and_sigma_lies_in_its_interval(law: Any, n: int, lower: float | None, upper: float) -> None:
    margins = [upper - law.mean()] + ([] if lower is None else [law.mean() - lower])
    below, above = missed(law, n, (lower, upper), "sigma", min(margins) / (3 * law.std()))
    assert max(below, above) <= MISSED


@pytest.mark.parametrize(("law", "n"), [(stats.expon(), 4000), (stats.truncnorm(0.0, 3.0), 3000), (stats.expon(), 900)])
def test_ppk_by_quantiles_lies_in_its_interval(law: Any, n: int) -> None:
    low, middle, high = law.ppf([LOW, MIDDLE, HIGH])
    lower, upper = middle - 1.5 * (middle - low), middle + 1.2 * (high - middle)
    below, above = missed(law, n, (lower, upper), "quantiles", 1.2)
    assert max(below, above) <= MISSED


def test_outer_quantiles_lie_in_their_intervals_and_have_none_of_few_trials() -> None:
    """No value of 2730 lies beyond the 0.135 % quantile with a chance of 2.5 %: (1 - 0.00135)^n = 0.025."""
    assert (1 - LOW) ** 2731 < 0.025 < (1 - LOW) ** 2730
    random, law, beside = np.random.default_rng(3), stats.gamma(3), [0, 0, 0, 0]
    for _ in range(STUDIES):
        own = summary(law.rvs(3000, random_state=random))
        assert own.p0_135_95 is not None
        assert own.p99_865_95 is not None
        ends = [*zip(own.p0_135_95, law.ppf([LOW, LOW]), strict=True)]
        ends += zip(own.p99_865_95, law.ppf([HIGH, HIGH]), strict=True)
        for k, (bound, truth) in enumerate(ends):
            assert bound is not None
            beside[k] += bound > truth if k % 2 == 0 else bound < truth
    assert max(beside) <= MISSED
    few = summary(law.rvs(2730, random_state=random))
    assert few.p0_135_95 is not None
    assert few.p0_135_95[0] is None
    assert few.p0_135_95[1] is not None


def test_bounds_by_quantiles_are_order_statistics() -> None:
    """Of 100 000 values the ranks are those of scipy's binomial law, read from the grid to two bins of 0.001 um."""
    values = np.sort(stats.gamma(3).rvs(100_000, random_state=5))
    own = summary(values)
    low, high = int(stats.binom(100_000, LOW).ppf(0.025)), int(stats.binom(100_000, LOW).ppf(0.975)) + 1
    assert own.p0_135_95 == pytest.approx([values[low - 1], values[high - 1]], abs=2e-3)
    assert own.p99_865_95 == pytest.approx([values[-high], values[-low]], abs=2e-3)


def test_where_builds_failed_the_interval_is_that_of_the_share_out() -> None:
    values = np.random.default_rng(1).normal(size=2000)
    values[:4] = np.nan
    share = stats.binomtest(4, 2000).proportion_ci(0.95, "exact")
    assert summary(values, -6.0, 6.0).ppk_95 == pytest.approx(stats.norm.isf([share.high, share.low]) / 3)


def test_bounds_of_replicates_are_students() -> None:
    """Eight replicates of 100 trials with a mean of their own each, which independent trials do not tell of."""
    random = np.random.default_rng(6)
    values = random.normal(size=(8, 100)) + random.normal(scale=0.5, size=(8, 1))
    measure = PlainMeasure("gap", "gap", lower_limit=-5.0 * MM, upper_limit=7.0 * MM)
    rows = {k: slice(100 * k, 100 * k + 100) for k in range(8)}
    sample = Sample.of(measure, Outcome(values.ravel()), Grid.empty(-40.0, 1e-3, 80_000), rows)
    parts = (values.mean(axis=1) + 5.0) / (3 * values.std(axis=1, ddof=1))
    half = stats.t(7).ppf(0.975) * parts.std(ddof=1) / math.sqrt(8)
    middle = (values.mean() + 5.0) / (3 * values.std(ddof=1))
    assert sample_summary(measure, sample).ppk_95 == pytest.approx([middle - half, middle + half])


@pytest.mark.parametrize(("asked", "verdict"), [(1.0, "OK"), (1.2, "too few trials"), (1.5, "NOT OK")])
def test_an_accepted_ppk_is_judged_by_the_whole_interval(asked: float, verdict: str) -> None:
    """400 normal trials at 3.6 sigma: 1.2, and 95 % within 1.11 and 1.29."""
    values = stats.norm(2.0, 3.0).ppf((np.arange(400) + 0.5) / 400)
    shown = {
        "take": "value",
        "analytic": as_json(summary(values, -8.8, 40.0)),
        "lower_limit": -8.8,
        "upper_limit": 40.0,
    }
    assert JudgedMeasure.of(typed_measure(shown), AcceptedPpk(asked)).verdict == verdict


def test_what_does_not_vary_has_any_ppk_within_its_limits_and_none_out_of_them() -> None:
    for value, verdict in ((0.5, "OK"), (1.5, "NOT OK")):
        own = summary(np.full(50, value), -1.0, 1.0)
        shown = {"take": "value", "analytic": as_json(own), "lower_limit": -1.0, "upper_limit": 1.0}
        assert JudgedMeasure.of(typed_measure(shown), AcceptedPpk(1.33)).verdict == verdict
