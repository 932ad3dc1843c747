"""A power law: the density between two limits grows with a power of the distance from the lower one."""

from dataclasses import dataclass
from typing import Literal, Self

import numpy as np
from pydantic import Field, model_validator

from tol3d.files import Files
from tol3d.numerics.arrays import Array
from tol3d.statistics.distributions import Distribution, DistributionSpec
from tol3d.units import Quantity


@dataclass(frozen=True)
class Power(Distribution):
    """lower + width u^(1/k): density k/width ((x - lower)/width)^(k - 1)."""

    lower: float
    upper: float
    k: float

    @property
    def width(self) -> float:
        return self.upper - self.lower

    def ppf(self, u: Array) -> Array:
        return np.asarray(self.lower + self.width * u ** (1.0 / self.k))

    def cdf(self, x: Array) -> Array:
        return np.asarray(np.clip((x - self.lower) / self.width, 0.0, 1.0) ** self.k)

    @property
    def mean(self) -> float:
        return self.lower + self.width * self.k / (self.k + 1.0)

    @property
    def variance(self) -> float:
        return self.width**2 * self.k / ((self.k + 1.0) ** 2 * (self.k + 2.0))

    @property
    def limits(self) -> tuple[float, float]:
        return self.lower, self.upper


class PowerSpec(DistributionSpec):
    """`{lower, upper, k}`."""

    kind: Literal["power"]
    lower: Quantity
    upper: Quantity
    k: float = Field(gt=0.0, le=1000.0)

    @model_validator(mode="after")
    def _refuse_nonsense(self) -> Self:
        self._refuse_unless_ordered("lower", "upper")
        return self

    def resolve(self, files: Files) -> Power:
        return Power(self.lower.internal, self.upper.internal, self.k)
