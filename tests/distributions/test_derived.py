"""Laws of what follows from a measured deviation, against closed forms of a parabola."""

import numpy as np
import pytest

from tol3d.numerics.arrays import Array
from tol3d.statistics.distributions import Distribution, Normal, Triangular, Uniform
from tol3d.statistics.distributions.derived import Derived

U = (np.arange(200) + 0.5) / 200
BEND = 0.3  # 1/mm, hundreds of times what pins have


class Parabola:
    """y = s (x + b x^2), which rises where s does, over -1/(2 b) mm."""

    words = "a parabola"

    def __init__(self, slope: float) -> None:
        self.slope = slope

    def deviation(self, measured: Array) -> Array:
        return self.slope * (measured + BEND * measured**2)

    def measured(self, deviation: Array) -> Array:
        return (np.sqrt(np.maximum(1 + 4 * BEND * deviation / self.slope, 0)) - 1) / (2 * BEND)


LAWS = [Normal(-0.02, 0.01), Normal(-0.02, 0.01, (-0.05, 0.01)), Uniform(-0.03, 0.05), Triangular(-0.01, 0.0, 0.03)]


@pytest.mark.parametrize("slope", [0.7, -0.7])
@pytest.mark.parametrize("law", LAWS)
def test_draws_are_those_of_what_is_measured(law: Distribution, slope: float) -> None:
    scale = Parabola(slope)
    own = Derived(law, scale)
    np.testing.assert_array_equal(own.ppf(U), scale.deviation(law.ppf(U if slope > 0 else 1 - U)))
    assert np.all(np.diff(own.ppf(U)) > 0)
    assert own.cdf(own.ppf(U)) == pytest.approx(U, abs=1e-12)
    if law.limits:
        assert own.limits == pytest.approx(sorted(scale.deviation(np.array(law.limits))), abs=1e-15)


@pytest.mark.parametrize("slope", [0.7, -0.7])
def test_moments_are_those_of_a_parabola_of_a_normal(slope: float) -> None:
    """E y = s (mu + b (mu^2 + sigma^2)); Var y = s^2 (sigma^2 (1 + 2 b mu)^2 + 2 b^2 sigma^4)."""
    mu, sigma = -0.02, 0.01
    own = Derived(Normal(mu, sigma), Parabola(slope))
    bent = BEND * sigma**2
    assert own.mean == pytest.approx(slope * (mu + BEND * mu**2 + bent), abs=1e-3 * bent)
    assert own.variance == pytest.approx(slope**2 * (sigma**2 * (1 + 2 * BEND * mu) ** 2 + 2 * bent**2), rel=1e-6)


def test_other_widths_are_those_of_what_is_measured() -> None:
    scale, law = Parabola(-0.7), Uniform(-0.03, 0.05)
    own = Derived(law, scale)
    assert own.scaled(0.5).measured == law.scaled(0.5)
    assert own.scaled_at(0.5, "low").limits == pytest.approx(Derived(law.scaled_at(0.5, "low"), scale).limits)
    assert own.within(-0.01, 0.02).limits == pytest.approx((-0.01, 0.02), abs=1e-15)
    assert own.pivot == pytest.approx(float(scale.deviation(np.array([law.mean]))[0]))
    assert own.words == "uniform of a parabola"
