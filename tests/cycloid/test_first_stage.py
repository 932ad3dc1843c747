"""The first stage of an RV reducer against closed forms, and what a turn of the cranks does to the output."""

import math
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from numpy.typing import NDArray
from places import SCENES

from tol3d import load_scene
from tol3d.gearing.cycloid.from_scene import rv_system
from tol3d.gearing.cycloid.reducer.deviated import RVDeviated
from tol3d.gearing.cycloid.reducer.first_stage import crank_turns, first_order_mesh, placed_mesh
from tol3d.gearing.cycloid.reducer.rv_set import RVSet
from tol3d.gearing.cycloid.reducer.turning import ExactTurning, LinearTurning
from tol3d.gears import LEFT, RIGHT, Displaced, Flank

OWN: RVSet = rv_system(load_scene(SCENES / "rv_250aii.yaml")).own
TURNS = np.linspace(0.0, 1.0, 241)[None]
ALPHA, BASE = math.radians(20.0), 42.0 * math.cos(math.radians(20.0))  # of a planet: 42 teeth of 2 mm
WEIGHT = 1 / 40.5  # Zc + 1 + z1/z2: 1/81 of the sun's turn, which is half of a planet's


def deviated() -> RVDeviated:
    return RVDeviated.nothing(OWN, 1)


def test_the_ratio_is_81_and_a_turn_of_a_disc_counts_less_while_the_sun_stands() -> None:
    assert OWN.ratio == 81
    assert OWN.period == 1  # 80 turns of the sun against the carrier, 40 of the planets
    assert pytest.approx(80 / 81 * 39 / 40, abs=1e-12) == 1 / (1 + OWN.rolling / 39)
    assert pytest.approx(40.5, abs=1e-12) == OWN.crank_arm


@pytest.mark.parametrize(("sense", "sign"), [(-1, 1.0), (1, -1.0)])
def test_thin_teeth_let_the_cranks_turn_by_half_the_thinning_over_the_base_radius(sense: int, sign: float) -> None:
    own = deviated()
    own.sun_thickness[...] = -0.04
    own.planet_thickness[...] = -0.02
    for mesh in (placed_mesh, first_order_mesh):
        found, _ = crank_turns(OWN, own, TURNS, sense, mesh)
        assert found == pytest.approx(sign * 0.06 * math.cos(ALPHA) / 2 / BASE, rel=1e-9)


def test_one_thick_planet_holds_all_cranks() -> None:
    own = deviated()
    own.planet_thickness[0] = [-0.03, -0.01, -0.02]
    found, planets = crank_turns(OWN, own, TURNS, -1, placed_mesh)
    assert set(planets.ravel()) == {1}
    assert found == pytest.approx(0.01 * math.cos(ALPHA) / 2 / BASE, rel=1e-9)


def test_an_eccentric_planet_swings_by_its_eccentricity_over_the_base_radius() -> None:
    own = deviated()
    own.planet_thickness[0, 1:] = -1.0  # out of touch
    own.planet_offset[0, 0, 0] = 0.01
    for mesh in (placed_mesh, first_order_mesh):
        found = crank_turns(OWN, own, np.linspace(0.0, 1.0, 4801)[None], -1, mesh)[0][0]
        assert (found.max() - found.min()) / 2 == pytest.approx(0.01 / BASE, rel=2e-3)
        spectrum = np.abs(np.fft.rfft(found[:-1]))[1:]
        assert spectrum.argmax() + 1 == 40  # turns of a planet against the carrier


@pytest.mark.parametrize("flank", [LEFT, RIGHT])
def test_placed_planets_turn_to_where_the_flanks_of_a_pair_touch(flank: Flank) -> None:
    """Their centres lie where the turn found has them; another iteration moves them by some 1e-6 of the turn."""
    rng, carried = np.random.default_rng(3), 1e-3
    own = RVDeviated.nothing(OWN, 3)
    for each in (own.sun_offset, own.planet_offset, own.stage.carrier_holes, own.stage.carrier_offsets):
        each[...] = rng.normal(0.0, 0.02, each.shape)
    for each in (own.sun_thickness, own.planet_thickness):
        each[...] = rng.uniform(-0.05, -0.01, each.shape)
    found, pair, ones = placed_mesh(OWN, own, TURNS, 1, flank, carried), OWN.pair, np.ones(TURNS.shape[1])
    crank = np.exp(-2j * np.pi / 3)  # seen in the frame of the second crank
    for trial in range(3):
        sun = 2 * np.pi * (2 * 40 * TURNS[0] - 1 / 3) - carried
        planet = pair.driven_angle(sun)
        at_sun = complex(*own.sun_offset[trial]) * np.exp(1j * sun)
        at_planet = 63.0 + crank * complex(*(own.stage.carrier_holes[trial, 1] + own.stage.carrier_offsets[trial]))
        at_planet = at_planet + complex(*own.planet_offset[trial, 1]) * np.exp(1j * (planet + found[trial]))
        places = np.stack([np.stack([at.real, at.imag, 0.0 * ones], axis=-1) for at in (at_sun, at_planet)], axis=1)
        flank_turns = np.array([own.sun_thickness[trial] / 42.0, own.planet_thickness[trial, 1] / 84.0])
        displaced = Displaced(places, np.zeros_like(places), np.outer(ones, flank_turns))
        turned = pair.touching_angle(sun, flank, displaced) - planet
        assert np.abs(turned).max() > 3e-4
        assert found[trial] == pytest.approx(turned, rel=1e-5)


