"""The Rayleigh distribution: the length of a vector whose x and y are independent normals."""

import math
from dataclasses import dataclass, replace
from typing import Final, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from tol3d.errors import InputError
from tol3d.files import Files
from tol3d.numerics.arrays import Array
from tol3d.statistics.distributions.base import Distribution, DistributionSpec, Place
from tol3d.units import Quantity

SAME: Final = 1e-12
"""Fraction of a scale; lengths that differ by less are equal."""


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

    @property
    def pivot(self) -> float:
        """No length: the vector's components are scaled about their means."""
        return 0.0

    def of_size(self, size: float) -> Self:
        """See Distribution: by its scale."""
        if not size > 0.0:
            raise InputError(f"expected a scale above 0, got {size:g}")
        return replace(self, scale=size)

    def mapped(self, place: Place, factor: float) -> Self:
        """See Distribution.

        Raises:
            InputError: another length than 0 stays.
        """
        if abs(place(0.0)) > SAME * self.scale:
            raise InputError("expected a Rayleigh law to be scaled about 0, for it begins there")
        return replace(self, scale=factor * self.scale)


class RayleighSpec(DistributionSpec):
    """`{scale}`: the length of a vector whose x and y have that sigma.

    Worst cases: its 0.135 and 99.865 % percentiles, with a direction its 99.73 % radius.
    """

    kind: Literal["rayleigh"]
    scale: Quantity = Field(description="most frequent value; the mean is 1.253 times as large")

    @model_validator(mode="after")
    def _refuse_nonsense(self) -> Self:
        self._refuse_unless_positive("scale")
        return self

    def resolve(self, files: Files) -> Rayleigh:
        """The law in mm, rad or K."""
        return Rayleigh(self.scale.internal)
