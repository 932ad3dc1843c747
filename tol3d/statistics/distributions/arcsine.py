"""The arcsine distribution: a sine at a random phase, such as an error that runs through its period."""

import math
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
class Arcsine(Distribution):
    """A sine between `lower` and `upper` at a random phase: most often near its ends.

    >>> law = Arcsine(-1.0, 1.0)
    >>> law.mean, round(law.sigma, 4)
    (0.0, 0.7071)
    """

    lower: float
    upper: float

    def ppf(self, u: Array) -> Array:
        """The middle less half the range times cos(pi u)."""
        half = (self.upper - self.lower) / 2
        return np.asarray(self.mean - half * np.cos(np.pi * u))

    def cdf(self, x: Array) -> Array:
        """arccos((middle - x) / half the range) / pi between the limits."""
        half = (self.upper - self.lower) / 2
        return np.asarray(np.arccos(np.clip((self.mean - x) / half, -1.0, 1.0)) / np.pi)

    @property
    def mean(self) -> float:
        """The middle."""
        return (self.lower + self.upper) / 2

    @property
    def variance(self) -> float:
        """(upper - lower)^2 / 8: half of the square of the amplitude."""
        return (self.upper - self.lower) ** 2 / 8

    @property
    def sigma(self) -> float:
        """The amplitude by the root of 2."""
        return (self.upper - self.lower) / math.sqrt(8.0)

    @property
    def limits(self) -> tuple[float, float]:
        """Lower and upper, as stated."""
        return self.lower, self.upper

    @override
    def mapped(self, place: Place, factor: float) -> Self:
        return replace(self, lower=place(self.lower), upper=place(self.upper))


class ArcsineSpec(DistributionSpec):
    """`{lower, upper}`: a sine between them at a random phase, such as a periodic error. Worst cases: both."""

    kind: Literal["arcsine"]
    lower: Quantity = Field(description="smallest deviation")
    upper: Quantity = Field(description="largest deviation")

    @model_validator(mode="after")
    def _refuse_nonsense(self) -> Self:
        self._refuse_unless_ordered("lower", "upper")
        return self

    def resolve(self, files: Files) -> Arcsine:
        """The law in mm, rad or K."""
        return Arcsine(self.lower.internal, self.upper.internal)