@pytest.mark.parametrize("size", [0.02, 0.01])
def test_both_methods_of_a_mesh_differ_by_second_order(size: float) -> None:
    rng = np.random.default_rng(5)
    own = RVDeviated.nothing(OWN, 40)
    for each in (own.sun_offset, own.planet_offset, own.stage.carrier_holes, own.stage.carrier_offsets):
        each[...] = rng.normal(0.0, size, each.shape)
    exact, first = (crank_turns(OWN, own, TURNS, -1, mesh)[0] for mesh in (placed_mesh, first_order_mesh))
    # e^2 / (2 a r_b tan alpha) of a displacement of some 4 e, by which the line of centres turns and opens
    assert np.abs(exact - first).max() < 2 * (4 * size) ** 2 / (63.0 * BASE * math.tan(ALPHA))
    assert np.abs(exact - first).max() > 0.0


def crank_turned(angle: float) -> RVDeviated:
    found = deviated()
    found.stage.crank_phases[...] = angle
    return found


def test_a_turn_of_all_cranks_is_the_same_stage_at_another_crank_angle() -> None:
    beta = 2e-3
    phis = np.linspace(0.0, 6.0, 61)[None]
    turned = OWN.contact.touches(crank_turned(beta).stage, phis, (-1.0,)).turns[..., 0]
    moved = OWN.contact.touches(deviated().stage, phis + beta * 39 / 40.5, (-1.0,)).turns[..., 0]
    assert turned == pytest.approx(moved - beta * WEIGHT, abs=1e-12)


def test_rates_are_differences_of_the_analytic_method() -> None:
    rng = np.random.default_rng(2)
    method, own = LinearTurning(OWN), RVDeviated.nothing(OWN, 30)
    arrays = (own.sun_offset, own.planet_offset, own.stage.carrier_holes, own.stage.disc_offsets, own.stage.pins)
    for each in (*arrays, own.sun_thickness, own.planet_thickness, own.stage.crank_phases):
        each[...] = rng.normal(0.0, 0.003, each.shape)
    turns: NDArray[np.float64] = rng.random(30)
    twice = np.stack([turns, turns], axis=1)  # at several positions cranks keep their angle
    before = method.turned(own, twice, -1)
    rates = method.rates(own.disc_tilts, turns, before, -1)
    steps = (
        rates.sun_offset,
        rates.planet_offset,
        rates.stage.carrier_holes,
        rates.stage.disc_offsets,
        rates.stage.pins,
    )
    step, expected = 1e-9, np.zeros(30)
    for each, rate in zip(
        (*arrays, own.sun_thickness, own.planet_thickness, own.stage.crank_phases),
        (*steps, rates.sun_thickness, rates.planet_thickness, rates.stage.crank_phases),
        strict=True,
    ):
        along = rng.normal(0.0, 1.0, each.shape)
        each += step * along
        expected += (rate * along).reshape(30, -1).sum(axis=1)
    after = method.turned(own, twice, -1)
    assert (after.turns - before.turns)[:, 0] / step == pytest.approx(expected, rel=1e-5, abs=1e-7)


@pytest.mark.parametrize(("sense", "method"), [*product((1, -1), (ExactTurning, LinearTurning))])
def test_phases_of_cranks_are_turns_of_their_planets_of_which_the_first_holds(
    sense: int, method: type[ExactTurning | LinearTurning]
) -> None:
    """A perfect stage turns with its cranks, and those until the planet that has least room touches."""
    plain, own = RVDeviated.nothing(OWN, 20), RVDeviated.nothing(OWN, 20)
    own.stage.crank_phases[...] = np.random.default_rng(3).normal(0.0, 3e-4, own.stage.crank_phases.shape)
    least = own.stage.crank_phases.max(axis=1) if sense > 0 else own.stage.crank_phases.min(axis=1)
    turns = np.full((20, 1), 0.3)
    backlash = crank_turns(OWN, plain, turns, sense, placed_mesh)[0]
    found = method(OWN).turned(own, turns, sense)
    nominal = replace(OWN, first=None)
    phis = turns - (backlash + least[:, None]) / (2 * np.pi * OWN.crank_arm)  # of the output, cranks held there
    there = method(nominal).turned(plain, phis, sense).turns
    assert there == pytest.approx(0.0, abs=1e-4)
    assert found.turns == pytest.approx(there - (backlash + least[:, None]) / OWN.crank_arm, abs=1e-7)
    assert (own.stage.crank_phases[np.arange(20), found.planets[:, 0]] == least).all()
