"""Both methods of a cycloid stage, trial by trial, with errors on everything."""

import math

import numpy as np
import pytest
from cycloid_rests import drawn
from cycloid_stages import CRANK_CIRCLE, PROFILE

from tol3d.gearing.cycloid.exact.contact import ContactStage
from tol3d.gearing.cycloid.first_order.linear import LinearStage

STAGE = (PROFILE, 2, 3, CRANK_CIRCLE, 1.5, 0.7)
ARC_SECOND = math.pi / 648_000


def test_what_first_order_neglects_shrinks_with_the_square_of_errors() -> None:
    """A disc without clearance: a tenth of the errors leaves a hundredth of the difference."""
    bare = (PROFILE.__class__(40, 114.5, 5.0, 2.2), *STAGE[1:])
    phis = np.random.default_rng(2).uniform(0, 245, (20, 3))
    off = []
    for scale in (1e-3, 1e-4):
        deviated = drawn(20, scale, seed=5)
        exact, linear = ContactStage(*bare).touches(deviated, phis), LinearStage(*bare).touches(deviated, phis, 1)
        same = exact.places[..., 0] == linear.places
        assert same.mean() > 0.8
        off.append(np.where(same, exact.turns[..., 0] - linear.turns, 0.0))
    ratio = np.abs(off[0]).max() / np.abs(off[1]).max()
    assert 50 < ratio < 200


@pytest.mark.slow
def test_methods_agree_trial_by_trial_in_both_senses() -> None:
    trials = 5000
    deviated, phis = drawn(trials, 0.002, seed=6), np.random.default_rng(3).uniform(0, 245, (trials, 4))
    exact = ContactStage(*STAGE).touches(deviated, phis)
    for s, sense in ((0, 1), (1, -1)):
        linear = LinearStage(*STAGE).touches(deviated, phis, sense)  # type: ignore[arg-type]
        off = (exact.turns[..., s] - linear.turns) / ARC_SECOND
        assert math.sqrt(np.mean(off**2)) < 0.15
        assert np.quantile(np.abs(off), 0.99) < 0.8
        assert (exact.places[..., s] == linear.places).mean() > 0.98
