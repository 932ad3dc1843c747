"""FCL on strips of the CAD solids against involutes: gaps of placed gears, plays of shafts, and their bounds."""

import math
from dataclasses import replace
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from places import SCENES
from planetary_sets import flexible, random_deviations, reducer_3k

from tol3d import Overrides, load_scene, run_scene
from tol3d.cad.solids import FlankStrips, measuring_strips
from tol3d.gearing.planetary.exact.contact import Contact
from tol3d.gearing.planetary.exact.flank_gaps import flank_gaps
from tol3d.gearing.planetary.exact.shown import shown_set
from tol3d.gearing.planetary.first_order.stack_up import play_bound
from tol3d.gearing.planetary.from_scene import planetary_system
from tol3d.gearing.planetary.model.deviated import Deviated
from tol3d.gearing.planetary.model.planetary_set import PlanetarySet
from tol3d.gearing.planetary.system import PlanetarySystem
from tol3d.gearing.planetary.witness import StripContact, StripGaps

Array = NDArray[np.float64]

ROUNDING = 1e-6  # mm; FCL's own, and of points that are put back
STEPS = 120


@pytest.fixture(scope="module")
def system() -> PlanetarySystem:
    return planetary_system(load_scene(SCENES / "reducer_3k_flexible.yaml"))


@pytest.fixture(scope="module")
def strips(system: PlanetarySystem) -> dict[str, FlankStrips]:
    return {name: measuring_strips(gear, STEPS) for name, gear in system.made.items()}


def chords(own: PlanetarySet, strips: dict[str, FlankStrips]) -> list[float]:
    return [strips[mesh.central.name].chord_error + strips[mesh.planet.name].chord_error for mesh in own.meshes]


def lost(method: Contact | StripContact, deviated: Deviated, turns: Array, shaft: str) -> Array:
    free = method.free(deviated, turns, shaft, method.own.opposite(shaft))
    assert (free.status == 0).all()
    return free.ends[:, 1] - free.ends[:, 0]


@pytest.mark.slow
def test_every_gap_of_every_planet_is_that_of_the_involutes_within_both_chord_errors(
    system: PlanetarySystem, strips: dict[str, FlankStrips]
) -> None:
    own, rng = system.own, np.random.default_rng(4)
    engine, limits = StripGaps(own, strips), np.array(chords(own, strips))
    for trial in range(5):
        deviated = random_deviations(own, 1, rng, size=2.0)
        shown = shown_set(own, system.made, deviated, float(rng.uniform(0, 30)))
        assert shown.status == 0, trial
        exact = np.array([gap.value for gap in flank_gaps(own, shown.gears)]).reshape(own.planets, -1, 2)
        found = engine.gaps(shown.gears)
        assert found.shape == (4, 3, 2)
        assert (np.abs(found - exact) < limits[:, None] + ROUNDING).all()
        # of two outer teeth chords lie inside both: it is never too small
        assert (found[:, 0] - exact[:, 0] > -ROUNDING).all()


@pytest.mark.slow
def test_a_gap_of_coarser_strips_is_off_by_the_square_of_their_steps(system: PlanetarySystem) -> None:
    own = system.own
    shown = shown_set(own, system.made, random_deviations(own, 1, np.random.default_rng(8)), 2.2)
    exact = np.array([gap.value for gap in flank_gaps(own, shown.gears)]).reshape(own.planets, -1, 2)
    off = {}
    for steps in (15, 60):
        strips = {name: measuring_strips(gear, steps) for name, gear in system.made.items()}
        off[steps] = np.abs(StripGaps(own, strips).gaps(shown.gears) - exact)
        assert (off[steps] < np.array(chords(own, strips))[:, None] + ROUNDING).all()
    # where on its chord a contact lies is chance, so the means of 24 gaps are compared: a quarter of the steps, 1/16
    assert off[15].mean() / off[60].mean() == pytest.approx(16, rel=0.4)


