"""Contributors' parts in sums of turns: they add up, and are derivatives."""

from dataclasses import fields, replace

import numpy as np
import pytest
from rv_250 import nothing, random_deviations, rv_250, stage_of

from tol3d.cycloid.deviated import Deviated
from tol3d.cycloid.linear import FirstTouches
from tol3d.cycloid.linear_slopes import part, summed_rates

STAGE = stage_of(rv_250(), rolling=1.5)
PHIS = np.linspace(0.0, 245.0, 60)[None]
TRIALS = 25


def one_kind(own: Deviated, name: str) -> Deviated:
    """All but one kind of deviation taken away."""
    return replace(nothing(len(own.pins)), **{name: getattr(own, name)})


def ranges(found: FirstTouches) -> tuple[np.ndarray, np.ndarray]:
    """Peak to peak, and what it takes of each turn."""
    rows, weights = np.arange(len(found.turns)), np.zeros(found.turns.shape)
    weights[rows, found.turns.argmax(axis=1)] += 1.0
    weights[rows, found.turns.argmin(axis=1)] -= 1.0
    return np.ptp(found.turns, axis=1), weights


def test_parts_of_a_peak_to_peak_add_up_to_it_but_for_the_clearance() -> None:
    stage = stage_of(rv_250(0.0), rolling=1.5)
    own = random_deviations(TRIALS, 3, 2e-3)
    found = stage.touches(own, PHIS)
    peaks, weights = ranges(found)
    slopes = summed_rates(stage, PHIS, found.places, weights)
    parts = sum(part(slopes, one_kind(own, field.name)) for field in fields(own))
    np.testing.assert_allclose(parts, peaks, rtol=1e-12)


@pytest.mark.parametrize("name", [field.name for field in fields(nothing(1))])
def test_slopes_are_derivatives_of_a_mean_over_the_positions(name: str) -> None:
    """A millionth of a micrometre more in a direction of its own, and back: no other pin touches for that."""
    own = random_deviations(TRIALS, 4, 2e-3)
    shape = getattr(own, name).shape
    step = replace(nothing(TRIALS), **{name: np.random.default_rng(5).normal(0.0, 1e-9, shape)})
    weights = np.full((TRIALS, PHIS.shape[1]), 1 / PHIS.shape[1])
    slopes = summed_rates(STAGE, PHIS, STAGE.touches(own, PHIS).places, weights)
    ends = [
        STAGE.touches(replace(own, **{name: getattr(own, name) + sign * getattr(step, name)}), PHIS).turns.mean(axis=1)
        for sign in (1, -1)
    ]
    np.testing.assert_allclose((ends[0] - ends[1]) / 2, part(slopes, step), atol=1e-17, rtol=1e-5)


def test_turns_without_weight_have_no_slopes() -> None:
    found = STAGE.touches(random_deviations(3, 6, 1e-3), PHIS)
    slopes = summed_rates(STAGE, PHIS, found.places, np.zeros(found.turns.shape))
    assert not any(getattr(slopes, field.name).any() for field in fields(slopes))
