"""Shares that few trials cannot tell from none stand last, in an order without chance, and are said to be so."""

from pathlib import Path

import numpy as np
import pytest

from tol3d import Overrides, run_scene
from tol3d.report.column import Share, ranked_contributors, shares_by_contributor, within_error_words
from tol3d.statistics.estimates import RegressorSums, shares

SENTENCE = "shares of less than 2 standard errors may be chance in so few trials: they stand last"


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_of_few_trials_what_may_be_chance_is_ranked_without_it(seed: int, tmp_path: Path) -> None:
    run = run_scene("spur_pair", overrides=Overrides(trials=60, witness=0, seed=seed), out=tmp_path / "run")
    measure = run.found.measures["normal backlash"]
    assert within_error_words(measure) == f"{SENTENCE}, in the order of high–low–mean"
    found = {own.name: own for own in measure.contributors}
    within = []
    for name in ranked_contributors(measure):
        share, error, alone = (
            found[name][key] for key in ("geometric_percent", "geometric_percent_se", "high_low_mean_percent")
        )
        if share < 2 * error:
            within.append(alone)
        else:
            assert not within, "what trials tell stands before"
    assert within == sorted(within, reverse=True)
    assert len(within) >= 2


def test_of_many_trials_all_that_matters_is_told(tmp_path: Path) -> None:
    run = run_scene("spur_pair", overrides=Overrides(trials=20_000, witness=0), out=tmp_path / "run")
    measure = run.found.measures["normal backlash"]
    assert within_error_words(measure) == ""
    percents = [own.percent for own in shares_by_contributor(measure).values()]
    assert percents == sorted(percents, reverse=True)


def test_a_contributor_without_effect_is_within_its_error() -> None:
    """200 studies of 100 trials: in 5 % a share of none has two standard errors, at most; 3 sigma of the count more."""
    generator, studies, missed = np.random.default_rng(7), 200, 0
    for _ in range(studies):
        features = generator.standard_normal((100, 3))
        target = features @ [3.0, 1.0, 0.0] + 0.7 * generator.standard_normal(100)
        found = shares(RegressorSums.of(features, target), {"a": slice(0, 1), "b": slice(1, 2), "none": slice(2, 3)})
        each = {name: Share(100 * found.share[name], 100 * found.standard_error[name], None) for name in found.share}
        assert not each["a"].is_within_error
        missed += not each["none"].is_within_error
    assert missed <= 0.05 * studies + 3 * np.sqrt(0.05 * 0.95 * studies)


def test_errors_of_contributors_of_a_line_add_up_as_of_independent_ones() -> None:
    line = Share.together([Share(3.0, 2.0, 4.0), Share(2.0, 1.5, 1.0)])
    assert (line.percent, line.error, line.alone) == (5.0, 2.5, 5.0)
    assert not line.is_within_error
    assert Share.together([Share(3.0, 2.0, None), Share(2.0, 1.5, 1.0)]).alone is None
