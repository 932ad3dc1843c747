"""The terms of a sum, pooled over trials: each one's moments, and their covariance.

A measure that is a sum: its terms, which are kept and pooled beside it.

Statistics of all trials of a measure together, besides those that every sample has: a measure names its own.

Spectra of curves: amplitudes of harmonics, trial by trial, pooled over the trials; a measure asks for its own.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Final, Protocol, Self

import numpy as np
from numpy.typing import NDArray

from tol3d.errors import InputError
from tol3d.numerics.arrays import Array
from tol3d.statistics.estimates import Moments, RegressorSums
from tol3d.study.system.outcome import Outcome
from tol3d.study.system.positions import Positions


@dataclass(frozen=True)
class SumTerm:
    """One term of a sum.

    Args:
        name: of the term, such as the link whose play it is.
        factor: of the term in the sum.
    """

    name: str
    factor: float


@dataclass(frozen=True)
class Breakdown:
    """The terms of a measure.

    Args:
        measure: its name.
        terms: in the order in which they are added up.
        unit: of their columns.
        per_internal: one mm or rad in that unit.
    """

    measure: str
    terms: tuple[SumTerm, ...]
    unit: str
    per_internal: float

    def column(self, method: str, term: str) -> str:
        """Name of the column with a method's values of a term."""
        return f"{method}:{self.measure}:{term} [{self.unit}]"


Columns = Mapping[str, NDArray[Any]]


@dataclass(frozen=True)
class PooledTerms:
    """One method's terms of a breakdown, in its order; trials that could not be assembled are left out.

    Args:
        moments: of each term, in the breakdown's unit.
        sums: their co-moments; the last term is the target.
    """

    moments: tuple[Moments, ...]
    sums: RegressorSums

    @classmethod
    def of(cls, breakdown: Breakdown, method: str, columns: Columns, whole: Outcome) -> "PooledTerms | None":
        """The terms of one block; None if that method was not used.

        Args:
            breakdown, method: whose terms.
            columns: of the block.
            whole: outcome of the sum.
        """
        names = [breakdown.column(method, term.name) for term in breakdown.terms]
        if names[0] not in columns:
            return None
        rows = np.stack([np.asarray(columns[name], dtype=np.float64) for name in names])
        rows = rows[:, ~np.isnan(rows.sum(axis=0) + np.asarray(whole.values, dtype=np.float64))]
        return cls(tuple(Moments.of(row) for row in rows), RegressorSums.of_each(rows[:-1], rows[-1:])[0])

    def merge(self, other: "PooledTerms") -> "PooledTerms":
        """Both blocks as one."""
        moments = zip(self.moments, other.moments, strict=True)
        return PooledTerms(tuple(mine.merge(its) for mine, its in moments), self.sums.merge(other.sums))

    def shares(self, factors: Array) -> Array:
        """Each term's part of the variance of the sum of factor times term, (terms,); nan if nothing varies."""
        with np.errstate(invalid="ignore"):
            parts = factors * (self.sums.comoments @ factors)
            return np.asarray(parts / parts.sum())


LOW_SHARE: Final = 0.00135
HIGH_SHARE: Final = 0.99865
"""Between them lie 99.73 % of the trials, as between -3 and +3 sigma of a normal."""


@dataclass(frozen=True)
class Pool:
    """Statistics of the trials that were assembled, in the measure's unit.

    Args:
        mean, sigma, minimum, maximum: of the trials.
        quantile: value below which a share of them lies; None if it lies outside the grid.
    """

    mean: float
    sigma: float
    minimum: float
    maximum: float
    quantile: Callable[[float], float | None]


class PooledStatistic(Protocol):
    """One number of a pool."""

    @property
    def name(self) -> str:
        """Its key in summary.json."""
        ...

    def of(self, pool: Pool) -> float | None:
        """The number, in the measure's unit; None if unknown."""
        ...


@dataclass(frozen=True)
class HalfSpan:
    """Half of the span that holds 99.73 % of the trials, (p99.865 - p0.135)/2: a transmission error as it is stated."""

    name: str = "half_span"

    def of(self, pool: Pool) -> float | None:
        """See PooledStatistic."""
        low, high = pool.quantile(LOW_SHARE), pool.quantile(HIGH_SHARE)
        return None if low is None or high is None else (high - low) / 2


WHOLE_TURNS: Final = ("turn", "long_period")
AT_ONCE: Final = 2**20  # trials x positions; their transforms take 8 MB


@dataclass(frozen=True)
class Spectrum:
    """Harmonics of a curve over whole turns. Their amplitudes pool; a mean curve has smaller ones, for phases differ.

    Args:
        orders: cycles per turn of the shaft whose positions the curve is over, ascending; fractions where the positions
            span several turns.
    """

    orders: tuple[Fraction, ...]

    @classmethod
    def over(cls, positions: Positions, orders: Sequence[Fraction | int] = ()) -> Self:
        """Spectrum of those orders of curves over some positions; of all that they resolve if none are given.

        Raises:
            InputError: the positions are not whole turns, or cannot resolve an order.
        """
        if positions.over not in WHOLE_TURNS:
            raise InputError(f"a spectrum: expected a curve over whole turns, got one over {positions.over}")
        turns, highest = positions.turns, (positions.count - 1) // 2
        wanted = sorted({Fraction(order) for order in orders}) or [Fraction(k + 1, turns) for k in range(highest)]
        for order in wanted:
            cycles = order * turns
            if cycles.denominator != 1 or not 1 <= cycles <= highest:
                raise InputError(
                    f"a spectrum: expected orders of whole cycles in {turns} turns, at most {Fraction(highest, turns)} "
                    f"of them a turn at {positions.count} positions, got {order}"
                )
        return cls(tuple(wanted))

    def amplitudes(self, positions: Positions, curves: Array) -> Array:
        """Amplitude of each order in each trial, half of peak to peak, in the curves' unit.

        The coefficients of a discrete Fourier transform of evenly spaced samples: exact for a curve without cycles
        beyond half the number of samples. A turn's last position, where the first would come again, is left out.

        Args:
            positions: of the curves.
            curves: (trials, positions).

        Returns:
            (trials, orders).
        """
        count = positions.count
        cycles = [int(order * positions.turns) for order in self.orders]
        found, rows = np.empty((len(curves), len(cycles))), max(AT_ONCE // count, 1)
        for start in range(0, len(curves), rows):
            part = np.fft.rfft(curves[start : start + rows, :count], axis=1)
            found[start : start + rows] = 2 / count * np.abs(part[:, cycles])
        return found
