"""Proposals of refused pairs: whoever follows one has a pair that is accepted."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest

from tol3d.errors import GeometryError
from tol3d.gears import LEFT_HAND, SpurGear, SpurPair
from tol3d.gears.remedies import remedy

ALPHA = math.radians(20.0)


def refusal_of(pair: SpurPair) -> str:
    """Text of a refusal; "" of a pair that is accepted."""
    try:
        pair.refuse_interference()
    except GeometryError as error:
        return str(error)
    return ""


def followed(pair: SpurPair, proposal: str) -> SpurPair:
    """The pair made as its proposal says, read from the words."""
    number = r"(-?[\d.]+(?:e-?\d+)?)"
    pinion, wheel, apart = pair.pinion, pair.wheel, pair.centre_distance
    if found := re.search(rf"profile_shift {number} of the driver and {number} of the driven gear", proposal):
        pinion = replace(pinion, profile_shift=float(found[1]))
        wheel = replace(wheel, profile_shift=float(found[2]))
    if found := re.search(rf"centre distance of {number} mm", proposal):
        apart = float(found[1])
    if found := re.search(rf"addendum {number} of the driven gear", proposal):
        wheel = replace(wheel, addendum=float(found[1]))
    elif found := re.search(rf"addendum {number} of the driver", proposal):
        pinion = replace(pinion, addendum=float(found[1]))
    elif found := re.search(rf"addendum {number} of both gears", proposal):
        pinion, wheel = (replace(gear, addendum=float(found[1])) for gear in (pinion, wheel))
    elif found := re.search(rf"addendum {number} and {number}", proposal):
        pinion, wheel = replace(pinion, addendum=float(found[1])), replace(wheel, addendum=float(found[2]))
    return SpurPair(pinion, wheel, apart)


@pytest.mark.slow
@pytest.mark.parametrize("helical", [False, True])
def test_pairs_that_follow_their_proposals_are_accepted(helical: bool) -> None:
    """25 random refused pairs each: tips in roots, undercut, short contact; nearly all have a proposal."""
    rng, refused, without = np.random.default_rng(8), 0, 0
    while refused < 25:
        beta = math.radians(float(rng.uniform(8.0, 30.0))) if helical else 0.0
        module, face = float(rng.uniform(1.0, 4.0)), float(rng.uniform(10.0, 40.0))
        (z1, z2), (x1, x2) = rng.integers(10, 70, 2).tolist(), rng.uniform(-0.5, 1.1, 2).tolist()
        (h1, h2), far = rng.uniform(0.8, 1.3, 2).tolist(), float(rng.uniform(0.99, 1.03))
        try:
            pinion = SpurGear(z1, module, ALPHA, face, x1, h1, helix_angle=beta)
            wheel = SpurGear(z2, module, ALPHA, face, x2, h2, helix_angle=beta, hand=LEFT_HAND)
            apart = far * module * ((z1 + z2) / 2 / math.cos(beta) + (x1 + x2) * float(rng.integers(0, 2)))
            pair = SpurPair(pinion, wheel, apart)
        except GeometryError:
            continue
        if not refusal_of(pair):
            continue
        refused += 1
        proposal = remedy(pair)
        if not proposal:
            without += 1
            continue
        after = followed(pair, proposal)
        assert refusal_of(after) == "", proposal
        assert after.normal_backlash >= min(pair.normal_backlash, 0.0) - 1e-3, proposal
    assert without <= 2


def test_shifts_that_sum_to_2_2_are_told_which_would_do() -> None:
    pinion, wheel = (SpurGear(z, 2.0, ALPHA, 10.0, profile_shift=1.1) for z in (20, 30))
    proposal = remedy(SpurPair(pinion, wheel, 50.0))
    assert proposal == "; profile_shift 0 of the driver and 0 of the driven gear would do"


@pytest.mark.parametrize("beta", [0.0, 20.0])
def test_pointed_teeth_are_told_the_addendum_that_leaves_a_tip(beta: float) -> None:
    gear = {"teeth": 12, "module": 2.0, "pressure_angle": ALPHA, "face_width": 10.0, "profile_shift": 1.1}
    with pytest.raises(GeometryError, match="pointed teeth") as caught:
        SpurGear(**gear, helix_angle=math.radians(beta))  # type: ignore[arg-type]
    found = re.search(r"addendum below (-?[\d.]+)", str(caught.value))
    assert found is not None
    made = SpurGear(**gear, addendum=float(found[1]) - 1e-4, helix_angle=math.radians(beta))  # type: ignore[arg-type]
    assert 0.0 < made.tip_thickness < 0.01 * made.module
