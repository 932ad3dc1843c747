"""Amplitudes of the harmonics of a curve measure, folded block by block."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tol3d.runs.summary.sample import SpectrumSample
from tol3d.runs.summary.values import made
from tol3d.statistics import Grid, Moments
from tol3d.study.sample import QUANTILES, finite, quantile
from tol3d.system.measure import Measure
from tol3d.system.spectrum import Spectrum

Array = NDArray[np.float64]

BINS = 2**12  # 32 KB of counts; there may be some hundred orders, and of 24 sigma one bin is 0.006 sigma


def grid_name(measure: str, index: int) -> str:
    """Name of the grid of an order of a measure, by the order's place."""
    return f"{measure}:order {index}"


def amplitudes_of(measure: Measure, spectrum: Spectrum, curves: Array) -> Array:
    """Amplitudes (trials that seated, orders) of curves (trials, positions), both in the measure's unit."""
    return spectrum.amplitudes(measure.positions, curves[~np.isnan(curves).any(axis=1)])


@dataclass(frozen=True)
class OrderTally:
    """One road's amplitudes of one order."""

    moments: Moments
    grid: Grid

    def merge(self, other: "OrderTally") -> "OrderTally":
        """Both as one."""
        return OrderTally(self.moments.merge(other.moments), self.grid.merge(other.grid))

    def quantile(self, p: float) -> float | None:
        """Amplitude below which a share p of the trials lies."""
        return finite(quantile(self.moments, self.grid, p))


def spectrum_tally(measure: Measure, curves: Array, grids: Mapping[str, Grid]) -> tuple[OrderTally, ...]:
    """A block's amplitudes of each order that a measure asks for; none where it asks for none."""
    if measure.spectrum is None:
        return ()
    found = amplitudes_of(measure, measure.spectrum, curves)
    return tuple(
        OrderTally(Moments.of(own), grids[grid_name(measure.name, k)].add(own))
        for k, own in enumerate(np.ascontiguousarray(found.T))
    )


def spectrum_sample(measure: Measure, tallies: tuple[OrderTally, ...]) -> SpectrumSample | None:
    """What summary.json says of them, in the measure's unit; None where the measure asks for none."""
    if measure.spectrum is None:
        return None
    low, middle, high = ([own.quantile(p) for own in tallies] for p in QUANTILES)
    return made(
        SpectrumSample,
        order=[float(order) for order in measure.spectrum.orders],
        mean=[own.moments.mean if own.moments.count else None for own in tallies],
        sigma=[finite(own.moments.sigma) for own in tallies],
        p0_135=low,
        p50=middle,
        p99_865=high,
        max=[finite(own.moments.maximum) for own in tallies],
    )
