"""A law less its mean."""

from dataclasses import dataclass

from tol3d.assembly.zones.domain import Array
from tol3d.distributions import Distribution


@dataclass(frozen=True)
class Centred(Distribution):
    """Of deviations that spread as another law does, about 0."""

    law: Distribution

    mean = 0.0

    def ppf(self, u: Array) -> Array:
        """See Distribution."""
        return self.law.ppf(u) - self.law.mean

    def cdf(self, x: Array) -> Array:
        """See Distribution."""
        return self.law.cdf(x + self.law.mean)

    @property
    def variance(self) -> float:
        """See Distribution."""
        return self.law.variance

    @property
    def limits(self) -> tuple[float, float] | None:
        """See Distribution."""
        found = self.law.limits
        return None if found is None else (found[0] - self.law.mean, found[1] - self.law.mean)
