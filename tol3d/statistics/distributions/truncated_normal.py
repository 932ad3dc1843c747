"""The normal distribution cut off at two limits, as sorted or adjusted parts have it."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal, Self

import numpy as np
from pydantic import Field, model_validator
from typing_extensions import override

from tol3d.files import Files
from tol3d.numerics.arrays import Array
from tol3d.statistics.distributions import standard_normal
from tol3d.statistics.distributions.base import Distribution, DistributionSpec, Place
from tol3d.strict import refused
from tol3d.units import Quantity

LEAST_KEPT = 1e-3  # of the untruncated normal; under it the closed-form variance loses more than 1e-6 to cancellation
LARGEST_Z = 40.0  # sigmas; the density underflows to 0 before it, and z * density(z) stays finite


@dataclass(frozen=True)
class TruncatedNormal(Distribution):
    """A normal law (location, scale) given that it falls between `lower` and `upper`.

    Source of the moments: Johnson, Kotz, Balakrishnan, Continuous Univariate Distributions 1,
    2nd ed., 1994, section 13.10.1.
    """

    location: float
    scale: float
    lower: float
    upper: float

    @cached_property
    def kept(self) -> float:
        """The probability that the untruncated normal falls between the limits."""
        alpha, beta = self._standard_limits
        return standard_normal.probability_below(beta) - standard_normal.probability_below(alpha)

    @cached_property
    def _standard_limits(self) -> tuple[float, float]:
        alpha, beta = ((limit - self.location) / self.scale for limit in (self.lower, self.upper))
        return max(-LARGEST_Z, min(alpha, LARGEST_Z)), max(-LARGEST_Z, min(beta, LARGEST_Z))

    def ppf(self, u: Array) -> Array:
        """location + scale * Phi^-1(Phi(alpha) + u (Phi(beta) - Phi(alpha))), never outside the limits."""
        probability = standard_normal.probability_below(self._standard_limits[0]) + u * self.kept
        return np.clip(self.location + self.scale * standard_normal.ppf(probability), self.lower, self.upper)

    def cdf(self, x: Array) -> Array:
        """(Phi(z) - Phi(alpha)) / (Phi(beta) - Phi(alpha)) between the limits."""
        inside = np.clip((x - self.location) / self.scale, *self._standard_limits)
        below_alpha = standard_normal.probability_below(self._standard_limits[0])
        return np.clip((standard_normal.cdf(inside) - below_alpha) / self.kept, 0.0, 1.0)

    @property
    def mean(self) -> float:
        """location + scale (phi(alpha) - phi(beta)) / kept."""
        alpha, beta = self._standard_limits
        return self.location + self.scale * (standard_normal.density(alpha) - standard_normal.density(beta)) / self.kept

    @property
    def variance(self) -> float:
        """scale^2 (1 + (alpha phi(alpha) - beta phi(beta)) / kept - ((phi(alpha) - phi(beta)) / kept)^2)."""
        alpha, beta = self._standard_limits
        at_alpha, at_beta = standard_normal.density(alpha), standard_normal.density(beta)
        shift = (at_alpha - at_beta) / self.kept
        return self.scale**2 * (1 + (alpha * at_alpha - beta * at_beta) / self.kept - shift**2)

    @property
    def limits(self) -> tuple[float, float]:
        """Lower and upper, as stated."""
        return self.lower, self.upper

    @override
    def mapped(self, place: Place, factor: float) -> Self:
        location, scale = place(self.location), factor * self.scale
        return replace(self, location=location, scale=scale, lower=place(self.lower), upper=place(self.upper))


class TruncatedNormalSpec(DistributionSpec):
    """`{mean, sigma, lower, upper}`: mean and sigma are those of the normal before it is cut.

    Nothing is beyond the limits, which are the worst cases.
    """

    kind: Literal["truncated_normal"]
    mean: Quantity = Field(description="mean before it is cut")
    sigma: Quantity = Field(description="standard deviation before it is cut")
    lower: Quantity = Field(description="smallest deviation")
    upper: Quantity = Field(description="largest deviation")

    @model_validator(mode="after")
    def _refuse_nonsense(self) -> Self:
        self._refuse_unless_positive("sigma")
        self._refuse_unless_ordered("lower", "upper")
        kept = self._law().kept
        if not math.isfinite(kept) or kept < LEAST_KEPT:
            expected = f"limits that keep at least {LEAST_KEPT:.1%} of the normal (else uniform or triangular say it)"
            raise refused("lower", expected, f"{self.lower} to {self.upper}, which keep {kept:.2g}")
        return self

    @override
    def numbers(self, law: Distribution) -> Mapping[str, float]:
        if not isinstance(law, TruncatedNormal):
            return super().numbers(law)
        low, high = law.limits
        return {"lower": low, "upper": high, "mean": law.location, "sigma": law.scale}

    def resolve(self, files: Files) -> TruncatedNormal:
        """The law in mm, rad or K."""
        return self._law()

    def _law(self) -> TruncatedNormal:
        return TruncatedNormal(self.mean.internal, self.sigma.internal, self.lower.internal, self.upper.internal)
