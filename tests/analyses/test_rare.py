"""Rare events: probabilities in closed form, design points that must not be missed, and the spur pair's tail."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.stats import norm

from tol3d import InputError
from tol3d.analyses.rare import rare_event
from tol3d.analyses.response import Response, response_of
from tol3d.distributions.normal import Normal
from tol3d.simulate import load, simulation_of
from tol3d.study.simulation import Simulation
from tol3d.study.study import Study
from tol3d.system.draw import Scalar
from tol3d.system.plain import PlainContributor, PlainMeasure, PlainSystem

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Formula(PlainSystem):
    """A measure that is a function of standard normals (n, components)."""

    value: Callable[[Array], Array] = len  # type: ignore[assignment]

    def analytic(self, trials: Any, measure: Any) -> Array:
        return self.value(trials.deviations)

    def exact(self, trials: Any, measure: Any) -> Array:
        return self.value(trials.deviations)


def formula(value: Callable[[Array], Array], count: int) -> Response:
    contributors = tuple(PlainContributor(f"x{k}", "x", Scalar(Normal(0.0, 1.0)), "1", 1.0) for k in range(count))
    measure = PlainMeasure("value", "value", unit="1", per_internal=1.0)
    system = Formula("formula", contributors, (measure,), value)
    return response_of(Simulation(system, Study(trials=1000)))


def test_a_plane_is_met_exactly() -> None:
    """A linear measure of normals is normal: β is its distance, whatever the direction."""
    slopes = np.array([3.0, -1.0, 0.5])
    own = rare_event(formula(lambda x: x @ slopes, 3), "high", 4.0 * float(np.linalg.norm(slopes)))
    assert own.points[0].beta == pytest.approx(4.0, abs=1e-6)
    assert own.points[0].sensitivities == pytest.approx(slopes / np.linalg.norm(slopes), abs=1e-6)
    assert own.first_order == pytest.approx(norm.sf(4.0), rel=1e-5)
    assert own.probability == pytest.approx(norm.sf(4.0), abs=4 * own.error)
    assert 0.0 < own.error < 0.04 * own.probability


def test_of_two_design_points_none_is_left_out() -> None:
    """|x| beyond 4 has twice the tail that one design point sees; the starts find both, or the plain draws tell."""
    own = rare_event(formula(lambda x: np.abs(x[:, 0]) + 0.01 * x[:, 1], 2), "high", 4.0, starts=8)
    assert len(own.points) == 2
    assert own.probability == pytest.approx(2 * norm.sf(4.0 / math.hypot(1.0, 0.01)), abs=4 * own.error)


def test_a_ball_fails_all_round() -> None:
    """The distance of a point from its place beyond 5: Rayleigh, exp(-12.5). No design point is the only one."""
    own = rare_event(formula(lambda x: np.hypot(x[:, 0], x[:, 1]), 2), "high", 5.0, starts=24)
    assert own.probability == pytest.approx(math.exp(-12.5), abs=5 * own.error)
    assert own.error < 0.25 * own.probability


def test_a_limit_that_the_mean_build_breaks() -> None:
    own = rare_event(formula(lambda x: x[:, 0], 1), "low", 1.0)
    assert own.points[0].beta == pytest.approx(-1.0, abs=1e-6)
    assert own.first_order == pytest.approx(norm.cdf(1.0), rel=1e-5)
    assert own.probability == pytest.approx(norm.cdf(1.0), abs=4 * own.error)


def test_a_build_that_does_not_seat_fails() -> None:
    """Above 3 there is no value: as many fail as lie there, and those below -5."""

    def value(x: Array) -> Array:
        return np.where(x[:, 0] > 3.0, np.nan, x[:, 0])

    own = rare_event(formula(value, 1), "low", -2.0, draws=40_000)
    assert own.probability == pytest.approx(norm.cdf(-2.0) + norm.sf(3.0), abs=4 * own.error)


@pytest.fixture(scope="module")
def spur() -> Response:
    return response_of(simulation_of(load("spur_pair"))).of("normal backlash")


def test_the_spur_pair_below_15_um(spur: Response) -> None:
    """0.0507 ppm, by 10^10 draws of a formula of its own; fewer than 8000 builds know it within 5 %."""
    own = rare_event(spur, "low", 15.0)
    assert own.evaluations < 8000
    assert own.first_order is not None
    assert 1e6 * own.first_order == pytest.approx(0.0507, rel=0.02)
    assert own.error < 0.06 * own.probability
    assert 1e6 * own.probability == pytest.approx(0.0507, rel=0.2)


@pytest.mark.slow
def test_its_interval_holds_the_truth_as_often_as_it_says(spur: Response) -> None:
    found = [rare_event(spur, "low", 15.0, seed=seed) for seed in range(100)]
    held = sum(own.interval[0] <= 0.0507e-6 <= own.interval[1] for own in found)
    assert 88 <= held <= 99
    assert np.mean([own.probability for own in found]) == pytest.approx(0.0507e-6, rel=0.015)


def test_what_cannot_be_asked_is_refused(spur: Response) -> None:
    with pytest.raises(InputError, match="expected one measure, got normal backlash, lost motion"):
        rare_event(response_of(spur.simulation), "low", 15.0)
