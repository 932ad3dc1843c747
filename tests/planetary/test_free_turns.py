"""Free turns of planetary sets: the closed form of the 3K paper, HiGHS with rows worked out anew, pairs of gears."""

import math
from fractions import Fraction

import numpy as np
import pytest
from planetary_sets import (
    ALPHA,
    ARCMIN,
    external,
    free_by_highs,
    pitch_rows,
    random_deviations,
    random_set,
    reducer_3k,
    ring,
    set_of,
)

from tol3d.gearing.planetary.exact.contact import Contact
from tol3d.gearing.planetary.first_order.stack_up import StackUp
from tol3d.gearing.planetary.model.deviated import Deviated
from tol3d.gearing.planetary.model.planetary_set import PlanetarySet
from tol3d.gearing.planetary.model.set_mesh import SetGear, SetMesh
from tol3d.gearing.reducers.deviations import Acts
from tol3d.gears import SpurGear, SpurPair
from tol3d.gears.internal_gear import InternalGear
from tol3d.gears.internal_pair import InternalPair

NONE = np.zeros(1)


def thinned(own: PlanetarySet, clearances: dict[str, float]) -> Deviated:
    """Central gears thinned until each flank of their meshes has a clearance [mm] at the working pitch circle."""
    deviated = Deviated.nothing(own, 1)
    for place, mesh in enumerate(own.meshes):
        deviated.central_thickness[:, place] = -2 * clearances[mesh.central.name]
    return deviated


def lost_motion(own: PlanetarySet, deviated: Deviated, shaft: str) -> float:
    found = StackUp(own).free(deviated, NONE, shaft, own.opposite(shaft))
    assert found.status[0] == 0
    return float(found.ends[0, 1] - found.ends[0, 0])


def test_equal_gaps_give_the_published_lost_motion() -> None:
    """Wang et al.: 8 c/((1 - kappa) rS) = 594.043' at the input and 4 c/rR2 = 10.8560' at the output, c = 0.03 mm."""
    own = reducer_3k()
    deviated = thinned(own, dict.fromkeys(("sun", "ring 1", "ring 2"), 0.03))
    at_input, at_output = lost_motion(own, deviated, "sun"), lost_motion(own, deviated, "ring 2")
    assert at_input == pytest.approx(8 * 0.03 / ((1 - 24 / 27) * 12.5), abs=1e-12)
    assert at_output == pytest.approx(4 * 0.03 / 38, abs=1e-12)
    assert round(at_input / ARCMIN, 3) == 594.043
    assert round(at_output / ARCMIN, 4) == 10.8560
    assert at_input / at_output == pytest.approx(54.72, abs=1e-9)


@pytest.mark.parametrize("seed", range(8))
def test_unequal_gaps_of_the_meshes_give_the_closed_form(seed: int) -> None:
    """Wang et al., both sides, for gaps alike in all planets."""
    own, rng = reducer_3k(), np.random.default_rng(seed)
    c_a, c_b, c_c = rng.uniform(0.005, 0.06, 3)
    kappa, r_s, r_r2 = 24 / 27, 12.5, 38.0
    deviated = thinned(own, {"sun": c_a, "ring 1": c_b, "ring 2": c_c})
    at_input = 2 / r_s * (c_a + c_b * (1 + kappa) / (1 - kappa) + 2 * c_c / (1 - kappa))
    at_output = 2 / r_r2 * (c_a * (1 - kappa) / 2 + c_b * (1 + kappa) / 2 + c_c)
    assert lost_motion(own, deviated, "sun") == pytest.approx(at_input, abs=1e-12)
    assert lost_motion(own, deviated, "ring 2") == pytest.approx(at_output, abs=1e-12)


