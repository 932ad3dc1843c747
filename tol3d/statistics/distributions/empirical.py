"""A distribution taken from measured values: a column of a CSV file."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal, Self

import numpy as np
from pydantic import Field, model_validator
from typing_extensions import override

from tol3d.errors import Problem, SceneError
from tol3d.files import Files
from tol3d.numerics.arrays import Array
from tol3d.statistics.distributions.base import LARGEST_DEVIATION, Distribution, DistributionSpec, Place
from tol3d.statistics.distributions.csv_table import csv_table
from tol3d.strict import refused
from tol3d.units import ABSOLUTE_ZERO, MICRO_SIGNS, UNITS, Quantity

Draws = Literal["smoothed", "as_measured"]
"""Reading of a sample as a law."""


@dataclass(frozen=True, eq=False)
class Piecewise(Distribution):
    """The law whose quantiles run linearly between knots, and jump where two knots have one probability.

    Two of them are equal only if they are one object.

    Args:
        probabilities: (m,) of the knots, ascending from 0 to 1.
        values: (m,) the quantiles there [mm, rad or K], ascending.
    """

    probabilities: Array
    values: Array

    def ppf(self, u: Array) -> Array:
        """The quantiles, linear between the two knots about u."""
        below = np.clip(np.searchsorted(self.probabilities, u, side="right") - 1, 0, len(self.values) - 2)
        start, first = self.values[below], self.probabilities[below]
        width = self.probabilities[below + 1] - first
        share = np.divide(u - first, width, out=np.ones_like(start), where=width > 0.0)
        value: Array = start + share * (self.values[below + 1] - start)
        return value

    def cdf(self, x: Array) -> Array:
        """The inverse of the quantiles; where values repeat it jumps, and takes the upper end."""
        return np.where(x < self.values[0], 0.0, np.interp(x, self.values, self.probabilities))

    @cached_property
    def _moments(self) -> tuple[float, float]:
        # between two knots the law is uniform from a to b: E = (a + b)/2, E of the square = (a^2 + ab + b^2)/3
        start, shares = self.values[0], np.diff(self.probabilities)
        a, b = self.values[:-1] - start, self.values[1:] - start
        mean = float(shares @ (a + b)) / 2
        a, b = a - mean, b - mean
        return float(start + mean), float(shares @ (a * a + a * b + b * b)) / 3

    @property
    def mean(self) -> float:
        """Mean of the middles of the segments between knots, each by its probability."""
        return self._moments[0]

    @property
    def variance(self) -> float:
        """Mean over the segments (a, b) of (a^2 + a b + b^2) / 3, a and b taken from the mean."""
        return self._moments[1]

    @property
    def extremes(self) -> tuple[float, float]:
        """The first and the last knot, beyond which nothing is drawn."""
        return float(self.values[0]), float(self.values[-1])

    @override
    def mapped(self, place: Place, factor: float) -> Self:
        return replace(self, values=np.array([place(own) for own in self.values.tolist()]))


@dataclass(frozen=True, eq=False)
class Empirical(Distribution):
    """The law of a sample: its values as they are, or smoothed. Two of them are equal only if they are one object.

    As measured, each value is drawn as often as the others: of n values that has the variance s^2 (n - 1)/n and nothing
    beyond them. Smoothed, each value is spread evenly to both sides, so that the law has the sample's mean and variance
    s^2: widths w_i to each side add the mean of w_i^2 / 3, which is made s^2 / n. All are sqrt(3/n) s, except in a
    sample of one sign, such as lengths: there no value is spread over 0, and the others are spread a little wider. (Of
    two values of one sign that can leave less than s^2.)

    Args:
        values: (n,) the sorted sample [mm, rad or K], n >= 2.
        draws: which of both.
        knots: its quantiles, where they are known.
    """

    values: Array
    draws: Draws = "smoothed"
    knots: Piecewise | None = None

    @cached_property
    def _law(self) -> Piecewise:
        if self.knots is not None:
            return self.knots
        sample = self.values
        wanted = 3 * float(np.var(sample, ddof=1))  # of the sum of all w_i^2
        if self.draws == "as_measured" or wanted == 0.0:
            steps = np.repeat(np.arange(len(sample) + 1) / len(sample), 2)[1:-1]
            return Piecewise(steps, np.repeat(sample, 2))
        if sample[-1] <= 0.0:
            mirrored = Empirical(-sample[::-1])._law
            return Piecewise(1.0 - mirrored.probabilities[::-1], 0.0 - mirrored.values[::-1])
        width, narrow = _widths(sample, wanted) if sample[0] >= 0.0 else (math.sqrt(wanted / len(sample)), 0)
        return _spread(sample, width, narrow)

    @property
    @override
    def words(self) -> str:
        return f"empirical, {len(self.values)} values {self.draws.replace('_', ' ')}"

    @override
    def ppf(self, u: Array) -> Array:
        return self._law.ppf(u)

    @override
    def cdf(self, x: Array) -> Array:
        return self._law.cdf(x)

    @property
    def mean(self) -> float:
        """Mean of the sample."""
        return self._law.mean

    @property
    def variance(self) -> float:
        """The sample's, with n - 1 where smoothed, with n as measured."""
        return self._law.variance

    @property
    def extremes(self) -> tuple[float, float]:
        """Ends of the law, beyond which nothing is drawn."""
        return self._law.extremes

    @override
    def mapped(self, place: Place, factor: float) -> Self:
        sample = np.array([place(own) for own in self.values.tolist()])
        sample.flags.writeable = False
        return replace(self, values=sample, knots=self._law.mapped(place, factor))


