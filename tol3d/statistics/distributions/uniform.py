"""The uniform distribution: every deviation between two limits alike."""

from dataclasses import dataclass, replace
from typing import Literal, Self

import numpy as np
from pydantic import Field, model_validator
from typing_extensions import override

from tol3d.files import Files
from tol3d.numerics.arrays import Array
from tol3d.statistics.distributions.base import Distribution, DistributionSpec, Place
from tol3d.units import Quantity


@dataclass(frozen=True)
class Uniform(Distribution):
    """Constant density between `lower` and `upper`."""

    lower: float
    upper: float

    def ppf(self, u: Array) -> Array:
        """lower + u (upper - lower)."""
        return self.lower + u * (self.upper - self.lower)

    def cdf(self, x: Array) -> Array:
        """(x - lower) / (upper - lower) between the limits."""
        return np.clip((x - self.lower) / (self.upper - self.lower), 0.0, 1.0)

    @property
    def mean(self) -> float:
        """The middle."""
        return (self.lower + self.upper) / 2

    @property
    def variance(self) -> float:
        """(upper - lower)^2 / 12."""
        return (self.upper - self.lower) ** 2 / 12

    @property
    def limits(self) -> tuple[float, float]:
        """Lower and upper, as stated."""
        return self.lower, self.upper

    @override
    def mapped(self, place: Place, factor: float) -> Self:
        return replace(self, lower=place(self.lower), upper=place(self.upper))


class UniformSpec(DistributionSpec):
    """`{lower, upper}`: equally likely everywhere between them. Worst cases: both."""

    kind: Literal["uniform"]
    lower: Quantity = Field(description="smallest deviation")
    upper: Quantity = Field(description="largest deviation")

    @model_validator(mode="after")
    def _refuse_nonsense(self) -> Self:
        self._refuse_unless_ordered("lower", "upper")
        return self

    def resolve(self, files: Files) -> Uniform:
        """The law in mm, rad or K."""
        return Uniform(self.lower.internal, self.upper.internal)