def check_against_highs(seed: int, trials: int = 1) -> int:
    """A random set with unequal gaps, pins and clocking; how many trials have room."""
    rng = np.random.default_rng(seed)
    own = random_set(rng)
    deviated = random_deviations(own, trials, rng, size=float(rng.choice([0.3, 1.0, 2.5])))
    turns = rng.uniform(0, 5, trials)
    shaft = str(rng.choice([own.input, own.output]))
    found = StackUp(own).free(deviated, turns, shaft, own.opposite(shaft))
    seated = 0
    for trial in range(trials):
        wanted = free_by_highs(own, pitch_rows(own, deviated, trial, turns[trial]), shaft, own.opposite(shaft))
        if wanted is None:
            assert found.status[trial] == 1
        else:
            assert found.status[trial] == 0
            seated += 1
            np.testing.assert_allclose(found.ends[trial], wanted, rtol=1e-9, atol=1e-9)
    return seated


def test_random_sets_are_those_of_highs() -> None:
    assert sum(check_against_highs(seed) for seed in range(40)) > 20


@pytest.mark.slow
def test_a_thousand_random_sets_are_those_of_highs() -> None:
    assert 300 < sum(check_against_highs(seed) for seed in range(1000, 2000)) < 1000  # the others have no room


def test_clearances_and_tight_centre_distances_are_those_of_pairs_of_gears() -> None:
    rng = np.random.default_rng(11)
    for _ in range(40):
        own = random_set(rng)
        for mesh in own.meshes:
            pair = pair_of(mesh)
            assert 2 * mesh.clearance == pytest.approx(pair.normal_backlash, abs=1e-12)
            assert mesh.tight_centre_distance == pytest.approx(pair.zero_backlash_centre_distance, abs=1e-9)


def pair_of(mesh: SetMesh, distance: float | None = None) -> SpurPair | InternalPair:
    distance = mesh.centre_distance if distance is None else distance
    own = mesh.planet
    planet = SpurGear(own.teeth, own.module, ALPHA, 10.0, own.profile_shift)
    if mesh.central.is_ring:
        return InternalPair(
            planet, InternalGear(mesh.central.teeth, own.module, ALPHA, 10.0, mesh.central.profile_shift), distance
        )
    return SpurPair(planet, SpurGear(mesh.central.teeth, own.module, ALPHA, 10.0, mesh.central.profile_shift), distance)


def test_pins_outwards_open_suns_and_close_rings_as_centre_distances_do() -> None:
    own, step = reducer_3k(), 1e-5
    deviated = Deviated.nothing(own, 1)
    deviated.pins[:, :, 0] = step
    lower, upper = StackUp(own).sides(deviated, NONE)
    for place, mesh in enumerate(own.meshes):
        opened = pair_of(mesh, mesh.centre_distance + step).normal_backlash - pair_of(mesh).normal_backlash
        assert upper[0, place] - lower[0, place] == pytest.approx(opened, abs=20 * step**2)


def test_a_turn_of_the_carrier_is_a_shift_of_all_pins_round() -> None:
    """Rows of the carrier's turn against the sides of displaced pins: the carrier's turn takes all of it back."""
    rng = np.random.default_rng(2)
    for _ in range(20):
        own, step = random_set(rng), 1e-3
        deviated = Deviated.nothing(own, 1)
        deviated.pins[:, :, 1] = step
        lower, upper = StackUp(own).sides(deviated, NONE)
        by_turn = own.all_rows[:, len(own.meshes)] * step / own.centre_distance  # planets keep their turns in the world
        np.testing.assert_allclose((lower + upper)[0] / 2, -by_turn, rtol=0, atol=1e-15)


def test_all_teeth_meet_again_after_37525_turns_of_the_planets() -> None:
    own = reducer_3k()
    assert own.period_planet_turns == 37_525
    assert own.ratio == Fraction(1368, 25)
    deviated = random_deviations(own, 1, np.random.default_rng(1))
    period = float(own.period)
    free = [StackUp(own).free(deviated, np.array([0.3 + k * period]), "ring 2", "sun").ends for k in (0, 1)]
    np.testing.assert_allclose(free[0], free[1], rtol=0, atol=1e-12)
    third = StackUp(own).free(deviated, np.array([0.3 + period / 5]), "ring 2", "sun").ends
    assert np.abs(third - free[0]).max() > 1e-6


