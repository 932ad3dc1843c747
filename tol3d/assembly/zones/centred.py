"""A law about 0, as another one spreads."""

from dataclasses import dataclass, replace
from typing import Self

from tol3d.errors import InputError
from tol3d.numerics.arrays import Array
from tol3d.statistics.distributions import Distribution
from tol3d.statistics.distributions.base import Place


@dataclass(frozen=True)
class Centred(Distribution):
    """Distribution with the spread of another one, centred about 0."""

    law: Distribution

    mean = 0.0

    def ppf(self, u: Array) -> Array:
        return self.law.ppf(u) - self.law.mean

    def cdf(self, x: Array) -> Array:
        return self.law.cdf(x + self.law.mean)

    @property
    def variance(self) -> float:
        return self.law.variance

    @property
    def limits(self) -> tuple[float, float] | None:
        found = self.law.limits
        return None if found is None else (found[0] - self.law.mean, found[1] - self.law.mean)

    def mapped(self, place: Place, factor: float) -> Self:
        """See Distribution.

        Raises:
            InputError: 0 does not stay.
        """
        if place(0.0) != 0.0:
            raise InputError("expected a law about 0 to be scaled about it")
        return replace(self, law=self.law.scaled(factor))

    def like(self, law: Distribution) -> Self:
        """As another law spreads."""
        return replace(self, law=law)
