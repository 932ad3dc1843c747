"""The normal distribution, by its limits or by mean and sigma."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Final, Literal, Self

from pydantic import Field, model_validator
from typing_extensions import override

from tol3d.files import Files
from tol3d.numerics.arrays import Array
from tol3d.statistics.distributions import standard_normal
from tol3d.statistics.distributions.base import Distribution, DistributionSpec, Place
from tol3d.strict import refused
from tol3d.units import Quantity

SAME: Final = 1e-12
"""Fraction of a sigma; a location nearer than that to the middle of the limits counts as the middle."""
SIGMAS_DIGITS: Final = 9
"""Significant digits of the number of sigmas at limits, a number that somebody wrote."""


@dataclass(frozen=True)
class Normal(Distribution):
    """A normal law about `location` with standard deviation `scale`.

    `stated` are the limits that were written (draws go beyond them); None means +-3 sigma.
    """

    location: float
    scale: float
    stated: tuple[float, float] | None = None

    def ppf(self, u: Array) -> Array:
        """location + scale * Phi^-1(u)."""
        return self.location + self.scale * standard_normal.ppf(u)

    def cdf(self, x: Array) -> Array:
        """Phi((x - location) / scale)."""
        return standard_normal.cdf((x - self.location) / self.scale)

    @property
    def mean(self) -> float:
        """The location."""
        return self.location

    @property
    def variance(self) -> float:
        """The scale, squared."""
        return self.scale**2

    @property
    def limits(self) -> tuple[float, float]:
        """The stated ones, or mean +- 3 sigma."""
        return self.stated or (self.location - 3 * self.scale, self.location + 3 * self.scale)

    @property
    def extremes(self) -> tuple[float, float]:
        """The limits, or mean -+ 3 sigma where these are wider."""
        low, high = self.limits
        return min(low, self.location - 3 * self.scale), max(high, self.location + 3 * self.scale)

    def mapped(self, place: Place, factor: float) -> Self:
        """See Distribution; of stated limits the middle and the sigma follow as a scene states them."""
        if self.stated is None:
            return replace(self, location=place(self.location), scale=factor * self.scale)
        low, high = (place(own) for own in self.stated)
        if abs(sum(self.stated) / 2 - self.location) > SAME * self.scale:
            return replace(self, location=place(self.location), scale=factor * self.scale, stated=(low, high))
        sigmas = round((self.stated[1] - self.stated[0]) / (2 * self.scale), SIGMAS_DIGITS)
        return replace(self, location=(low + high) / 2, scale=(high - low) / (2 * sigmas), stated=(low, high))


class NormalSpec(DistributionSpec):
    """`{lower, upper, sigmas}`: limits at +-sigmas about their middle, which draws exceed; or `{mean, sigma}`.

    Worst cases: the limits, or the mean +-3 sigma.
    """

    kind: Literal["normal"]
    lower: Quantity | None = Field(default=None, description="lower limit")
    upper: Quantity | None = Field(default=None, description="upper limit")
    sigmas: float = Field(default=3.0, description="standard deviations from the middle to either limit")
    mean: Quantity | None = Field(default=None, description="mean, instead of limits")
    sigma: Quantity | None = Field(default=None, description="standard deviation, with the mean")

    @model_validator(mode="after")
    def _refuse_nonsense(self) -> Self:
        given = self.quantities()
        if given.keys() == {"lower", "upper"}:
            self._refuse_unless_ordered("lower", "upper")
            if not self.sigmas > 0.0:
                raise refused("sigmas", "a number above 0", self.sigmas)
        elif given.keys() == {"mean", "sigma"}:
            self._refuse_unless_positive("sigma")
            if "sigmas" in self.model_fields_set:
                raise refused("sigmas", "it beside lower and upper only", self.sigmas)
        else:
            got = " and ".join(given) or "none of them"
            raise refused("kind", "either lower and upper, or mean and sigma", got)
        return self

    @override
    def numbers(self, law: Distribution) -> Mapping[str, float]:
        if not isinstance(law, Normal):
            return super().numbers(law)
        low, high = law.limits
        return {"lower": low, "upper": high, "mean": law.location, "sigma": law.scale}

    def resolve(self, files: Files) -> Normal:
        """The law in mm, rad or K."""
        values = {name: quantity.internal for name, quantity in self.quantities().items()}
        if "sigma" in values:
            return Normal(values["mean"], values["sigma"])
        lower, upper = values["lower"], values["upper"]
        return Normal((lower + upper) / 2, (upper - lower) / (2 * self.sigmas), (lower, upper))
