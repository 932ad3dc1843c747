"""The Rayleigh distribution: the length of a vector whose x and y are independent normals."""

import math
from dataclasses import dataclass
from typing import Literal, Self

import numpy as np
from pydantic import model_validator

from tol3d.distributions.base import Distribution, DistributionSpec
from tol3d.files import Files
from tol3d.numerics.arrays import Array
from tol3d.units import Quantity


@dataclass(frozen=True)
class Rayleigh(Distribution):
    """Length of a plane vector; `scale` is the standard deviation of each of its components.

    >>> round(Rayleigh(scale=4.5).mean, 4), round(Rayleigh(scale=4.5).sigma, 4)
    (5.6399, 2.9481)
    """

    scale: float

    def ppf(self, u: Array) -> Array:
        """scale sqrt(-2 ln(1 - u))."""
        length: Array = self.scale * np.sqrt(-2 * np.log1p(-u))
        return length

    def cdf(self, x: Array) -> Array:
        """1 - exp(-x^2 / (2 scale^2)) for x > 0."""
        ratio = np.maximum(x, 0.0) / self.scale
        probability: Array = -np.expm1(-ratio * ratio / 2)
        return probability

    @property
    def mean(self) -> float:
        """scale sqrt(pi / 2)."""
        return self.scale * math.sqrt(math.pi / 2)

    @property
    def variance(self) -> float:
        """(2 - pi / 2) scale^2."""
        return (2 - math.pi / 2) * self.scale**2


class RayleighSpec(DistributionSpec):
    """`{scale}`."""

    kind: Literal["rayleigh"]
    scale: Quantity

    @model_validator(mode="after")
    def _refuse_nonsense(self) -> Self:
        self._refuse_unless_positive("scale")
        return self

    def resolve(self, files: Files) -> Rayleigh:
        """The law in mm, rad or K."""
        return Rayleigh(self.scale.internal)
