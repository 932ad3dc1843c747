"""The arcsine law against a sine at random phases."""

import numpy as np
import pytest

from tol3d.statistics.distributions.arcsine import Arcsine


def test_it_is_a_sine_at_a_random_phase() -> None:
    """By its moments, exactly: those of sin over evenly spaced phases; and by how often it is below a value."""
    law, phases = Arcsine(-1.0, 3.0), (np.arange(1000) + 0.5) * 2 * np.pi / 1000
    sines = 1.0 + 2.0 * np.sin(phases)
    assert law.mean == pytest.approx(sines.mean(), abs=1e-12)
    assert law.variance == pytest.approx(sines.var(), rel=1e-12)
    assert law.sigma == pytest.approx(sines.std(), rel=1e-12)
    below = [(sines <= x).mean() for x in (-0.9, 0.0, 1.7, 2.99)]
    assert law.cdf(np.array([-0.9, 0.0, 1.7, 2.99])) == pytest.approx(below, abs=2e-3)
    u = np.linspace(0.0, 1.0, 11)
    assert law.cdf(law.ppf(u)) == pytest.approx(u, abs=1e-7)  # flat at its ends: half of the digits
    assert law.limits == (-1.0, 3.0)
