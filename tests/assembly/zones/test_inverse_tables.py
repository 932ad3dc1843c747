"""Tabulated inverses against quadrature of their densities by scipy."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import quad

from tol3d.assembly.zones.balls import maxwell
from tol3d.assembly.zones.face import diamond_tip, disc_tip
from tol3d.assembly.zones.half_difference import (
    normal_large,
    normal_lens,
    normal_small,
    uniform_large,
    uniform_lens,
    uniform_small,
)
from tol3d.assembly.zones.inverse import inverse, inverse_family

Array = NDArray[np.float64]
Density = Callable[[Array, Array], Array]

ROOT = 2e-9  # what tables are good to, of the order-th root of the probability


def assert_inverse(density: Density, order: int, parameter: float, w: float, z: float) -> None:
    """The probability up to z is w^order; both parts of the interval, so that a small one keeps its digits."""

    def of(place: float) -> float:
        return float(density(np.asarray(place), np.asarray(parameter)))

    below, above = (quad(of, *part, epsabs=0.0, epsrel=1e-9)[0] for part in ((0.0, z), (z, 1.0)))
    assert (below / (below + above)) ** (1 / order) == pytest.approx(w, abs=ROOT)


@pytest.mark.parametrize(
    ("density", "order"),
    [(maxwell, 3), (uniform_lens, 3), (uniform_small, 2), (uniform_large, 5), (normal_small, 2), (normal_large, 5)],
)
def test_inverses_meet_the_probability(density: Density, order: int) -> None:
    w = np.concatenate([[1e-3, 0.01], np.linspace(0.05, 0.95, 13), [0.99, 0.999, 0.99999]])
    for own, z in zip(w, inverse(density, order, 1.0)(w), strict=True):
        assert_inverse(density, order, 1.0, float(own), float(z))


@pytest.mark.parametrize(("density", "order"), [(diamond_tip, 3), (disc_tip, 3), (normal_lens, 3)])
def test_inverses_of_a_family_meet_the_probability_for_every_parameter(density: Density, order: int) -> None:
    rng = np.random.default_rng(1)
    w, parameters = rng.random(60), rng.random(60)
    w[:20], parameters[20:40] = w[:20] ** 3, parameters[20:40] ** 3
    for own, parameter, z in zip(w, parameters, inverse_family(density, order)(w, parameters), strict=True):
        assert_inverse(density, order, float(parameter), float(own), float(z))
        assert inverse(density, order, float(parameter))(np.array([own])) == pytest.approx([z], abs=2 * ROOT)
