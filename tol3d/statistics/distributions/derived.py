"""The law of a deviation that follows from what a shop measures, such as an arc from the size over pins."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final, Protocol, Self

import numpy as np
from typing_extensions import override

from tol3d.numerics.arrays import Array
from tol3d.statistics.distributions.base import Distribution, Stays

NODES: Final = 2048  # of the part that is not linear, which is a thousandth of a tolerance: its error is far below 1 nm
STEP: Final = 1e-4  # of the slope at the mean [mm]; central differences


class Scale(Protocol):
    """Scale of a measured deviation; it rises or falls throughout."""

    @property
    def words(self) -> str:
        """Name of the measured quantity."""
        ...

    def deviation(self, measured: Array) -> Array:
        """Deviations (n,) of measured ones (n,) [mm]; elementwise."""
        ...

    def measured(self, deviation: Array) -> Array:
        """The inverse."""
        ...


@dataclass(frozen=True)
class Proportion:
    """A deviation in proportion to what is measured."""

    factor: float
    words: str

    def deviation(self, measured: Array) -> Array:
        """See Scale."""
        return self.factor * measured

    def measured(self, deviation: Array) -> Array:
        """See Scale."""
        return deviation / self.factor


@dataclass(frozen=True, eq=False)
class Derived(Distribution):
    """The law of a deviation of which another one is measured.

    Args:
        measured: the law of what is measured, as the scene states it.
        scale: from that to the deviation.
    """

    measured: Distribution
    scale: Scale

    @property
    @override
    def words(self) -> str:
        return f"{self.measured.words} of {self.scale.words}"

    @cached_property
    def _rises(self) -> bool:
        return self._slope > 0.0

    @cached_property
    def _slope(self) -> float:
        """At the mean of what is measured."""
        low, high = self.scale.deviation(self.measured.mean + np.array([-STEP, STEP]))
        return float(high - low) / (2 * STEP)

    def ppf(self, u: Array) -> Array:
        """The deviation of the measured one of u, of 1 - u where one falls as the other rises."""
        return self.scale.deviation(self.measured.ppf(u if self._rises else 1 - u))

    def cdf(self, x: Array) -> Array:
        """Distribution function of the measured quantity."""
        found = self.measured.cdf(self.scale.measured(np.asarray(x, np.float64)))
        return found if self._rises else 1 - found

    @cached_property
    def _moments(self) -> tuple[float, float]:
        """Mean and variance: of the straight line exact, and what is left of it by quantiles."""
        own = self.measured
        at = own.ppf((np.arange(NODES) + 0.5) / NODES) - own.mean
        start = float(self.scale.deviation(np.array([own.mean]))[0])
        bent = self.scale.deviation(own.mean + at) - start - self._slope * at
        variance = self._slope**2 * own.variance + 2 * self._slope * float(np.mean(at * bent)) + float(np.var(bent))
        return start + float(np.mean(bent)), variance

    @property
    @override
    def mean(self) -> float:
        return self._moments[0]

    @property
    @override
    def variance(self) -> float:
        return self._moments[1]

    def _ends(self, ends: tuple[float, float]) -> tuple[float, float]:
        low, high = sorted(self.scale.deviation(np.array(ends)).tolist())
        return low, high

    @property
    def limits(self) -> tuple[float, float] | None:
        """Those of the deviation."""
        return None if self.measured.limits is None else self._ends(self.measured.limits)

    @property
    @override
    def extremes(self) -> tuple[float, float]:
        return self._ends(self.measured.extremes)

    @property
    @override
    def pivot(self) -> float:
        return float(self.scale.deviation(np.array([self.measured.pivot]))[0])

    def scaled(self, factor: float, about: float | None = None) -> Self:
        """See Distribution: what is measured."""
        stays = None if about is None else float(self.scale.measured(np.array([about]))[0])
        return replace(self, measured=self.measured.scaled(factor, stays))

    def scaled_at(self, factor: float, stays: Stays) -> Self:
        """See Distribution: a limit is that of what is measured."""
        return replace(self, measured=self.measured.scaled_at(factor, stays))

    @override
    def of_size(self, size: float) -> Self:
        start, end = self.scale.measured(np.array([0.0, size])).tolist()
        return replace(self, measured=self.measured.of_size(abs(end - start)))

    @override
    def within(self, low: float, high: float) -> Self:
        ends = sorted(self.scale.measured(np.array([low, high])).tolist())
        return replace(self, measured=self.measured.within(*ends))
