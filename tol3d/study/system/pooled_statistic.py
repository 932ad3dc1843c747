"""Statistics of all trials of a measure together, besides those that every sample has: a measure names its own."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, Protocol

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
