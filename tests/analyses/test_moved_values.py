"""Values of kept builds by other tolerances, from slopes: held to the values of the redrawn builds themselves."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from analyses.linear_stacks import Array, Stack, stack

from tol3d import InputError
from tol3d.analyses.moved_values import MovedValues
from tol3d.analyses.response import Response, response_of
from tol3d.simulate import load, simulation_of


def moved(response: Response, count: int) -> MovedValues:
    kept = response.kept(count)
    return MovedValues(response, kept, response.values(kept.deviations, kept.positions).values)


def error(own: MovedValues, factors: dict[str, float]) -> tuple[float, float]:
    """Root mean square of the error, and of the change itself, in sigmas."""
    redrawn = own.kept.redrawn(own.response.scaled(factors).draws)
    exact = own.response.values(redrawn.deviations, redrawn.positions).values
    sigma = own.values.std()
    found = [float(np.sqrt(np.mean((each - exact) ** 2)) / sigma) for each in (own.of(redrawn), own.values)]
    return found[0], found[1]


class Length(Stack):
    """The length of two sums at right angles [mm]: no slope at the mean, and one of any direction at a build."""

    def analytic(self, trials: Any, measure: Any) -> Array:
        return np.asarray(np.hypot(*(trials.deviations @ self.weights[measure.name]).T))


def length() -> Response:
    sums = stack([1.0, 1.0, 1.0], [0.010, 0.012, 0.004])
    system: Any = sums.simulation.system
    weights = {"gap": np.array([[1.0, 0.3], [-0.4, 1.2], [0.5, 0.5]])}
    return response_of(replace(sums.simulation, system=Length(**(vars(system) | {"weights": weights}))))


def test_a_sum_is_estimated_exactly_by_one_slope_of_what_moves() -> None:
    """Change of the sum: weight times change of the deviation; two builds for a slope, 50 of its check."""
    own = moved(stack([2.0, -1.5, 0.5], [0.01, 0.02, 0.03]), 50)
    before = own.response.evaluations
    redrawn = own.kept.redrawn(own.response.scaled({"x1": 1.7}).draws)
    changes = redrawn.deviations - own.kept.deviations
    assert own.of(redrawn)[:, 0] == pytest.approx(own.values[:, 0] - 1.5 * changes[:, 1], abs=1e-12)
    assert own.response.evaluations - before == 2 + 50
    own.of(own.kept.redrawn(own.response.scaled({"x1": 0.3}).draws))
    assert own.response.evaluations - before == 2 + 50
    assert [*own.known] == ["x1"]
    assert not own.slopes("x1").at_each_build
    assert own.of(own.kept) == pytest.approx(own.values, abs=0.0)


def test_a_length_needs_slopes_at_its_builds() -> None:
    own = moved(length(), 400)
    assert np.abs(own.response.gradient(own.response.mean)).max() < 1e-9
    wrong, change = error(own, {"x0": 1.2})
    assert change > 0.15
    assert wrong < 0.05
    assert own.slopes("x0").at_each_build
    assert 0.0 < own.slopes("x0").error[0] < 0.15


def test_a_value_at_a_turning_position_needs_them_too() -> None:
    """Run-out acts by the cosine of the angle; thickness is linear, and has the slope of the mean."""
    own = moved(response_of(simulation_of(load("spur_pair"))).of("normal backlash"), 300)
    for name, each in (("wheel eccentricity", True), ("wheel tooth thickness", False)):
        wrong, change = error(own, {name: 1.3})
        assert change > 0.05
        assert wrong < 0.001
        assert own.slopes(name).at_each_build == each


def test_other_builds_and_names_are_refused() -> None:
    own = moved(stack([2.0, -1.5], [0.01, 0.02]), 5)
    with pytest.raises(InputError, match="expected 5 redrawn builds"):
        own.of(own.response.kept(6))
    with pytest.raises(InputError, match="expected a contributor, got 'x2'"):
        own.slopes("x2")
