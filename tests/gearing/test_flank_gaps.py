"""Gaps at stated poses and turns: against closed forms, against the engine, and their rates against differences."""

import math
from dataclasses import replace

import numpy as np
import pytest
from gearing.engine_gaps import FlankGap, GearRows, flank_gap
from oracles.random_builds import Builds, Spread, random_builds

from tol3d.gearing.engines.exact import ExactEngine
from tol3d.gears import LEFT, RIGHT, Flank, InternalGear, InternalPair, SpurGear, SpurPair

ALPHA = math.radians(20)
STEP = 1e-5  # rad or mm; of differences, whose error goes with its square over a radius
PLANET = SpurGear(27, 1.0, ALPHA, 10.0)
RING = InternalGear(79, 1.0, ALPHA, 9.0, addendum=0.8)
PAIRS: dict[str, SpurPair | InternalPair] = {
    "external": SpurPair(SpurGear(25, 1.0, ALPHA, 10.0), PLANET, 26.05),
    "internal": InternalPair(PLANET, RING, 25.95),
    "driving ring": InternalPair(RING, PLANET, 25.95),
}


def asked(builds: Builds, flank: Flank, turns: tuple[np.ndarray, np.ndarray], shift: float = 0.0) -> FlankGap:
    """The gap of a side, the driven axis shifted along the gap's normal by so much."""
    made = builds.made
    driver, driven = made.world_from_shaft[:, 0], made.world_from_shaft[:, 1].copy()
    gears = tuple(
        GearRows(made.centre[:, k], made.flank_turn[:, k], made.flank_offset[:, k], made.scale[:, k]) for k in range(2)
    )
    first = flank_gap(builds.mesh.pair, flank, np.linalg.inv(driven) @ driver, turns, (gears[0], gears[1]))
    if not shift:
        return first
    driven[:, :3, 3] += shift * np.einsum("nij,nj->ni", driven[:, :3, :3], first.normal)
    return flank_gap(builds.mesh.pair, flank, np.linalg.inv(driven) @ driver, turns, (gears[0], gears[1]))


@pytest.mark.parametrize("name", PAIRS)
@pytest.mark.parametrize("flank", [RIGHT, LEFT])
def test_the_gap_is_the_engine_s_and_its_rates_are_those_of_differences(name: str, flank: Flank) -> None:
    spread = Spread(tilt=5e-4, shift=0.02, past=0.2, centre=0.01)
    builds = random_builds(PAIRS[name], RIGHT, 40, 2, spread=spread, thinner=0.1)
    pair, driver = builds.mesh.pair, builds.driver_angle
    driven = pair.driven_angle(driver)
    found = asked(builds, flank, (driver, driven))
    teeth, near = pair.candidate_teeth(driver, flank)
    engine = ExactEngine(builds.model).gaps(builds.made, builds.mesh, flank, (driver, driven), teeth, near)
    # the driven shaft's frame instead of the world: rounding of 1e2 mm
    assert np.abs(found.value - engine.smallest()).max() <= 1e-12
    after = [asked(builds, flank, (driver + STEP * (k == 0), driven + STEP * (k == 1))) for k in range(2)]
    before = [asked(builds, flank, (driver - STEP * (k == 0), driven - STEP * (k == 1))) for k in range(2)]
    alike = np.all([each.tooth == found.tooth for each in (*after, *before)], axis=0)
    assert alike.sum() >= 35
    for rate, ahead, back in zip((found.per_driver, found.per_driven), after, before, strict=True):
        # a rate along the valley between two ends of the face jumps; seen 3e-5 where it does not
        differences = (ahead.value - back.value) / (2 * STEP)
        assert np.median(np.abs(differences - rate)[alike]) <= 1e-6
        assert np.abs(differences - rate)[alike].max() <= 1e-2
    shifted = asked(builds, flank, (driver, driven), STEP)
    assert np.abs((shifted.value - found.value) / STEP - 1.0).max() <= 1e-5


@pytest.mark.parametrize("name", PAIRS)
def test_both_sides_together_leave_the_nominal_backlash(name: str) -> None:
    pair, turns = PAIRS[name], np.linspace(-3.0, 3.0, 31)
    pose = np.tile(np.eye(4), (31, 1, 1))
    pose[:, :3, 3] = -pair.wheel_origin
    both = [flank_gap(pair, flank, pose, (turns, pair.driven_angle(turns))) for flank in (RIGHT, LEFT)]
    # the driven space is centred on the tooth: half of it on either side, exact on parallel axes
    for side in both:
        assert np.abs(side.value - pair.normal_backlash / 2).max() <= 1e-12
    thinner = replace(GearRows.nominal(31), flank_turn=np.full(31, -0.05 / pair.pinion.thickness_radius))
    seen = flank_gap(pair, RIGHT, pose, (turns, pair.driven_angle(turns)), (thinner, GearRows.nominal(31)))
    assert np.abs(seen.value - pair.normal_backlash / 2 - 0.05 * math.cos(ALPHA)).max() <= 1e-12
    senses: tuple[Flank, ...] = (RIGHT, LEFT)
    for side, sense in zip(both, senses, strict=True):
        # a gear opens its own right flanks by a turn in the positive sense
        assert side.per_driver == pytest.approx(np.full(31, sense * pair.pinion.base_radius), abs=1e-9)
        opening = pair.mating_flank(sense)
        assert side.per_driven == pytest.approx(np.full(31, opening * pair.wheel.base_radius), abs=1e-9)
