"""A moved set: turned by its ratio, swung through its lost motion, its carrier opened; where its planets touch."""

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from planetary_sets import ARCMIN, CLEARANCE, PAIRS, flexible, random_deviations, reducer_3k, thinned

from tol3d.errors import InputError
from tol3d.gearing.planetary.exact.contact import Contact
from tol3d.gearing.planetary.exact.flank_gaps import flank_gaps
from tol3d.gearing.planetary.exact.shown import MovedSet, ShownSet, opened, shown_set, swung, turned
from tol3d.gearing.planetary.model.deviated import Deviated
from tol3d.gearing.planetary.model.planetary_set import PlanetarySet
from tol3d.gearing.planetary.presenting.shown_gears import PlanetaryDisplay
from tol3d.gears import LEFT, RIGHT, InternalGear, SpurGear

Array = NDArray[np.float64]

ALPHA = math.radians(20)
ALIKE = thinned(CLEARANCE, CLEARANCE, CLEARANCE)
CLOSES = 0.0556  # mm of adjustment, 0.54 of it at each planet: the published lost motion is 0 there


def set_shown(own: PlanetarySet, deviated: Deviated, turns: float = 0.0) -> ShownSet:
    made: dict[str, SpurGear | InternalGear] = {
        gear.name: InternalGear(gear.teeth, 1.0, ALPHA, 10.0, addendum=0.9)
        if gear.is_ring
        else SpurGear(gear.teeth, 1.0, ALPHA, 10.0)
        for gear in own.all_gears
    }
    return shown_set(own, made, deviated, turns)


def gone_round(first: MovedSet, last: MovedSet, name: str) -> float:
    """Turn of a gear in the world [rad], between -pi and pi."""
    one, other = (next(gear for gear in state.gears if gear.name == name).world_from_gear for state in (first, last))
    turn = one[:2, :2].T @ other[:2, :2]
    return math.atan2(turn[1, 0], turn[0, 0])


def place(state: MovedSet, name: str) -> Array:
    return next(gear for gear in state.gears if gear.name == name).world_from_gear[:3, 3]


def nearest_turn(angle: float) -> float:
    return (angle + math.pi) % (2 * math.pi) - math.pi


def test_the_output_follows_the_input_by_the_ratio_while_planets_go_to_their_neighbours_places() -> None:
    states = turned(set_shown(reducer_3k(), ALIKE, 0.3), 7)
    assert len(states) == 7
    first, last = states[0], states[-1]
    # ring 1 held: the carrier makes 1/(1 + 79/25) of the sun's turns, ring 2 25/1368 of them
    quarter = math.pi / 2
    sun = quarter * (1 + 79 / 25)
    assert gone_round(first, last, "ring 1") == pytest.approx(0.0, abs=1e-12)
    assert gone_round(first, last, "sun") == pytest.approx(nearest_turn(sun), abs=1e-9)
    assert gone_round(first, last, "ring 2") == pytest.approx(sun * 25 / 1368, abs=1e-9)
    for planet in range(4):
        there = place(last, f"P1 of planet {planet + 1}")
        assert there == pytest.approx(place(first, f"P1 of planet {(planet + 1) % 4 + 1}"), abs=1e-8)


def test_the_swing_is_the_lost_motion_with_the_input_held() -> None:
    states = swung(set_shown(reducer_3k(), ALIKE), 5)
    swings = [gone_round(states[0], state, "ring 2") for state in states]
    assert swings[-1] == pytest.approx(10.8560 * ARCMIN, abs=5e-5 * ARCMIN)  # 4c/r_R2, as published
    assert swings == pytest.approx([share * swings[-1] for share in (0, 0.25, 0.5, 0.75, 1)], abs=1e-12)
    for still in ("sun", "ring 1"):
        assert gone_round(states[0], states[-1], still) == pytest.approx(0.0, abs=1e-12)


def test_between_both_ends_no_flanks_overlap() -> None:
    own = reducer_3k()
    deviated = random_deviations(own, 1, np.random.default_rng(5))
    for state in swung(set_shown(own, deviated, 1.7), 6):
        # contacts bend by some thousandths of what moves, 60 um
        assert min(gap.value for gap in flank_gaps(own, state.gears)) > -1e-5


