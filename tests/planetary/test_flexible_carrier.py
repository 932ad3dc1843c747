"""Flexible carriers: the published adjustment curve, what unequal gaps leave, springs against torques, both methods."""

import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from places import SCENES
from planetary_sets import (
    ARCMIN,
    CLEARANCE,
    KAPPA,
    ONE,
    PAIRS,
    R_R2,
    R_S,
    flexible,
    pitch_rows,
    random_deviations,
    reducer_3k,
    thinned,
)
from scene_texts import Edit, edited, refusal
from scipy.optimize import linprog

from tol3d import Overrides, load_scene
from tol3d.gearing.planetary.exact.contact import Contact
from tol3d.gearing.planetary.first_order.stack_up import StackUp
from tol3d.gearing.planetary.from_scene import planetary_system
from tol3d.gearing.planetary.model.deviated import Deviated
from tol3d.gearing.planetary.model.planetary_set import PlanetarySet, Spring
from tol3d.study.trials.draws import drawn
from tol3d.study.trials.overrides import simulation_of

Array = NDArray[np.float64]


def lost_motion(method: StackUp | Contact, deviated: Deviated, shaft: str = "ring 2") -> float:
    found = method.free(deviated, np.zeros(1), shaft, method.own.opposite(shaft))
    assert found.status[0] == 0
    return float(found.ends[0, 1] - found.ends[0, 0])


PUBLISHED = {0.0: 10.856, 0.01: 10.639, 0.02: 10.422, 0.03: 9.433, 0.04: 5.742, 0.05: 2.051}


@pytest.mark.parametrize(("adjustment", "minutes"), PUBLISHED.items())
@pytest.mark.parametrize("method", [StackUp, Contact])
def test_lost_motion_falls_with_the_adjustment_as_published(
    method: type[StackUp | Contact], adjustment: float, minutes: float
) -> None:
    """Wang et al., 0.54 of the adjustment at each planet: half the sun's free arc is 4c/(1 - kappa) - 4s and so on."""
    s, c = 0.54 * adjustment, CLEARANCE
    found = lost_motion(method(flexible(s)), thinned(c, c, c))
    half = 4 * c / (1 - KAPPA) - 4 * s
    if s > c / 2:
        half = 2 * c - 4 * s + 2 * ((1 + 3 * KAPPA) * c - 4 * KAPPA * s) / (1 - KAPPA)
    assert found * 1368 / 25 == pytest.approx(2 * half / R_S, abs=1e-9)
    assert round(found / ARCMIN, 3) == minutes


def test_no_lost_motion_is_left_where_the_adjustment_is_c_and_none_fits_beyond() -> None:
    deviated = thinned(CLEARANCE, CLEARANCE, CLEARANCE)
    assert lost_motion(StackUp(flexible(CLEARANCE)), deviated) == pytest.approx(0.0, abs=1e-12)
    beyond = StackUp(flexible(CLEARANCE + 1e-6)).free(deviated, np.zeros(1), "ring 2", "sun")
    assert beyond.status[0] == 1
    assert pytest.approx(0.0556, abs=5e-5) == CLEARANCE / 0.54  # the published zero


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("springs", [ONE, PAIRS], ids=["one spring", "two pairs"])
@pytest.mark.parametrize("method", [StackUp, Contact])
def test_springs_leave_what_unequal_gaps_do_not_close(
    method: type[StackUp | Contact], springs: tuple[Spring, ...], seed: int
) -> None:
    """2 |D|/rR2, D = c_c - kappa c_b - (1 - kappa)(c_a + c_b)/2; by rows of the digest's.

    A spring of its own for each pair changes nothing here: both are stopped alike, at whatever turns of the shafts.
    """
    c_a, c_b, c_c = np.random.default_rng(seed).uniform(0.02, 0.04, 3)
    off = c_c - KAPPA * c_b - (1 - KAPPA) * (c_a + c_b) / 2
    found = lost_motion(method(flexible(springs=springs)), thinned(c_a, c_b, c_c))
    assert found == pytest.approx(2 * abs(off) / R_R2, abs=1e-9)


