"""The published formula as reconstructed, first principles beside it, and the law of what it adds up."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from rv_250 import TOLERANCES, rv_250
from scipy.integrate import quad
from scipy.special import i0e

from tol3d.gearing.cycloid.reducer.formula import (
    SineSum,
    best_pin_lever,
    first_principles_totals,
    paper_totals,
    sun_held_factor,
    terms,
)

RV_250 = rv_250(0.0)
SECONDS = math.degrees(1.0) * 3600


def test_the_formula_gives_the_variances_worked_out_by_hand() -> None:
    totals = paper_totals(terms(RV_250, TOLERANCES))
    assert totals.cycloid**2 == pytest.approx(2.532151e-9, abs=5e-16)
    assert totals.carrier**2 == pytest.approx(1.048143e-10, abs=5e-17)
    assert 3 * totals.cycloid * SECONDS == pytest.approx(31.138, abs=5e-4)
    assert 3 * totals.carrier * SECONDS == pytest.approx(6.3351, abs=5e-5)


def test_the_formula_comes_within_a_hundredth_of_what_was_printed_and_adds_up_both_ways() -> None:
    totals = paper_totals(terms(RV_250, TOLERANCES))
    assert 3 * totals.cycloid * SECONDS == pytest.approx(31.14, abs=0.01)
    assert 3 * totals.carrier * SECONDS == pytest.approx(6.33, abs=0.01)
    assert totals.arithmetic * SECONDS == pytest.approx(37.47, abs=0.005)
    assert totals.root_sum_square * SECONDS == pytest.approx(31.78, abs=0.005)


def test_levers_at_the_best_pin_are_those_of_three_lines_to_the_pitch_point() -> None:
    """rc' = 85.8 mm; the pitch point is 88 mm off the middle of the ring of 114.5, at a right angle to the normal."""
    per_um = SECONDS / 1e3
    assert best_pin_lever("disc run-out", RV_250) * per_um == pytest.approx(2.4040, abs=5e-5)
    assert best_pin_lever("pin circle radius", RV_250) * per_um == pytest.approx(1.5380, abs=5e-5)
    assert best_pin_lever("pin pitch", RV_250) * per_um == pytest.approx(1.8476, abs=5e-5)
    assert best_pin_lever("disc pitch", RV_250) == pytest.approx(88.0 / 114.5 / 85.8, rel=1e-12)


def test_first_principles_add_up_to_more_than_the_paper() -> None:
    """36.03" and 8.50" by hand: 2.4040 (2, 0.6667), 1.5380 x 5.8333, 1.8476 (0.0333, 3.3333), 2.4040 x 0.1667 um."""
    cycloid, carrier = first_principles_totals(terms(RV_250, TOLERANCES))
    lines = [2.4040 * 2.0, 2.4040 * 4 / 6, 1.5380 * 17.5 / 3, 1.8476 * 0.1 / 3, 1.8476 * 10 / 3, 2.4040 * 0.5 / 3]
    assert cycloid * SECONDS == pytest.approx(math.hypot(*lines), rel=1e-4)
    assert carrier * SECONDS == pytest.approx(2.4040 * 5 / 6 * math.sqrt(2), rel=1e-4)


def test_a_turn_of_the_disc_is_one_of_the_output_less_what_the_cranks_turn() -> None:
    """Pins: Zp a_j - Zc psi = phi; with the sun held phi = (1 + zs/zp) psi_carrier. Solved as a linear system."""
    for lobes, sun, planet in ((39, 21, 42), (29, 10, 35), (11, 18, 18)):
        carrier, _ = np.linalg.solve([[1.0, 1.0 / lobes], [-(1.0 + sun / planet), 1.0]], [1.0, 0.0])
        assert sun_held_factor(lobes, sun, planet) == pytest.approx(carrier, rel=1e-14)


# the law ------------------------------------------------------------------------------------------------------------


def by_characteristic_function(law: SineSum, half_range: float) -> float:
    """Gil-Pelaez: 2/pi int sin(w x) f(w)/w dw, f = exp(-g^2 w^2/2) exp(-l^2 w^2/4) I0(l^2 w^2/4)."""

    def integrand(w: float) -> float:
        shape = math.exp(-((law.normal * w) ** 2) / 2) * i0e((law.length * w) ** 2 / 4)
        return float(half_range * np.sinc(w * half_range / np.pi) * shape)

    return float(2 / math.pi * quad(integrand, 0.0, 10 / law.normal, limit=400, epsabs=1e-10)[0])


@given(st.floats(0.2, 2.0), st.floats(0.0, 3.0), st.floats(0.1, 8.0))
@settings(max_examples=30, deadline=None)
def test_coverage_is_that_of_the_characteristic_function(normal: float, length: float, half_range: float) -> None:
    law = SineSum(normal, length)
    assert law.coverage(half_range) == pytest.approx(by_characteristic_function(law, half_range), abs=1e-8)


def test_the_paper_s_law_is_wider_than_three_sigma_of_a_normal() -> None:
    law = paper_totals(terms(RV_250, TOLERANCES)).cycloid_law
    assert 3 * law.sigma * SECONDS == pytest.approx(31.138, abs=5e-4)
    assert law.half_range() * SECONDS == pytest.approx(33.69, abs=0.005)
    assert law.coverage(3 * law.sigma) == pytest.approx(0.9949, abs=5e-5)
    assert by_characteristic_function(SineSum(law.normal / law.sigma, law.length / law.sigma), 3.0) == pytest.approx(
        law.coverage(3 * law.sigma), abs=1e-9
    )


def sampled(rng: np.random.Generator, lengths: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(lengths * np.sin(rng.uniform(0.0, 2 * np.pi, len(lengths))))


def test_a_rayleigh_length_times_a_sine_is_normal_and_a_normal_length_is_not() -> None:
    """Kurtosis 3 of the one, 3 x 3/2 of the other; the standard error of a kurtosis is sqrt(E x^8 / s^8) / sqrt(n)."""
    rng, count = np.random.default_rng(5), 400_000
    rayleigh = sampled(rng, np.sqrt(-2 * np.log(rng.random(count))))
    normal = sampled(rng, rng.standard_normal(count))
    moments = [float(np.mean(own**4) / np.mean(own**2) ** 2) for own in (rayleigh, normal)]
    assert moments[0] == pytest.approx(3.0, abs=5 * math.sqrt(105 / count))
    assert moments[1] == pytest.approx(4.5, abs=5 * math.sqrt(105 * (35 / 128) * 16 / count))


def test_a_law_without_spread_has_no_range_and_a_normal_its_own() -> None:
    assert SineSum(0.0, 0.0).half_range() == 0.0
    assert SineSum(2.0, 0.0).half_range() == pytest.approx(2.0 * 2.9999769927, rel=1e-6)
    with pytest.raises(ValueError, match="between 0 and 1, got 1"):
        SineSum(1.0, 1.0).half_range(1.0)
