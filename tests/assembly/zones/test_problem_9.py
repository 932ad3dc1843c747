"""Zones as sets of small displacements: problem 9 of the reference problems, its numbers computed anew."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import dblquad, quad
from scipy.stats import norm

from tol3d.assembly.zones import ZoneDraw, catalogue, normal_in, process_in, uniform_in
from tol3d.statistics.distributions.normal import Normal

Array = NDArray[np.float64]

FACE = (100.0, 60.0)
LENGTH = 40.0
T = 0.1
COUNT = 1_000_000


def tilts(rows: Array) -> Array:
    """Slopes alpha about x and beta about y (trials, 2) of components of the face; w = offset + alpha y - beta x."""
    return np.stack([rows[:, 2] / (FACE[1] / 2), -rows[:, 1] / (FACE[0] / 2)], axis=1)


def drawn(draw: ZoneDraw) -> Array:
    """Components (trials, components)."""
    return np.stack(draw.deviations(*np.random.default_rng(1).random((draw.uniforms, COUNT))), axis=1)


def test_a_uniform_face_has_sigma_one_over_root_ten_of_each_largest_value() -> None:
    """Density (3/2) (1 - |x|)^2 of each coordinate over its largest: variance 1/10, P(|x| > 1/2) = 1/8."""
    draw = uniform_in(catalogue.rectangle(T))
    variance = 2 * quad(lambda x: 1.5 * (1 - x) ** 2 * x**2, 0, 1)[0]
    assert variance == pytest.approx(0.1)
    assert draw.sigmas == pytest.approx(np.full(3, T / 2 * math.sqrt(variance)), rel=1e-12)
    rows = drawn(draw)
    own = tilts(rows)
    sigmas = (rows[:, 0].std(), own[:, 0].std(), own[:, 1].std())
    # kurtosis of that density is 20/7, so that a sigma's standard error is sigma sqrt((20/7 - 1) / 4 n)
    assert sigmas == pytest.approx((0.0158114, 5.27046e-4, 3.16228e-4), rel=4 * math.sqrt(13 / 28 / COUNT))
    largest = (T / 2) / (FACE[1] / 2)
    share = (np.abs(own[:, 0]) > largest / 2).mean()
    assert share == pytest.approx(1 / 8, abs=4 * math.sqrt(7 / 64 / COUNT))


def test_the_total_tilt_of_a_uniform_face_has_the_mean_of_its_two_dimensional_density() -> None:
    """Both tilts over their largest have the density (3/2)(1 - |y| - |z|) on the diamond."""
    most = (T / 2) / (FACE[1] / 2), (T / 2) / (FACE[0] / 2)

    def moment(power: int) -> float:
        def integrand(z: float, y: float) -> float:
            return 6 * (1 - y - z) * math.hypot(most[0] * y, most[1] * z) ** power

        return float(dblquad(integrand, 0, 1, 0, lambda y: 1 - y)[0])

    mean, square = moment(1), moment(2)
    assert mean == pytest.approx(5.479e-4, abs=3e-7)  # found by trials, to that
    found = np.hypot(*tilts(drawn(uniform_in(catalogue.rectangle(T)))).T)
    assert found.mean() == pytest.approx(mean, abs=4 * math.sqrt((square - mean**2) / COUNT))


def test_independent_normals_leave_the_zone_as_often_as_their_sum_exceeds_three_sigma() -> None:
    """P(|Z1| + |Z2| + |Z3| <= 3) = 0.7374245; without one rotation (2 Phi(3 / sqrt 2) - 1)^2."""

    def within(first: float, second: float) -> float:
        return float(8 * norm.pdf(first) * norm.pdf(second) * (norm.cdf(3 - first - second) - 0.5))

    share = dblquad(within, 0, 3, 0, lambda first: 3 - first)[0]
    assert share == pytest.approx(0.7374245, abs=1e-7)
    draw = process_in(catalogue.rectangle(T), Normal(0.0, T / 6))
    found = draw.zone.inside(drawn(draw)).mean()
    assert found == pytest.approx(share, abs=4 * math.sqrt(share * (1 - share) / COUNT))
    flat = process_in(catalogue.rectangle_orientation(T), Normal(0.0, T / 6))
    share = (2 * norm.cdf(3 / math.sqrt(2)) - 1) ** 2
    assert flat.zone.inside(drawn(flat)).mean() == pytest.approx(share, abs=4 * math.sqrt(share * (1 - share) / COUNT))


@pytest.mark.parametrize("part", [1.0, 0.4])
def test_a_normal_face_has_the_height_of_a_point_and_the_tilts_that_it_leaves(part: float) -> None:
    """Each diagonal of both rises is a normal of sigma t_o / 6, cut off at ±r / sqrt 2, r = min(1 - |x|, t_o / t)."""

    def cut(z: float) -> float:
        """Variance of a standard normal cut off at ±z."""
        return float(1 - 2 * z * norm.pdf(z) / (2 * norm.cdf(z) - 1)) if z > 1e-9 else 0.0

    def left(x: float) -> float:
        return float(2 * norm.pdf(x) * cut(min((3 - x) / part, 3) / math.sqrt(2)))

    rise = part * math.sqrt(quad(left, 0, 3, points=[3 - 3 * part], epsabs=1e-12)[0] / (2 * norm.cdf(3) - 1))
    draw = normal_in(catalogue.rectangle(T, part * T))
    assert math.sqrt(cut(3)) == pytest.approx(0.9865784, abs=5e-8)
    assert draw.sigmas == pytest.approx(np.array([math.sqrt(cut(3)), rise, rise]) * T / 6, rel=1e-8)
    assert drawn(draw).std(axis=0) == pytest.approx(draw.sigmas, rel=4 / math.sqrt(2 * COUNT))


def test_an_axis_in_a_round_zone_tilts_by_the_distance_of_two_points_in_a_disc() -> None:
    """Mean 128 / 45 pi, root mean square 1 radius; P(distance < radius) = 1 - 3 sqrt 3 / 4 pi."""
    rows = drawn(uniform_in(catalogue.axis(T)))
    distance = np.hypot(*(rows[:, 2:] - rows[:, :2]).T)
    mean, square = 128 / (45 * math.pi), 1.0
    tilt = distance / LENGTH
    assert mean * (T / 2) / LENGTH == pytest.approx(1.131768e-3, rel=1e-6)
    assert tilt.mean() == pytest.approx(mean * (T / 2) / LENGTH, rel=4 * math.sqrt(square / mean**2 - 1) / 1000)
    assert math.sqrt((tilt**2).mean()) == pytest.approx(1.25e-3, rel=4 * 0.5 / 1000)
    share = 1 - 3 * math.sqrt(3) / (4 * math.pi)
    assert (distance < T / 2).mean() == pytest.approx(share, abs=4 * math.sqrt(share * (1 - share) / COUNT))
