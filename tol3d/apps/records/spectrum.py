"""Residual of the eccentricities, by orders of the driver's turn."""

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from tol3d.apps.records.bins import bins_a_turn
from tol3d.apps.records.fit import Fit, Measured
from tol3d.apps.records.pair import Side
from tol3d.apps.records.terms import columns
from tol3d.numerics.arrays import Array


@dataclass(frozen=True)
class Order:
    """A line of the spectrum.

    Args:
        order: per turn of the driver.
        words: its name.
        amplitude: [rad], by side.
        noise: amplitude that white noise alone exceeds in one case of twenty [rad], by side.
    """

    order: Fraction
    words: str
    amplitude: Mapping[Side, float]
    noise: Mapping[Side, float]


@dataclass(frozen=True, eq=False)
class Spectrum:
    """Amplitudes of the residual, tooth mesh included.

    Args:
        orders: of one side (lines,), per turn of the driver.
        amplitudes: [rad] by side (lines,).
        lines: those with a name.
    """

    orders: Array
    amplitudes: Mapping[Side, Array]
    lines: tuple[Order, ...]


def spectrum_of(fit: Fit) -> Spectrum:
    """The spectrum over the long period of the fit's residual and of its tooth-mesh orders."""
    pair, sides = fit.measured.pair, fit.terms.sides
    left = {side: with_tooth_mesh(fit, side) for side in sides}
    amplitudes = {side: _amplitudes(fit.measured, side, own) for side, own in left.items()}
    orders = np.arange(len(next(iter(amplitudes.values())))) / pair.long_period_turns
    named = [
        (Fraction(1), "once per turn of the driver"),
        (Fraction(pair.driver_teeth, pair.driven_teeth), "once per turn of the driven gear"),
        (Fraction(2), "twice per turn of the driver"),
        (2 * Fraction(pair.driver_teeth, pair.driven_teeth), "twice per turn of the driven gear"),
        (Fraction(pair.driver_teeth), "tooth mesh"),
        (Fraction(2 * pair.driver_teeth), "tooth mesh, second harmonic"),
    ]
    sharp = {side: np.sqrt(4 * fit.variance / fit.measured.count([side]) * np.log(20.0)) for side in sides}
    lines = tuple(
        Order(order, words, {side: _one(fit.measured, side, left[side], float(order)) for side in sides}, sharp)
        for order, words in dict(named).items()
    )
    return Spectrum(orders, amplitudes, lines)


def with_tooth_mesh(fit: Fit, side: Side) -> Array:
    """Residual of eccentricities and encoders: that of the fit, with tooth mesh [rad]."""
    first = len(fit.terms.names) - len(fit.terms.tooth_columns)
    own = columns(fit.measured.pair, fit.terms, side, fit.measured.points[side])
    return np.asarray(fit.residual[side] + own[:, first:] @ fit.values[first:])


def _one(measured: Measured, side: Side, left: Array, order: float) -> float:
    rows = measured.rows[side]
    return float(2 * abs(np.sum(rows * left * np.exp(-1j * order * measured.points[side].phi1))) / rows.sum())


def _amplitudes(measured: Measured, side: Side, left: Array) -> Array:
    """Amplitudes of orders k over the turns of the long period, up to a little over twice the tooth mesh."""
    pair = measured.pair
    count = bins_a_turn(pair) * pair.long_period_turns
    index = np.minimum((measured.points[side].phi1 * (count / pair.long_period)).astype(np.int64), count - 1)
    rows = measured.rows[side]
    found = 2 * np.abs(np.fft.rfft(np.bincount(index, rows * left, minlength=count))) / rows.sum()
    return np.asarray(found[: int(2.2 * pair.driver_teeth * pair.long_period_turns)])