@pytest.mark.slow
@pytest.mark.parametrize("springs", ["none", "pushing", "set at 0.002 mm"])
def test_plays_by_fcl_are_those_of_the_exact_engine_within_what_chords_may_do(
    system: PlanetarySystem, strips: dict[str, FlankStrips], springs: str
) -> None:
    (spring,) = system.own.springs
    kinds = {"none": (), "pushing": (spring,), "set at 0.002 mm": (replace(spring, displacement=0.002),)}
    own = replace(system.own, springs=kinds[springs])
    rng = np.random.default_rng(9)
    deviated, turns = random_deviations(own, 4, rng), rng.uniform(0, 20, 4)
    method = StripContact(own, system.made, StripGaps(own, strips))
    for shaft in (own.output, own.input):
        off = lost(method, deviated, turns, shaft) - lost(Contact(own), deviated, turns, shaft)
        # each last step may leave 1e-7 mm of each gap, see LAST_MOVE
        bound = 2 * play_bound(own, shaft, chords(own, strips)) + 2 * play_bound(own, shaft, [2e-7] * 3)
        assert np.abs(off).max() < bound
        assert bound < 1e-3 * lost(Contact(replace(own, springs=())), deviated, turns, shaft).mean()


def play_by_unequal_gaps(own: PlanetarySet, sides: Array, shaft: str) -> float:
    """Largest turn of a shaft by scipy's HiGHS, springs left out."""
    from scipy.optimize import linprog

    stands = own.opposite(shaft)
    rows, turn = own.rows(stands), own.objective(stands, shaft)
    both = np.vstack([rows, -rows]), np.concatenate([sides[1], sides[0]])
    return -float(linprog(-turn, A_ub=both[0], b_ub=both[1], bounds=(None, None)).fun)


@pytest.mark.parametrize("shaft", ["ring 2", "sun"])
def test_no_error_of_the_gaps_moves_an_end_by_more_than_the_bound_and_some_by_nearly_as_much(shaft: str) -> None:
    own, rng = reducer_3k(), np.random.default_rng(2)
    errors = (0.4e-3, 0.2e-3, 0.3e-3)
    bound = play_bound(own, shaft, errors)
    moved = []
    for _ in range(40):
        sides = 0.02 * 10 ** rng.uniform(-1.0, 1.0, (2, 12))  # unequal ones let any contacts hold the shaft
        off = np.tile(errors, 4) * rng.choice([-1.0, 1.0], (2, 12))
        moved.append(abs(play_by_unequal_gaps(own, sides + off, shaft) - play_by_unequal_gaps(own, sides, shaft)))
        widened = sides + np.tile(errors, 4)
        moved.append(play_by_unequal_gaps(own, widened, shaft) - play_by_unequal_gaps(own, sides, shaft))
    assert max(moved) <= bound * (1 + 1e-9)
    assert max(moved) > 0.7 * bound


def test_the_bound_is_the_worst_of_all_bases_of_the_rows() -> None:
    """Every choice of independent rows by brute force; of one planet both relations share a row, which opposes them."""
    own = replace(reducer_3k(), planets=2, azimuths=(0.0, math.pi))
    rows, turn = own.rows("sun"), own.objective("sun", "ring 2")
    worst = 0.0
    for chosen in combinations(range(6), 4):
        if abs(np.linalg.det(rows[list(chosen)])) > 1e-6:
            worst = max(worst, np.abs(np.linalg.solve(rows[list(chosen)].T, turn)).sum())
    assert play_bound(own, "ring 2", (1e-3,) * 3) == pytest.approx(1e-3 * worst)
    assert play_bound(flexible(0.01), "ring 2", (1e-3,) * 3) >= 1e-3 * worst


@pytest.mark.slow
def test_a_witness_measures_trials_of_a_run_again(tmp_path: Path) -> None:
    run = run_scene("reducer_3k_flexible", overrides=Overrides(trials=30, witness=4), out=tmp_path / "run")
    assert run.found.witness is not None
    found = run.found.witness.measures["lost motion"]
    assert found.compared == 4
    assert 0.0 < (found.max_abs_difference or 0.0) < found.expected_at_most
    assert run.found.witness.status_differences == 0
