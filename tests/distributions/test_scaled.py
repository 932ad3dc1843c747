"""Laws of other widths: the same draws as those of a scene that says so, and the same shape about what stays."""

from typing import Any

import numpy as np
import pytest

from tol3d import InputError
from tol3d.statistics.distributions.arcsine import Arcsine, ArcsineSpec
from tol3d.statistics.distributions.base import Distribution
from tol3d.statistics.distributions.constant import Constant
from tol3d.statistics.distributions.empirical import Empirical
from tol3d.statistics.distributions.normal import Normal, NormalSpec
from tol3d.statistics.distributions.rayleigh import Rayleigh
from tol3d.statistics.distributions.triangular import Triangular
from tol3d.statistics.distributions.truncated_normal import TruncatedNormal, TruncatedNormalSpec
from tol3d.statistics.distributions.uniform import Uniform, UniformSpec

U = (np.arange(200) + 0.5) / 200

LAWS: dict[str, Distribution] = {
    "normal": Normal(0.002, 0.003),
    "normal with limits": Normal(-0.0245, 0.0055 / 3, (-0.030, -0.019)),
    "normal with limits aside": Normal(-0.02, 0.001, (-0.030, -0.019)),
    "uniform": Uniform(0.003, 0.013),
    "triangular": Triangular(-0.01, 0.0, 0.03),
    "truncated normal": TruncatedNormal(0.0, 0.01, -0.02, 0.01),
    "rayleigh": Rayleigh(0.004),
    "arcsine": Arcsine(-0.01, 0.02),
    "measured": Empirical(np.array([-0.01, 0.0, 0.004, 0.03])),
    "measured lengths": Empirical(np.array([0.001, 0.004, 0.005, 0.03])),
    "as measured": Empirical(np.array([-0.01, 0.0, 0.004, 0.03]), "as_measured"),
}


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("factor", [0.5, 1.0, 1.7])
def test_each_draw_is_so_many_times_as_far_from_what_stays(name: str, factor: float) -> None:
    law = LAWS[name]
    stays = 0.0 if name == "rayleigh" else law.mean
    own = law.scaled(factor)
    assert own.ppf(U) == pytest.approx(stays + factor * (law.ppf(U) - stays), abs=1e-15)
    assert own.sigma == pytest.approx(factor * law.sigma, rel=1e-9)
    assert type(own) is type(law)
    if law.limits is not None and own.limits is not None:
        assert own.limits == pytest.approx([stays + factor * (end - stays) for end in law.limits], abs=1e-15)


@pytest.mark.parametrize("name", [own for own in LAWS if own != "rayleigh" and "measured" not in own])
def test_a_limit_can_stay(name: str) -> None:
    law = LAWS[name]
    assert law.limits is not None
    low, high = law.limits
    own = law.scaled(0.5, about=high)
    assert own.limits == pytest.approx(((low + high) / 2, high), abs=1e-15)
    assert own.ppf(U) == pytest.approx(high + 0.5 * (law.ppf(U) - high), abs=1e-15)


SPECS: list[tuple[Any, dict[str, Any], tuple[str, str]]] = [
    (NormalSpec, {"kind": "normal"}, ("-20 um", "20 um")),
    (NormalSpec, {"kind": "normal", "sigmas": 4.5}, ("-32 um", "-21 um")),
    (UniformSpec, {"kind": "uniform"}, ("3 um", "13 um")),
    (ArcsineSpec, {"kind": "arcsine"}, ("-7 um", "13 um")),
]


@pytest.mark.parametrize(("kind", "said", "ends"), SPECS)
@pytest.mark.parametrize(("lower", "upper"), [("-10 um", "10 um"), ("-31 um", "7.3 um"), ("0.1 mm", "0.13 mm")])
def test_other_limits_draw_what_a_scene_draws_that_says_so(
    kind: Any, said: dict[str, Any], ends: tuple[str, str], lower: str, upper: str
) -> None:
    """To the bit."""
    law = kind(**said, lower=ends[0], upper=ends[1]).resolve({})
    stated = kind(**said, lower=lower, upper=upper).resolve({})
    assert law.within(*stated.limits) == stated
    assert np.array_equal(law.within(*stated.limits).ppf(U), stated.ppf(U))


def test_modes_and_what_is_cut_off_keep_their_places() -> None:
    assert Triangular(-0.01, 0.0, 0.03).within(-0.02, 0.02).mode == pytest.approx(-0.01)
    own = TruncatedNormal(0.0, 0.01, -0.02, 0.01).within(-0.04, 0.02)
    assert (own.location, own.scale) == pytest.approx((0.0, 0.02), abs=1e-15)
    assert own.limits == (-0.04, 0.02)
    assert Rayleigh(0.004).scaled(0.5) == Rayleigh(0.002)


class Stranger(Normal):
    """Somebody's own law."""

    def mapped(self, place: Any, factor: float) -> Any:
        return Distribution.mapped(self, place, factor)


@pytest.mark.parametrize(
    ("ask", "words"),
    [
        (lambda: Stranger(0.0, 1.0).scaled(2.0), "expected a law that can be scaled, got Stranger"),
        (lambda: Constant(1.0).scaled(2.0), "got a constant, which does not spread"),
        (lambda: Rayleigh(1.0).scaled(2.0, about=1.0), "to be scaled about 0"),
        (lambda: Rayleigh(1.0).within(-1.0, 1.0), "expected a law with limits, got Rayleigh"),
        (lambda: Uniform(0.0, 1.0).within(1.0, 1.0), "expected a lower limit below the upper one, got 1 to 1"),
        (lambda: Uniform(0.0, 1.0).scaled(0.0), "expected a factor above 0, got 0"),
    ],
)
def test_what_cannot_be_is_refused(ask: Any, words: str) -> None:
    with pytest.raises(InputError, match=words):
        ask()


def test_a_truncated_normal_has_the_numbers_of_one_that_is_as_wide() -> None:
    given = {"lower": "-20 um", "upper": "10 um", "mean": "0 um", "sigma": "10 um"}
    spec = TruncatedNormalSpec.model_validate({"kind": "truncated_normal", **given})
    own = LAWS["truncated normal"].scaled(2.0)
    about = (1.0 - 2.0) * LAWS["truncated normal"].mean
    expected = {"lower": -0.04 + about, "upper": 0.02 + about, "mean": about, "sigma": 0.02}
    assert spec.numbers(own) == pytest.approx(expected, abs=1e-15)
