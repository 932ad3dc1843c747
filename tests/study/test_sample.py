"""Statistics of one method's sample, as summary.json shows them."""

import json

import numpy as np
import pytest
from scipy import stats

from tol3d.statistics.estimates import Grid
from tol3d.study.runs.summary.sample import Sample as SampleSummary
from tol3d.study.runs.summary.values import as_json
from tol3d.study.system.outcome import Outcome
from tol3d.study.system.plain import PlainMeasure
from tol3d.study.system.pooled_statistic import HalfSpan
from tol3d.study.tallies.sample import Sample, sample_summary

TRIALS = 100_000
BIN = 1e-3


def sample_of(values: np.ndarray, measure: PlainMeasure) -> Sample:
    return Sample.of(measure, Outcome(values), Grid.empty(-20.0, BIN, 40_000), {})


def test_a_measure_s_own_statistics_stand_in_its_samples() -> None:
    """Half the span of 99.73 % of an exponential: (ln 1/0.00135 - ln 1/0.99865)/2 of its scale."""
    rng = np.random.default_rng(5)
    values = rng.exponential(1.0, TRIALS)
    measure = PlainMeasure("error", "error", pooled_statistics=(HalfSpan(),))
    found = sample_summary(measure, sample_of(values, measure))
    low, high = stats.expon.ppf([0.00135, 0.99865])
    # a quantile's standard error is sqrt(p(1-p)/n) over the density there, 0.00135 at the high end
    error = np.sqrt(0.00135 / TRIALS) / 0.00135
    assert found["pooled"]["half_span"] == pytest.approx((high - low) / 2, abs=5 * error / 2)
    assert found["pooled"]["half_span"] == pytest.approx((found["p99.865"] - found["p0.135"]) / 2, abs=BIN)
    assert SampleSummary.model_validate(json.loads(json.dumps(as_json(found)))).pooled == found["pooled"]


def test_a_measure_without_any_has_no_such_key() -> None:
    measure = PlainMeasure("error", "error")
    assert "pooled" not in sample_summary(measure, sample_of(np.array([1.0, 2.0]), measure))


def test_a_statistic_of_no_trials_is_unknown() -> None:
    measure = PlainMeasure("error", "error", pooled_statistics=(HalfSpan(),))
    assert sample_summary(measure, sample_of(np.array([np.nan]), measure))["pooled"] == {"half_span": None}