def test_an_offset_of_a_gear_turns_with_it() -> None:
    """The sun turns 54.72 times a turn of the output, the carrier (I1 + 1 = 4.16) 13.15 times: 41.57 against it."""
    own = reducer_3k()
    deviated = thinned(own, dict.fromkeys(("sun", "ring 1", "ring 2"), 0.03))
    deviated.central_offset[0, 0] = (0.005, 0.0)
    relative = 54.72 * (1 - 1 / 4.16)
    turns = np.array([0.0, 1 / relative, 0.25 / relative])
    many = Deviated(*(np.repeat(own_array, 3, axis=0) for own_array in vars(deviated).values()))
    lower, _ = StackUp(own).sides(many, turns)
    np.testing.assert_allclose(lower[0], lower[1], rtol=0, atol=1e-15)
    # a quarter of a turn takes it from planet 1 to planet 2
    first, second = lower[0].reshape(4, 3)[:, 0], lower[2].reshape(4, 3)[:, 0]
    np.testing.assert_allclose(np.roll(first, 1), second, rtol=0, atol=1e-15)


def tooth_0_at_rest(central: SetGear, planet: SetGear) -> float:
    """Azimuth of a central gear's tooth 0 [rad], so that a space of it faces a tooth of a planet, or a tooth a space.

    The planet stands on the azimuth 0 with its own tooth 0 outwards; the side that it turns to a sun is the other one.
    """
    side = 0.0 if central.is_ring else math.pi
    steps = (side / (2 * math.pi) * planet.teeth) % 1.0  # of a pitch from a tooth of the planet to that side
    return math.pi / central.teeth if steps == 0.0 else 0.0 if steps == 0.5 else math.nan


@pytest.mark.parametrize(("name", "planet_teeth"), [("sun", 20), ("sun", 21), ("ring", 20), ("ring", 21)])
def test_eccentricities_of_central_gears_count_from_the_middle_of_their_tooth_0(name: str, planet_teeth: int) -> None:
    """One planet: a sun towards it by d takes 2 sin(alpha_w) d from the backlash, a ring gives as much (DESIGN)."""
    planet, distance, off = external("P", planet_teeth), (14 + planet_teeth) / 2, 1e-5
    gears = {"sun": external("sun", 14), "ring": ring("ring", 14 + 2 * planet_teeth)}
    own = set_of([(gear, planet) for gear in gears.values()], distance, 1, ("ring", "sun", "carrier"))
    taken = -1.0 if name == "sun" else 1.0
    for direction in (0.0, 1.0, 2.5):
        deviated = thinned(own, dict.fromkeys(gears, 1e-4))
        methods: tuple[StackUp | Contact, ...] = (StackUp(own), Contact(own))
        nothing = [method.free(deviated, NONE, "sun", "carrier").ends[0] for method in methods]
        deviated.add(own, Acts("offset", name), off * np.array([[math.cos(direction), math.sin(direction)]]))
        towards = off * math.cos(direction + tooth_0_at_rest(gears[name], planet))
        wanted = taken * 2 * math.sin(ALPHA) * towards / gears["sun"].base_radius
        for method, ends in zip(methods, nothing, strict=True):
            free = method.free(deviated, NONE, "sun", "carrier").ends[0]
            # the sun turns by 3e-5 rad either way within its play, and its offset with it: 1e-4 of 1e-6 rad
            assert np.ptp(free) - np.ptp(ends) == pytest.approx(wanted, abs=1e-9)
        back = [[deviated.term(own, Acts("offset", name), axis[None])[0] for axis in np.eye(2)]]
        np.testing.assert_allclose(back, [[off * math.cos(direction), off * math.sin(direction)]], rtol=0, atol=1e-18)
