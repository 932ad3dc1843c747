"""The exact contact of internal pairs in any pose against a search of their surfaces: rest, backlash and free turns."""

import math

import numpy as np
import pytest
from oracles import internal_brute_force as search
from oracles.internal_brute_force import InternalBuilds, Ring
from oracles.involute_gear import InvoluteGear
from oracles.random_builds import Builds, Spread, random_builds

from tol3d.gearing.engines import OK, OUT_OF_RANGE
from tol3d.gearing.engines.exact import ExactEngine
from tol3d.gearing.model import Reading
from tol3d.gears import LEFT, RIGHT, Flank, InternalGear, InternalPair, SpurGear
from tol3d.gears.flank import opposite

ALPHA = math.radians(20)
BOUND = 5e-6  # mm; 0.005 um. A zoom keeps 2.5 um of the face, times 1 mrad of tilt 0.003 um
PAIRS = {
    "planet": InternalPair(SpurGear(27, 1.0, ALPHA, 10.0), InternalGear(79, 1.0, ALPHA, 9.0, addendum=0.8), 26.0),
    "driving ring": InternalPair(
        InternalGear(66, 1.5, ALPHA, 12.0, profile_shift=-0.25, addendum=0.9),
        SpurGear(22, 1.5, ALPHA, 14.0, profile_shift=0.3),
        32.9,
    ),
    "few teeth of difference": InternalPair(
        SpurGear(40, 1.5, ALPHA, 14.0, addendum=0.6), InternalGear(46, 1.5, ALPHA, 12.0, addendum=0.6), 4.48
    ),
    "wide": InternalPair(SpurGear(40, 2.0, ALPHA, 50.0), InternalGear(60, 2.0, ALPHA, 60.0, addendum=0.7), 20.0),
}
SPREADS = {
    "tilted": Spread(past=0.3, tilt=8e-4, shift=0.03, offset=0.0),
    "warm": Spread(past=0.3, growth=2e-4, offset=0.0, tilt=6e-4, shift=0.02),
    "steep": Spread(tilt=3e-3, shift=0.01, centre=0.005, offset=0.0),
}


def plain(gear: SpurGear | InternalGear, thickness: float, growth: float) -> InvoluteGear | Ring:
    """The plain numbers of a grown gear whose teeth are thicker by an arc."""
    shared = (gear.teeth, gear.module * growth, gear.pressure_angle, gear.face_width * growth)
    if isinstance(gear, SpurGear):
        return InvoluteGear(*shared, gear.profile_shift, gear.addendum, thickness * growth)
    return Ring(*shared, gear.form_radius * growth, gear.profile_shift, gear.addendum, thickness * growth)


def as_searched(builds: Builds, row: int) -> InternalBuilds:
    """One build as the search sees it."""
    pair, made = builds.mesh.pair, builds.made
    assert isinstance(pair, InternalPair)
    driver, driven = (
        plain(gear, 2 * gear.reference_radius * float(made.flank_turn[row, k]), float(made.scale[row, k]))
        for k, gear in enumerate((pair.pinion, pair.wheel))
    )
    shafts, centre = made.world_from_shaft[row : row + 1], made.centre[row : row + 1]
    return InternalBuilds(driver, driven, shafts[:, 0], shafts[:, 1], centre[:, 0], centre[:, 1])


def check(name: str, spread: str, flank: Flank, count: int, seed: int) -> None:
    """Turn at rest, backlash over the flanks and free turn of the driven gear."""
    pair = PAIRS[name]
    builds = random_builds(pair, flank, count, seed, spread=SPREADS[spread], thinner=0.15)
    engine = ExactEngine(builds.model)
    seen = engine.read(builds.made, builds.mesh, Reading(), builds.driver_angle, frozenset({"pinion", "wheel"}))
    assert set(seen.status) <= {OK, OUT_OF_RANGE}
    rows = np.flatnonzero(seen.status == OK)
    assert 2 * len(rows) > count
    for row in rows.tolist():
        one, angle = as_searched(builds, row), builds.driver_angle[row : row + 1]
        rest = search.turn_until_contact(one, angle, search.tooth_in_space(one, angle), flank)
        assert seen.driven_angle[row] * pair.wheel.base_radius == pytest.approx(
            rest[1][0] * pair.wheel.base_radius, abs=BOUND
        )
        gap = search.smallest_distance(one, *rest, opposite(flank))
        assert seen.gap[row] == pytest.approx(gap[0], abs=BOUND)
        for turn, arm, turn_driver in (
            (seen.driven_turn, pair.wheel.base_radius, False),
            (seen.driver_turn, pair.pinion.base_radius, True),
        ):
            other = search.turn_until_contact(one, *rest, opposite(flank), turn_driver=turn_driver)
            free = abs(other[0 if turn_driver else 1][0] - rest[0 if turn_driver else 1][0])
            assert turn[row] * arm == pytest.approx(free * arm, abs=BOUND)


def test_seats_and_backlash_in_any_pose_are_those_of_a_search_of_the_surfaces() -> None:
    check("planet", "tilted", RIGHT, 1, 1)
    check("driving ring", "warm", LEFT, 1, 2)


@pytest.mark.slow
@pytest.mark.parametrize("name", PAIRS)
@pytest.mark.parametrize("spread", SPREADS)
@pytest.mark.parametrize("flank", [RIGHT, LEFT], ids=["right", "left"])
def test_in_many_poses_too(name: str, spread: str, flank: Flank) -> None:
    check(name, spread, flank, 6, 3)
