"""The RV-250AII of the published example: its discs, tolerances, and deviations of everything."""

import math
from dataclasses import fields

import numpy as np

from tol3d.gearing.cycloid.first_order.linear import LinearStage
from tol3d.gearing.cycloid.model.profile import DiscProfile, Modification
from tol3d.gearing.cycloid.model.stage import Deviated
from tol3d.gearing.cycloid.reducer.formula import Source

SHORTENING = 88.0 / 114.5
CRANK_CIRCLE = 66.0
TOLERANCES: dict[Source, float] = {
    "disc run-out": 0.012,
    "crank run-out": 0.004,
    "pin circle radius": 0.0175,
    "pin pitch": 0.0001,
    "disc pitch": 0.01,
    "disc profile": 0.0005,
    "carrier hole centre": 0.005,
    "main bearing run-out": 0.005,
}


def rv_250(clearance: float = 0.02) -> DiscProfile:
    """A disc that is shifted by so much, its pins ground larger so that nothing is left at the best pin [mm]."""
    own = Modification(shift=-clearance, offset=-clearance * math.sqrt(1 - SHORTENING**2))
    return DiscProfile(pins=40, pin_circle_radius=114.5, pin_radius=5.0, eccentricity=2.2, modification=own)


def stage_of(profile: DiscProfile, discs: int = 2, rolling: float = 0.0) -> LinearStage:
    """Three cranks."""
    return LinearStage(profile, discs=discs, cranks=3, crank_circle=CRANK_CIRCLE, rolling=rolling, window=0.7)


def nothing(trials: int, discs: int = 2) -> Deviated:
    """No deviations."""
    return Deviated.nothing(trials, pins=40, discs=discs, cranks=3)


def random_deviations(trials: int, seed: int, size: float) -> Deviated:
    """Every deviation there is, lengths normal with `size` [mm], angles with that over the pin circle."""
    rng, found = np.random.default_rng(seed), nothing(trials)
    for field in fields(found):
        into = getattr(found, field.name)
        into[...] = rng.normal(0.0, size / 114.5 if field.name == "crank_phases" else size, into.shape)
    return found
