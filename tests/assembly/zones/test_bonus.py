"""Bonus: what sizes add to a zone, its covariance and its worst case."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from tol3d.assembly.model.datum_frame import Modifier
from tol3d.assembly.zones import Bonus, Confined, Zone, catalogue, normal_in, uniform_in
from tol3d.statistics.distributions import Distribution
from tol3d.statistics.distributions.normal import Normal
from tol3d.statistics.distributions.uniform import Uniform

COUNT = 300_000


@pytest.mark.parametrize(
    ("modifier", "inner", "expected"),
    [
        # sizes below, at the lower limit, between, at the upper limit, above: -0.1 to +0.3
        ("mmc", True, (0.0, 0.0, 0.1, 0.4, 0.4)),  # a hole has most material where it is small
        ("mmc", False, (0.4, 0.4, 0.3, 0.0, 0.0)),
        ("lmc", True, (0.4, 0.4, 0.3, 0.0, 0.0)),
        ("lmc", False, (0.0, 0.0, 0.1, 0.4, 0.4)),
    ],
)
def test_bonus_is_the_departure_from_the_material_condition(
    modifier: Modifier, inner: bool, expected: tuple[float, ...]
) -> None:
    bonus = Bonus.at(modifier, -0.1, 0.3, inner=inner)
    assert bonus.of(np.array([-0.2, -0.1, 0.0, 0.3, 0.5])) == pytest.approx(np.array(expected))
    assert bonus.most == pytest.approx(0.4)


def test_uniform_discs_widened_by_uniform_sizes_have_the_sigma_of_the_mean_square_diameter() -> None:
    """t in U(0.14, 0.34): sigma = sqrt(E t^2) / 4 = 0.061712 along each axis."""
    draw = uniform_in(catalogue.axis_section(0.14))
    bonus, size = Bonus.at("mmc", 0.0, 0.2, inner=True), Uniform(0.0, 0.2)
    expected = math.sqrt((0.34**3 - 0.14**3) / (3 * 0.2)) / 4
    assert expected == pytest.approx(0.061712, abs=1e-6)
    assert bonus.covariance(draw, size) == pytest.approx(np.eye(2) * expected**2, rel=1e-5)


@pytest.mark.parametrize("law", [uniform_in, normal_in])
@pytest.mark.parametrize("size", [Uniform(-0.05, 0.3), Normal(0.1, 0.1)])
def test_the_covariance_with_bonus_is_that_of_trials_and_size_does_not_correlate(
    law: Callable[[Zone], Confined], size: Distribution
) -> None:
    draw = law(catalogue.axis(0.1, 0.04))
    bonus = Bonus.at("mmc", 0.0, 0.2, inner=True)
    rng = np.random.default_rng(1)
    sizes = size.ppf(rng.random(COUNT))
    widths = 0.1 + bonus.of(sizes)
    points = np.stack(draw.deviations_in(widths, None, *rng.random((4, COUNT))), axis=1)
    assert draw.zone.inside(points, widths).all()
    products = points[:, :, None] * points[:, None, :]
    errors = products.std(axis=0) / math.sqrt(COUNT)
    assert (np.abs(products.mean(axis=0) - bonus.covariance(draw, size)) < 5 * errors).all()
    for own in points.T:
        assert abs(np.corrcoef(own, sizes)[0, 1]) < 5 / math.sqrt(COUNT)


@pytest.mark.parametrize("grows", [True, False])
@pytest.mark.parametrize("size", [Uniform(-0.05, 0.3), Uniform(0.05, 0.1), Normal(0.1, 0.1)])
def test_the_worst_case_with_bonus_is_the_worst_of_all_sizes(grows: bool, size: Distribution) -> None:
    draw = uniform_in(catalogue.axis(0.1, 0.04))
    bonus = Bonus(0.0, 0.2, grows)
    sizes = np.linspace(size.low, size.high, 501)
    widths = 0.1 + bonus.of(sizes)
    rng = np.random.default_rng(2)
    for gradient, per_size in zip(rng.standard_normal((12, 4)), rng.standard_normal(12), strict=True):
        found = np.array([draw.zone.support(gradient, width) for width in widths]) + per_size * sizes
        step = (sizes[1] - sizes[0]) * (abs(per_size) + np.abs(gradient).sum())
        assert found.max() - 1e-12 <= bonus.support(draw, gradient, size, per_size) <= found.max() + step


def test_the_worst_case_with_bonus_may_lie_between_the_limits_of_size() -> None:
    """The reach of a refined axis is concave in the width: a measure that grows against the size is worst between."""
    draw, size = uniform_in(catalogue.axis(0.1, 0.04)), Uniform(0.0, 0.2)
    bonus = Bonus(0.0, 0.2, grows=True)
    gradient = np.array([1.0, 0.0, 0.0, 1.0])
    ends = [draw.zone.support(gradient, width) for width in (0.1, 0.3)]
    per_size = -(ends[1] - ends[0]) / 0.2  # both limits alike
    sizes = np.linspace(0.0, 0.2, 2001)
    found = np.array([draw.zone.support(gradient, 0.1 + own) for own in sizes]) + per_size * sizes
    worst = bonus.support(draw, gradient, size, per_size)
    assert worst > ends[0] + 1e-4
    assert worst == pytest.approx(found.max(), abs=1e-6)  # of order 2 in a step of 1e-4


def test_a_bonus_that_is_not_needed_costs_nothing() -> None:
    """Without coefficient of the size, the worst case is that of the widest zone."""
    draw = uniform_in(catalogue.axis(0.1))
    gradient = np.array([3.0, 4.0, -5.0, 12.0])
    worst = Bonus.at("mmc", 0.0, 0.2, inner=True).support(draw, gradient, Uniform(0.0, 0.2))
    assert worst == pytest.approx(0.15 * 18)