def left_by_highs(own: PlanetarySet, deviated: Deviated, trial: int, turns: float) -> float | None:
    """Free turn of the output where springs have gone as far as 1 and 0.8 N push, or as set; None: no room."""
    found = pitch_rows(own, deviated, trial, turns)
    columns = [
        [-spring.sense(k) * (-1 if mesh.central.is_ring else 1) for k in range(own.planets) for mesh in own.meshes]
        for spring in own.springs
    ]
    rows = np.column_stack([found.rows, *columns])
    both = np.vstack([rows, -rows]), np.concatenate([found.upper, -found.lower])
    bounds: list[tuple[float | None, float | None]] = [(None, None)] * rows.shape[1]
    for name in (own.held, own.input):
        bounds[own.shafts.index(name)] = (0.0, 0.0)
    forces = np.zeros(rows.shape[1])
    places = range(rows.shape[1] - len(own.springs), rows.shape[1])
    forces[list(places)] = [1.0, 0.8][: len(own.springs)]
    pushed = linprog(-forces, A_ub=both[0], b_ub=both[1], bounds=bounds)
    for place, spring in zip(places, own.springs, strict=True):
        at = float(pushed.x[place]) if spring.displacement is None else spring.displacement
        slack = 1e-11 if spring.displacement is None else 0.0
        bounds[place] = (at - slack, at - slack)
    turn = np.zeros(rows.shape[1])
    turn[own.shafts.index(own.output)] = 1.0
    ends = [linprog(sense * turn, A_ub=both[0], b_ub=both[1], bounds=bounds) for sense in (1.0, -1.0)]
    return None if ends[0].status == 2 else float(-ends[1].fun - ends[0].fun)


SETS = {
    "one spring": flexible(),
    "two springs": flexible(springs=PAIRS),
    "set to 0.01 mm": flexible(0.01),
    "set to 0.02 mm": flexible(0.02),
}


@pytest.mark.parametrize("own", SETS.values(), ids=SETS.keys())
def test_what_is_left_is_that_of_highs(own: PlanetarySet) -> None:
    """Unequal gaps, pins and clocking."""
    rng = np.random.default_rng(4)
    deviated, turns = random_deviations(own, 25, rng), rng.uniform(0, 9, 25)
    found = StackUp(own).free(deviated, turns, "ring 2", "sun")
    wanted = [left_by_highs(own, deviated, trial, turns[trial]) for trial in range(25)]
    assert found.status.tolist() == [int(left is None) for left in wanted]
    assert sum(left is not None for left in wanted) > 15
    for ends, left in zip(found.ends, wanted, strict=True):
        assert left is None or ends[1] - ends[0] == pytest.approx(left, abs=2e-9)


@pytest.mark.parametrize("springs", [(), ONE, PAIRS], ids=["rigid", "one spring", "two pairs"])
def test_placed_gears_differ_from_first_order_by_second(springs: tuple[Spring, ...]) -> None:
    own, rng = replace(reducer_3k(), springs=springs), np.random.default_rng(9)
    deviated, turns = random_deviations(own, 400, rng), rng.uniform(0, 9, 400)
    off = []
    for size in (1.0, 0.5):
        half = Deviated(*(size * array for array in vars(deviated).values()))
        found = [method.free(half, turns, "ring 2", "sun").ends for method in (StackUp(own), Contact(own))]
        assert np.isfinite(found).all()
        off.append(float(np.sqrt(np.mean((found[0] - found[1]) ** 2))))
    assert 3.6 < off[0] / off[1] < 4.4
    assert off[0] < 0.01 * ARCMIN


PRESSED = "springs: one, force: 60 N, stiffness: 1500 N/mm, friction: 9 N"


def lost_motions(name: str, springs: str, trials: int, tmp_path: Path) -> Array:
    """Lost motion of every trial [arcmin]."""
    text = (SCENES / f"{name}.yaml").read_text("utf-8").replace(PRESSED, f"springs: {springs}")
    (tmp_path / "scene.yaml").write_text(text, "utf-8")
    return _lost_motions(tmp_path / "scene.yaml", trials)


