"""Deviations of every kind at once, from their fields to the first contact, against a search that places each part."""

import math
from dataclasses import fields, replace

import numpy as np
import pytest
from oracles.placed_discs import PlacedDiscs

from tol3d.gearing.cycloid.exact.contact import ContactStage
from tol3d.gearing.cycloid.model.profile import DiscProfile, Modification
from tol3d.gearing.cycloid.model.stage import Deviated

PROFILE = DiscProfile(40, 114.5, 5.0, 2.2, Modification(-0.02, -0.0128, 2e-5))
CRANK_CIRCLE = 63.0


def drawn(trials: int, seed: int) -> Deviated:
    rng = np.random.default_rng(seed)
    nothing = Deviated.nothing(trials, 40, 2, 3)
    sizes = {field.name: 2e-5 if field.name == "crank_phases" else 0.003 for field in fields(nothing)}
    return replace(
        nothing, **{name: size * rng.standard_normal(getattr(nothing, name).shape) for name, size in sizes.items()}
    )


@pytest.mark.slow
@pytest.mark.parametrize("rolling", [0.0, 1.5])
def test_first_contacts_of_builds_with_every_deviation_are_those_of_a_search(rolling: float) -> None:
    """Outlines are sampled every 1e-5 rad, 1 um; a parabola is good to 1e-9 mm there, and levers are over 60 mm."""
    deviated = drawn(3, seed=31)
    phis = np.random.default_rng(32).uniform(0, 2 * math.pi * 39, (3, 1))
    found = ContactStage(PROFILE, 2, 3, CRANK_CIRCLE, rolling, 0.7).touches(deviated, phis)
    for trial in range(3):
        own = {field.name: getattr(deviated, field.name)[trial] for field in fields(deviated)}
        build = PlacedDiscs((40, 114.5, 5.0, 2.2, CRANK_CIRCLE), (114.48, 4.9872, 2e-5), rolling, own)
        for s, sense in enumerate((1, -1)):
            turn, place = build.first(float(phis[trial, 0]), sense, 0.7)
            assert found.places[trial, 0, s] == place
            assert abs(found.turns[trial, 0, s] - turn) * 85.8 < 1e-6  # mm
