"""A deviation that does not vary."""

from dataclasses import dataclass, replace
from typing import Literal, Self

import numpy as np
from pydantic import Field
from typing_extensions import override

from tol3d.errors import InputError
from tol3d.files import Files
from tol3d.numerics.arrays import Array
from tol3d.statistics.distributions.base import Distribution, DistributionSpec, Place
from tol3d.units import Quantity


@dataclass(frozen=True)
class Constant(Distribution):
    """All probability at `value`."""

    value: float

    def ppf(self, u: Array) -> Array:
        """The value, whatever u."""
        return np.full_like(u, self.value)

    def cdf(self, x: Array) -> Array:
        """0 below the value, 1 from it on."""
        return np.where(x >= self.value, 1.0, 0.0)

    @property
    def mean(self) -> float:
        """The value."""
        return self.value

    @property
    def variance(self) -> float:
        """0."""
        return 0.0

    @property
    def limits(self) -> tuple[float, float]:
        """The value, twice."""
        return self.value, self.value

    def of_size(self, size: float) -> Self:
        """See Distribution: its value."""
        return replace(self, value=size)

    @override
    def shifted(self, by: float) -> Self:
        return replace(self, value=self.value + by)

    def mapped(self, place: Place, factor: float) -> Self:
        """See Distribution.

        Raises:
            InputError: always.
        """
        raise InputError("expected a law that can be scaled, got a constant, which does not spread")


class ConstantSpec(DistributionSpec):
    """`{value}`: the same in every trial."""

    kind: Literal["constant"]
    value: Quantity = Field(description="the deviation of every build")

    def resolve(self, files: Files) -> Constant:
        """The law in mm, rad or K."""
        return Constant(self.value.internal)