def test_the_carrier_opens_from_the_rigid_set_to_none_of_the_lost_motion() -> None:
    own = flexible()
    states = opened(set_shown(own, ALIKE), 5)
    assert states[0].free == pytest.approx(10.8560 * ARCMIN, abs=5e-5 * ARCMIN)
    assert states[-1].free == pytest.approx(0.0, abs=1e-9)
    frees = [state.free for state in states]
    assert frees == sorted(frees, reverse=True)
    ways = [place(states[-1], f"P1 of planet {k}") for k in (1, 2, 3, 4)]
    azimuths = [math.atan2(way[1], way[0]) for way in ways]
    pushed = 0.54 * CLOSES / 26.0
    for one, other in ((0, 1), (2, 3)):  # the first of a pair counter-clockwise, the second clockwise
        apart = (azimuths[other] - azimuths[one]) % (2 * math.pi)
        assert apart == pytest.approx(math.pi / 2 - 2 * pushed, abs=2 * 0.54 * 5e-5 / 26.0)
    assert [np.hypot(*way[:2]) for way in ways] == pytest.approx([26.0] * 4, abs=1e-9)


def test_at_the_end_of_the_opening_the_set_is_as_it_is_shown() -> None:
    for springs in (flexible().springs, PAIRS):
        own = replace(reducer_3k(), springs=springs)
        shown = set_shown(own, random_deviations(own, 1, np.random.default_rng(3)), 0.4)
        last = opened(shown, 3)[-1]
        for moved, still in zip(last.gears, shown.gears, strict=True):
            assert moved.world_from_gear == pytest.approx(still.world_from_gear, abs=1e-12)


def test_opened_planets_of_a_pair_touch_opposite_flanks() -> None:
    """With equal gaps the ring of the second gear stops one planet of a pair counter-clockwise, the other clockwise."""
    own = flexible()
    last = opened(set_shown(own, ALIKE), 2)[-1]
    touching = {(gap.planet, gap.flank) for gap in flank_gaps(own, last.gears) if gap.mesh == 2 and gap.value < 1e-6}
    assert touching in ({(0, one), (2, one), (1, -one), (3, -one)} for one in (LEFT, RIGHT))


def test_gaps_of_placed_gears_are_those_of_the_contacts_and_meet_on_both_flanks() -> None:
    """Both gaps of a mesh together are the normal backlash: thinned by c a flank 2 c cos(alpha), at any turn."""
    own = reducer_3k()
    shown = set_shown(own, thinned(0.01, 0.02, 0.03), 0.77)
    gaps = list(flank_gaps(own, shown.gears))
    assert len(gaps) == 2 * 3 * 4
    for k in range(4):
        for m in range(3):
            both = [gap for gap in gaps if (gap.planet, gap.mesh) == (k, m)]
            assert sum(gap.value for gap in both) == pytest.approx(2 * (0.01, 0.02, 0.03)[m] * math.cos(ALPHA))
            assert min(gap.value for gap in both) > -1e-9
            radii = [np.hypot(*(gap.point - place_of(shown, gap.bodies[1]))[:2]) for gap in both]
            assert all(abs(radius - both_teeth(own, m) / 2) < 1.0 for radius in radii)  # near the pitch circle
    assert min(gap.value for gap in gaps) == pytest.approx(0.0, abs=1e-9)


def place_of(shown: ShownSet, name: str) -> Array:
    return next(gear.world_from_gear[:3, 3] for gear in shown.gears if gear.name == name)


def both_teeth(own: PlanetarySet, mesh: int) -> int:
    return own.meshes[mesh].planet.teeth


def test_a_set_that_jams_or_cannot_open_says_so() -> None:
    assert PlanetaryDisplay("rigid", set_shown(reducer_3k(), ALIKE)).motions == ("turn", "swing")
    assert PlanetaryDisplay("flexible", set_shown(flexible(), ALIKE)).motions == ("opening", "turn", "swing")
    jams = set_shown(reducer_3k(), thinned(-0.05, -0.05, -0.05))
    with pytest.raises(InputError, match="jams"):
        PlanetaryDisplay("tight", jams).motion("turn", 3)
    with pytest.raises(InputError, match="jams"):
        turned(jams, 3)
    with pytest.raises(InputError, match="does not open"):
        opened(set_shown(flexible(0.0), ALIKE), 3)


def test_sets_of_one_end_are_seated_as_a_load_has_them() -> None:
    """While the input turns counter-clockwise the output's load holds it back: at the lower end of its play."""
    own = reducer_3k()
    shown = set_shown(own, ALIKE, 0.1)
    free, _ = Contact(own).seated(ALIKE, np.array([0.1]), "ring 2", "sun")
    assert turned(shown, 2)[0].at[2] == pytest.approx(free.ends[0, 0], abs=1e-12)
