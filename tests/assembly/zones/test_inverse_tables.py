"""Tabulated inverses against quadrature of their densities by scipy."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import quad

from tol3d.assembly.zones.balls import maxwell
from tol3d.assembly.zones.cross_section import uniform_large, uniform_lens, uniform_small
from tol3d.assembly.zones.inverse import inverse

Array = NDArray[np.float64]
Density = Callable[[Array], Array]

ROOT = 2e-9  # what tables are good to, of the order-th root of the probability


@pytest.mark.parametrize(
    ("density", "order"), [(maxwell, 3), (uniform_lens, 3), (uniform_small, 2), (uniform_large, 5)]
)
def test_inverses_meet_the_probability(density: Density, order: int) -> None:
    """The probability up to z is w^order; both parts of the interval, so that a small one keeps its digits."""

    def of(place: float) -> float:
        return float(density(np.asarray(place)))

    w = np.concatenate([[1e-3, 0.01], np.linspace(0.05, 0.95, 13), [0.99, 0.999, 0.99999]])
    for own, z in zip(w, inverse(density, order)(w), strict=True):
        below, above = (quad(of, *part, epsabs=0.0, epsrel=1e-9)[0] for part in ((0.0, z), (z, 1.0)))
        assert (below / (below + above)) ** (1 / order) == pytest.approx(own, abs=ROOT)
