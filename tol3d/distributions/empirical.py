"""A distribution taken from measured values: a column of a CSV file."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal, Self

import numpy as np
from pydantic import Field, model_validator

from tol3d.distributions.base import LARGEST_DEVIATION, Distribution, DistributionSpec, Place
from tol3d.distributions.csv_table import csv_table
from tol3d.errors import SceneError
from tol3d.files import Files
from tol3d.numerics.arrays import Array
from tol3d.strict import refused
from tol3d.units import ABSOLUTE_ZERO, MICRO_SIGNS, UNITS, Quantity


@dataclass(frozen=True, eq=False)
class Empirical(Distribution):
    """The law whose quantiles run linearly between the order statistics of a sample.

    Q(k / (n - 1)) is the k-th of the n sorted values, k = 0 .. n - 1, and Q is linear in between
    (Hyndman and Fan 1996, type 7, as numpy.quantile). Mean and variance are those of this law,
    exactly; they differ from the sample's own by terms of order 1/n, since the law has the
    sample's smallest and largest value as its ends. Two of them are equal only if they are one object.

    Args:
        values: (n,) the sorted sample, n >= 2.
    """

    values: Array

    def ppf(self, u: Array) -> Array:
        """Q(u): linear between the two order statistics about u (n - 1)."""
        position = u * (len(self.values) - 1)
        below = np.minimum(position.astype(np.int64), len(self.values) - 2)
        start = self.values[below]
        value: Array = start + (position - below) * (self.values[below + 1] - start)
        return value

    def cdf(self, x: Array) -> Array:
        """The inverse of Q; where values repeat it jumps, and takes the upper end."""
        probability: Array = np.interp(x, self.values, np.arange(len(self.values)) / (len(self.values) - 1))
        return np.where(x < self.values[0], 0.0, probability)

    @cached_property
    def _moments(self) -> tuple[float, float]:
        # each segment of Q is uniform between its ends a, b: E = (a + b)/2, E of the square = (a^2 + ab + b^2)/3
        start = self.values[0]
        a, b = self.values[:-1] - start, self.values[1:] - start
        mean = float(np.mean((a + b) / 2))
        a, b = a - mean, b - mean
        return float(start + mean), float(np.mean((a * a + a * b + b * b) / 3))

    @property
    def mean(self) -> float:
        """Mean of the middles of the segments between order statistics."""
        return self._moments[0]

    @property
    def variance(self) -> float:
        """Mean over the segments (a, b) of (a^2 + a b + b^2) / 3, a and b taken from the mean."""
        return self._moments[1]

    @property
    def extremes(self) -> tuple[float, float]:
        """The smallest and the largest value of the sample."""
        return float(self.values[0]), float(self.values[-1])

    def mapped(self, place: Place, factor: float) -> Self:
        """See Distribution."""
        sample = np.array([place(own) for own in self.values.tolist()])
        sample.flags.writeable = False
        return replace(self, values=sample)


class EmpiricalSpec(DistributionSpec):
    """`{file, column, unit}`: a CSV file with a header row; commas or semicolons between the cells.

    Numbers have decimal points, or decimal commas where these separate no cells.
    """

    kind: Literal["empirical"]
    file: str = Field(description="CSV file with a header row, from the folder of the scene")
    column: str = Field(description="its column of measured deviations")
    unit: str = Field(description="of the numbers in that column, such as um")

    @model_validator(mode="after")
    def _refuse_nonsense(self) -> Self:
        if not self.file.strip() or "\0" in self.file:
            raise refused("file", "the name of a CSV file", repr(self.file))
        return self

    @model_validator(mode="before")
    @classmethod
    def _refuse_unknown_unit(cls, data: object) -> object:
        unit = data.get("unit") if isinstance(data, dict) else None
        if isinstance(unit, str) and unit.translate(MICRO_SIGNS) not in UNITS:
            raise refused("unit", f"one of {', '.join(UNITS)}", repr(unit))
        return data

    def quantities(self) -> dict[str, Quantity]:
        """One of the unit, under the field `unit`."""
        return {"unit": Quantity(1.0, self.unit.translate(MICRO_SIGNS))}

    def file_names(self) -> Iterator[tuple[str, str]]:
        """The CSV file."""
        yield "file", self.file

    def resolve(self, files: Files) -> Empirical:
        """Read the column.

        Raises:
            SceneError: the file is no CSV, or a cell is no number; the text names file and line.
        """
        file = files[self.file]
        column = csv_table(file).column(self.column)
        if len(column.cells) < 2:
            raise SceneError(
                f"{file.path}: expected at least two values in column {self.column!r}, got {len(column.cells)}"
            )
        sample = np.array(column.numbers()) * self.quantities()["unit"].internal
        if not np.all(np.abs(sample) <= LARGEST_DEVIATION):
            raise SceneError(f"{file.path}: expected deviations of less than 1e9 mm, rad or K")
        if self.quantities()["unit"].dimension == "temperature" and sample.min() < ABSOLUTE_ZERO:
            least = f"at least {ABSOLUTE_ZERO} K, which is absolute zero"
            raise SceneError(f"{file.path}: expected {least}, in column {self.column!r}, got {sample.min():.6g} K")
        sample = np.sort(sample)
        sample.flags.writeable = False
        return Empirical(sample)
