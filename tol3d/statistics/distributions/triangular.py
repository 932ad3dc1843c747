"""The triangular distribution: two limits and the most likely value."""

from dataclasses import dataclass, replace
from typing import Literal, Self

import numpy as np
from pydantic import Field, model_validator
from typing_extensions import override

from tol3d.files import Files
from tol3d.numerics.arrays import Array
from tol3d.statistics.distributions.base import Distribution, DistributionSpec, Place
from tol3d.strict import refused
from tol3d.units import Quantity


@dataclass(frozen=True)
class Triangular(Distribution):
    """Density rising linearly from `lower` to `mode` and falling linearly to `upper`."""

    lower: float
    mode: float
    upper: float

    def ppf(self, u: Array) -> Array:
        """lower + sqrt(u (b - a)(c - a)) up to the mode, upper - sqrt((1 - u)(b - a)(b - c)) beyond."""
        width, rise, fall = self.upper - self.lower, self.mode - self.lower, self.upper - self.mode
        rising = self.lower + np.sqrt(u * (width * rise))
        falling = self.upper - np.sqrt((1 - u) * (width * fall))
        return np.where(u * width < rise, rising, falling)

    def cdf(self, x: Array) -> Array:
        """(x - a)^2 / ((b - a)(c - a)) up to the mode, 1 - (b - x)^2 / ((b - a)(b - c)) beyond."""
        width, rise, fall = self.upper - self.lower, self.mode - self.lower, self.upper - self.mode
        inside = np.clip(x, self.lower, self.upper)
        # a side of no width is never chosen; 1.0 only keeps its division defined
        rising = (inside - self.lower) ** 2 / (width * rise if rise > 0 else 1.0)
        falling = 1 - (self.upper - inside) ** 2 / (width * fall if fall > 0 else 1.0)
        return np.where(inside < self.mode, rising, falling)

    @property
    def mean(self) -> float:
        """(a + b + c) / 3."""
        return (self.lower + self.mode + self.upper) / 3

    @property
    def variance(self) -> float:
        """(rise^2 + rise fall + fall^2) / 18, rise = mode - lower, fall = upper - mode."""
        rise, fall = self.mode - self.lower, self.upper - self.mode
        return (rise**2 + rise * fall + fall**2) / 18

    @property
    def limits(self) -> tuple[float, float]:
        """Lower and upper, as stated."""
        return self.lower, self.upper

    @override
    def mapped(self, place: Place, factor: float) -> Self:
        return replace(self, lower=place(self.lower), mode=place(self.mode), upper=place(self.upper))


class TriangularSpec(DistributionSpec):
    """`{lower, mode, upper}`; the mode may lie at a limit. Worst cases: the limits."""

    kind: Literal["triangular"]
    lower: Quantity = Field(description="smallest deviation")
    mode: Quantity = Field(description="most frequent deviation")
    upper: Quantity = Field(description="largest deviation")

    @model_validator(mode="after")
    def _refuse_nonsense(self) -> Self:
        self._refuse_unless_ordered("lower", "upper")
        if not self.lower.internal <= self.mode.internal <= self.upper.internal:
            raise refused("mode", f"it between lower and upper ({self.lower} to {self.upper})", self.mode)
        return self

    def resolve(self, files: Files) -> Triangular:
        """The law in mm, rad or K."""
        return Triangular(self.lower.internal, self.mode.internal, self.upper.internal)
