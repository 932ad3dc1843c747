"""Draws: moments of their components, and the ends in the direction in which a linear measure changes most."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from tol3d.statistics.distributions import Distribution
from tol3d.statistics.distributions.constant import Constant
from tol3d.statistics.distributions.normal import Normal
from tol3d.statistics.distributions.rayleigh import Rayleigh
from tol3d.study.system.draw import Ball, Draw, Each, Planar, Scalar

Array = NDArray[np.float64]

COUNT = 200_000
DRAWS: dict[str, Draw] = {
    "scalar": Scalar(Normal(0.2, 0.01)),
    "disc": Planar(Rayleigh(0.01), None),
    "at an angle": Planar(Normal(0.1, 0.01), math.radians(30)),
    "ball": Ball(Normal(0.05, 0.01)),
    "each": Each(Normal(0.1, 0.02), ("first", "second", "third")),
}


def drawn(draw: Draw) -> Array:
    """Components of many trials, (components, trials)."""
    rng = np.random.default_rng(1)
    return np.stack(draw.deviations(*rng.random((draw.uniforms, COUNT))))


@pytest.mark.parametrize("name", ["scalar", "disc", "ball", "each"])
def test_each_component_has_the_mean_and_sigma_that_the_draw_states(name: str) -> None:
    draw = DRAWS[name]
    components = drawn(draw)
    assert len(components) == len(draw.components)
    errors = 5 * draw.sigma / math.sqrt(COUNT)
    assert components.mean(axis=1) == pytest.approx(np.array(draw.mean(turning=False)), abs=errors)
    assert components.std(axis=1) == pytest.approx(draw.sigma, rel=5 / math.sqrt(COUNT))


def test_a_ball_of_one_radius_is_a_sphere_and_even_on_it() -> None:
    """On a sphere each coordinate is uniform: its fourth moment is r^4/5, and octants are hit alike."""
    x, y, z = drawn(Ball(Constant(2.0)))
    assert np.sqrt(x * x + y * y + z * z) == pytest.approx(2.0, rel=1e-12)
    for own in (x, y, z):
        assert (own**4).mean() == pytest.approx(16 / 5, rel=5 * 4 / 3 / math.sqrt(COUNT))
    octants = np.bincount(4 * (x > 0) + 2 * (y > 0) + (z > 0), minlength=8)
    assert np.abs(octants - COUNT / 8).max() < 5 * math.sqrt(COUNT * 7 / 64)


@pytest.mark.parametrize("name", DRAWS)
def test_ends_are_those_of_a_linear_measure_in_its_steepest_direction(name: str) -> None:
    draw = DRAWS[name]
    slope = np.array([3.0, -4.0, 12.0])[: len(draw.components)]
    ends = draw.ends(lambda rows: rows @ slope, turning=False)
    law, values = draw.distribution, ends @ slope
    assert isinstance(law, Distribution)
    if name == "scalar":
        expected = {3.0 * law.low, 3.0 * law.high}
    elif name == "at an angle":
        along = 3.0 * math.cos(math.radians(30)) - 4.0 * math.sin(math.radians(30))
        expected = {along * law.low, along * law.high}
    elif name == "each":
        reach = 13.0 * (law.high - law.mean)  # the root of the sum of squares
        expected = {11.0 * law.mean - reach, 11.0 * law.mean + reach}
    else:
        size = math.hypot(*slope)
        expected = {-size * law.radius, size * law.radius}
    assert sorted(values) == pytest.approx(sorted(expected), rel=1e-9)
