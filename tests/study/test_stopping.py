"""Automatic studies: they stop where the formulas of the standard errors say, or tell what they did not reach."""

import json
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from gear_trials import simulated
from places import SCENES
from scene_texts import scene_of

from tol3d.gearing.model import Model, Scalar
from tol3d.gearing.stack_up import closed_form
from tol3d.simulate import simulation_of
from tol3d.statistics.distributions.constant import Constant
from tol3d.study.results.stopping import enough, shortfalls
from tol3d.study.system.outcome import Columns
from tol3d.study.tallies.tally import PILOT_TRIALS, Tally, grids_of
from tol3d.study.trials.columns import columns_of as system_columns
from tol3d.study.trials.draws import drawn
from tol3d.study.trials.simulation import Simulation
from tol3d.study.trials.study import Until

BLOCK = 2048
NAME = "normal backlash"

ColumnsOf = Callable[[Simulation, int, int], Columns]


def columns_of(model: Simulation, first: int, count: int) -> Columns:
    return system_columns(model.system, None, drawn(model, first, count))


def with_twice_the_spread(model: Simulation, first: int, count: int) -> Columns:
    """As if there were geometry, and it gave twice what the stack-up does."""
    columns = columns_of(model, first, count)
    twice = {f"geometric:{own.name}": 2 * columns[f"analytic:{own.name}"] for own in model.system.measures}
    return {**columns, **twice}


def stopped(model: Simulation, most: int, columns: ColumnsOf = columns_of) -> Tally:
    """Blocks merged in their order until it is enough, or `most` trials are there."""
    grids, asked = grids_of(model.system, columns(model, 0, PILOT_TRIALS)), enough(model)
    tally = Tally.of(model, grids, columns(model, 0, BLOCK))
    while not asked(tally) and tally.trials < most:
        tally = tally.merge(Tally.of(model, grids, columns(model, tally.trials, BLOCK), tally.trials))
    return tally


def waiting(model: Model, *until: Until, engine: str = "exact") -> Simulation:
    return simulated(model, until=until, engine=engine)


@pytest.fixture(scope="module")
def sigma(paper_model: Model) -> float:
    form = closed_form(paper_model, paper_model.measures[0])
    assert form is not None
    return form.sigma


def assert_stops_at(expected: float, trials: int) -> None:
    """The wanted number within a block; n trials know sigma^2, and so the number, to sqrt(2 / n), 4 of them."""
    slack = 4 * math.sqrt(2 / expected) * expected
    assert expected - slack <= trials <= expected + slack + BLOCK


@pytest.mark.parametrize("seed", [1, 2])
def test_the_mean_is_known_after_the_square_of_sigma_over_the_error(
    paper_model: Model, sigma: float, seed: int
) -> None:
    wanted = 5e-5  # mm; 20 800 trials
    model = waiting(paper_model, Until(NAME, wanted, None))
    model = replace(model, study=replace(model.study, seed=seed))
    assert_stops_at((sigma / wanted) ** 2, stopped(model, 10**6).trials)


def test_sigma_is_known_after_half_as_many(paper_model: Model, sigma: float) -> None:
    wanted = 4e-5  # mm; 16 300 trials: the measure is a sum of normals, whose sigma is known to sigma / sqrt(2 n)
    assert_stops_at((sigma / wanted) ** 2 / 2, stopped(waiting(paper_model, Until(NAME, None, wanted)), 10**6).trials)


def test_it_goes_on_until_every_measure_is_known(paper_model: Model, sigma: float) -> None:
    form = closed_form(paper_model, paper_model.measures[1])
    assert form is not None
    loose, tight = Until(NAME, sigma / 10, sigma / 10), Until("lost motion", form.sigma / 120, None)
    assert_stops_at(120**2, stopped(waiting(paper_model, loose, tight), 10**6).trials)


def test_with_geometry_it_waits_for_the_errors_of_that(paper_model: Model, sigma: float) -> None:
    model = waiting(paper_model, Until(NAME, sigma / 50, None), engine="fcl")  # its sums are numpy's
    assert_stops_at(100**2, stopped(model, 10**6, with_twice_the_spread).trials)  # 2500 by the stack-up


def test_without_a_stated_error_it_is_never_enough(paper_model: Model) -> None:
    assert stopped(simulated(paper_model), 3 * BLOCK).trials == 3 * BLOCK
    assert list(shortfalls(simulated(paper_model), stopped(simulated(paper_model), BLOCK))) == []


def test_what_was_not_reached_is_said_with_its_numbers(paper_model: Model, sigma: float) -> None:
    model = waiting(paper_model, Until(NAME, 1e-5, sigma / 10))
    tally = stopped(model, 2 * BLOCK)
    (sentence,) = shortfalls(model, tally)  # sigma's own is reached
    reached = tally.measures[NAME].analytic.moments.mean_se
    assert sentence == f"{NAME}: mean known to ±{reached:.3g} um after {2 * BLOCK} trials, not to the ±0.01 um of until"


def test_what_does_not_vary_is_known_at_once(paper_model: Model) -> None:
    still = replace(paper_model.contributors[0], draw=Scalar(Constant(0.0)))
    model = waiting(replace(paper_model, contributors=(still,)), Until(NAME, 1e-9, 1e-9))
    assert stopped(model, 10 * BLOCK).trials == BLOCK


def test_an_automatic_study_keeps_what_it_waits_for_in_mm_and_rad_and_as_json(tmp_path: Path) -> None:
    text = (SCENES / "spur_pair.yaml").read_text(encoding="utf-8")
    old = "study: {trials: 2000, seed: 1, sampler: monte_carlo, engine: exact, witness: 20}"
    until = "{normal backlash: {mean: 0.05 um}, lost motion: {mean: 1 arcsec, sigma: 0.1 mrad}}"
    study = simulation_of(
        scene_of(text.replace(old, f"study: {{trials: auto, until: {until}, at_most: 70000}}"), tmp_path)
    ).study
    assert study.trials == 70_000
    backlash, motion = study.until
    assert (backlash[0], *backlash[2:], motion[0]) == ("normal backlash", None, "lost motion")
    assert (backlash[1], *motion[1:]) == pytest.approx((5e-5, math.pi / 648_000, 1e-4))
    assert json.loads(json.dumps(vars(study)))["until"] == [list(backlash), list(motion)]
