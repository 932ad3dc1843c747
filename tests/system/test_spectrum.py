"""Spectra of curves against sums of sines that are known, numpy's transform and least squares."""

import math
from collections.abc import Sequence
from fractions import Fraction

import numpy as np
import pytest

from tol3d import InputError
from tol3d.study.system.positions import Positions
from tol3d.study.system.spectrum import AT_ONCE, Spectrum

TRIALS = 7
ROUNDING = 1e-13  # of amplitudes near 1: some hundred sums of numbers with 1e-16


def curves(positions: Positions, orders: Sequence[Fraction | int], seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Sums of sines of random amplitudes and phases about a random middle: amplitudes (trials, orders), the curves."""
    rng = np.random.default_rng(seed)
    amplitudes = rng.uniform(0.1, 1.0, (TRIALS, len(orders)))
    phases = rng.uniform(0.0, 2 * math.pi, amplitudes.shape)
    angles = np.array(positions.fixed)
    cycles = np.array([float(order) for order in orders])
    waves = amplitudes[:, :, None] * np.sin(cycles[:, None] * angles + phases[:, :, None])
    return amplitudes, rng.normal(0.0, 3.0, (TRIALS, 1)) + waves.sum(axis=1)


@pytest.mark.parametrize(
    ("positions", "orders"),
    [
        (Positions("turn", 1, 24), (1, 2, 5, 11)),
        (Positions("turn", 1, 25), (1, 12)),
        (Positions("long_period", 7, 168), (Fraction(1, 7), 1, Fraction(10, 7), 11)),
        (Positions("long_period", 3, 63), (Fraction(1, 3), Fraction(2, 3), 10)),
    ],
)
def test_amplitudes_are_those_of_the_sines(positions: Positions, orders: Sequence[Fraction | int]) -> None:
    """In each trial by itself, whatever the phases and the middle."""
    known, values = curves(positions, orders)
    found = Spectrum.over(positions, orders).amplitudes(positions, values)
    assert np.abs(found - known).max() < ROUNDING


def test_orders_that_are_not_there_have_none() -> None:
    positions = Positions("turn", 1, 24)
    known, values = curves(positions, (2, 7))
    spectrum = Spectrum.over(positions)
    assert spectrum.orders == tuple(range(1, 12))
    found = spectrum.amplitudes(positions, values)
    wanted = np.zeros_like(found)
    wanted[:, [1, 6]] = known
    assert np.abs(found - wanted).max() < ROUNDING


def test_a_rough_curve_has_the_amplitudes_of_a_least_squares_fit() -> None:
    """Sines and cosines of all orders, fitted together with a middle: evenly spaced, they are orthogonal."""
    positions = Positions("long_period", 3, 45)
    values = np.random.default_rng(4).normal(0.0, 1.0, (TRIALS, 45))
    spectrum = Spectrum.over(positions)
    angles = np.array(positions.fixed)
    waves = [f(float(order) * angles) for order in spectrum.orders for f in (np.cos, np.sin)]
    fit, *_ = np.linalg.lstsq(np.column_stack([np.ones_like(angles), *waves]), values.T, rcond=None)
    wanted = np.hypot(fit[1::2], fit[2::2]).T
    assert np.abs(spectrum.amplitudes(positions, values) - wanted).max() < ROUNDING


def test_a_turn_s_last_position_does_not_count() -> None:
    """The first comes again there but for what the driven gear has not come back to."""
    positions = Positions("turn", 1, 24)
    known, values = curves(positions, (3,))
    values[:, -1] += 5.0
    assert np.abs(Spectrum.over(positions, (3,)).amplitudes(positions, values) - known).max() < ROUNDING


def test_many_trials_are_transformed_in_parts() -> None:
    positions = Positions("long_period", 1, 512)
    rows = AT_ONCE // 512 * 2 + 3
    values = np.random.default_rng(3).normal(0.0, 1.0, (rows, 512))
    found = Spectrum.over(positions, (4, 200)).amplitudes(positions, values)
    wanted = 2 / 512 * np.abs(np.fft.fft(values[-40:], axis=1))[:, [4, 200]]
    assert np.abs(found[-40:] - wanted).max() < ROUNDING


@pytest.mark.parametrize(
    ("positions", "orders", "message"),
    [
        (Positions("swing", 1, 9, angles=(0.0, 0.1, 0.2)), (), "expected a curve over whole turns, got one over swing"),
        (Positions("random", 1, 1), (), "got one over random"),
        (Positions("turn", 1, 24), (12,), "at most 11 of them a turn at 24 positions, got 12"),
        (Positions("turn", 1, 24), (0,), "got 0"),
        (
            Positions("long_period", 3, 63),
            (Fraction(1, 2),),
            "expected orders of whole cycles in 3 turns, at most 31/3",
        ),
    ],
)
def test_what_cannot_be_resolved_is_refused(
    positions: Positions, orders: Sequence[Fraction | int], message: str
) -> None:
    with pytest.raises(InputError, match=message):
        Spectrum.over(positions, orders)