def _lost_motions(path: Path, trials: int) -> Array:
    scene = load_scene(path)
    system = planetary_system(scene)
    drawn_trials = drawn(simulation_of(scene, Overrides(trials=trials)), 0, trials)
    answers = system.method("exact", None).answers(drawn_trials, system.measures[:1])
    return np.asarray(answers.values["lost motion"][:, 0] / ARCMIN)


def mean_of(values: Array) -> tuple[float, float]:
    """Mean and its standard error."""
    return float(values.mean()), float(values.std() / math.sqrt(len(values)))


@pytest.mark.parametrize(("name", "mean"), [("reducer_3k", 11.8), ("reducer_3k_flexible", 0.9)])
def test_means_are_those_of_the_monte_carlo_with_the_same_assumptions(name: str, mean: float, tmp_path: Path) -> None:
    """11.8' rigid and 0.9' with one spring, printed to 0.1', within that and three standard errors."""
    found, error = mean_of(lost_motions(name, "one", 4000, tmp_path))
    assert abs(found - mean) < 0.05 + 3 * error


def test_two_pairs_leave_about_half_of_what_one_spring_does(tmp_path: Path) -> None:
    """Remainder by the stated rule, 0.48'; single trials are held to HiGHS elsewhere.

    Here the first spring is the stronger one; equal springs that are displaced alike leave 0.66', and HiGHS alone, at
    whatever vertex it ends, 0.55'.
    """
    found, error = mean_of(lost_motions("reducer_3k_flexible", "each", 4000, tmp_path))
    assert abs(found - 0.48) < 0.005 + 3 * error


def test_the_smaller_of_two_independent_residues_is_that_of_the_monte_carlo_for_two_pairs(tmp_path: Path) -> None:
    """0.54', printed to 0.01': two pairs as if each had a sun and rings of its own."""
    values = lost_motions("reducer_3k_flexible", "one", 8000, tmp_path)
    found, error = mean_of(np.minimum(values[:4000], values[4000:]))
    assert abs(found - 0.54) < 0.005 + 3 * error


def test_an_adjustment_of_nothing_is_the_rigid_carrier(tmp_path: Path) -> None:
    """The curve begins at 0: the same trials as with the rigid carrier, up to rounding."""
    text = (SCENES / "reducer_3k_flexible.yaml").read_text("utf-8").replace(PRESSED, "springs: one, adjustment: 0 mm")
    text = re.sub(r"  turn against .*\n", "", text)
    (tmp_path / "scene.yaml").write_text(text, "utf-8")
    found = [_lost_motions(path, 50) for path in (tmp_path / "scene.yaml", SCENES / "reducer_3k.yaml")]
    np.testing.assert_allclose(found[0], found[1], rtol=0.0, atol=1e-9)


# scenes ---------------------------------------------------------------------------------------------------------

TEXT = re.sub(r"  turn against .*\n", "", (SCENES / "reducer_3k_flexible.yaml").read_text("utf-8"))
REFUSED = {
    "a planet too many": (("[3, 4]]", "[3, 5]]"), "parts.carrier.pairs[1]: expected planets 1 to 4, got 5"),
    "a planet twice": (("[3, 4]]", "[3, 1]]"), "parts.carrier.pairs: expected every planet once at most, got"),
    "three of a pair": (("[3, 4]]", "[3, 4, 2]]"), "parts.carrier.pairs[1]: expected a list of 2 planets"),
    "adjusted the other way": (
        (PRESSED, "springs: one, adjustment: -1 um"),
        "parts.carrier.adjustment: expected a length of zero or more, got '-1 um'",
    ),
    "adjusted too far": (
        (PRESSED, "springs: one, adjustment: 80 um, displacement: 0.54"),
        "parts.carrier.adjustment: the planets cannot be displaced that far at the mean build: each contact that stops "
        "them lacks",
    ),
}


@pytest.mark.parametrize(("change", "said"), REFUSED.values(), ids=REFUSED.keys())
def test_a_carrier_that_makes_no_sense_is_refused(change: Edit, said: str, tmp_path: Path) -> None:
    assert said in refusal(edited(TEXT, change), tmp_path)