def _widths(sample: Array, wanted: float) -> tuple[float, int]:
    """Width w, and the number of first values below it, for which the squares of min(w, value) have a sum.

    Args:
        sample: (n,) ascending, none below 0.
        wanted: the sum; the largest value where all together have less.
    """
    left = wanted - np.concatenate([[0.0], np.cumsum(sample[:-1] ** 2)])
    widths = np.sqrt(np.maximum(left, 0.0) / np.arange(len(sample), 0, -1))
    fits = np.flatnonzero(widths <= sample)
    return (float(widths[fits[0]]), int(fits[0])) if len(fits) else (float(sample[-1]), len(sample))


def _spread(sample: Array, width: float, narrow: int) -> Piecewise:
    """The law of values that are each spread by a width to both sides, the first `narrow` ones no further than to 0."""
    near, far = sample[:narrow], sample[narrow:]
    knots = np.unique(np.concatenate([np.zeros(min(narrow, 1)), 2 * near, far - width, far + width]))
    below, reached = np.searchsorted(far, knots - width, side="right"), np.searchsorted(far, knots + width)
    sums = np.concatenate([[0.0], np.cumsum(far)])
    count = below + ((reached - below) * (knots + width) - (sums[reached] - sums[below])) / (2 * width)
    if narrow:
        spread = near[near > 0.0]
        low = np.searchsorted(knots, 2 * near[-1], side="right")
        count[:low] += (np.minimum(knots[:low, None], 2 * spread) / (2 * spread)).sum(axis=1) + (narrow - len(spread))
        count[low:] += narrow
    probabilities = np.clip(np.maximum.accumulate(count / len(sample)), 0.0, 1.0)
    probabilities[-1] = 1.0
    if not narrow or near[0] > 0.0:
        probabilities[0] = 0.0
        return Piecewise(probabilities, knots)
    return Piecewise(np.concatenate([[0.0], probabilities]), np.concatenate([[0.0], knots]))  # zeros stay zeros


class EmpiricalSpec(DistributionSpec):
    """`{file, column, unit, draws}`: a CSV file with a header row; commas or semicolons between the cells.

    Numbers have decimal points, or decimal commas where these separate no cells. Worst cases: the 0.135 and 99.865 %
    percentiles.
    """

    kind: Literal["empirical"]
    file: str = Field(description="CSV file with a header row, from the folder of the scene")
    column: str = Field(description="its column of measured deviations")
    unit: str = Field(description="of the numbers in that column, such as um")
    draws: Draws = Field(
        default="smoothed",
        description="smoothed: with the sample's variance s² (n − 1) and tails beyond; as_measured: values as they are",
    )

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
            words = f"expected at least two values in column {self.column!r}, got {len(column.cells)}"
            raise SceneError(Problem.at(file.path, words))
        sample = np.array(column.numbers()) * self.quantities()["unit"].internal
        if not np.all(np.abs(sample) <= LARGEST_DEVIATION):
            raise SceneError(Problem.at(file.path, "expected deviations of less than 1e9 mm, rad or K"))
        if self.quantities()["unit"].dimension == "temperature" and sample.min() < ABSOLUTE_ZERO:
            words = f"expected at least {ABSOLUTE_ZERO} K, which is absolute zero, in column {self.column!r}"
            raise SceneError(Problem.at(file.path, f"{words}, got {sample.min():.6g} K"))
        sample = np.sort(sample)
        sample.flags.writeable = False
        return Empirical(sample, self.draws)
