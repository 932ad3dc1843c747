"""How far two roads to the same number differ, trial by trial."""

import math
from dataclasses import dataclass
from typing import Self

import numpy as np

from tol3d.numerics.arrays import Array


@dataclass(frozen=True)
class Agreement:
    """Differences of two columns over the same trials, in their unit.

    Args:
        count: trials in which both roads gave a number.
        skipped: trials in which one or both gave NaN.
        max_abs: largest |difference|, 0 when there are none.
        total, total_squares: sums of the differences and of their squares.
    """

    count: int = 0
    skipped: int = 0
    max_abs: float = 0.0
    total: float = 0.0
    total_squares: float = 0.0

    @classmethod
    def of(cls, values: Array, reference: Array) -> Self:
        """The differences values - reference of one block, both (trials,)."""
        difference = values - reference
        known = difference[~np.isnan(difference)]
        return cls(
            count=len(known),
            skipped=len(difference) - len(known),
            max_abs=float(np.max(np.abs(known), initial=0.0)),
            total=float(np.sum(known)),
            total_squares=float(np.sum(known * known)),
        )

    def merge(self, other: Self) -> Self:
        """The differences of both blocks together."""
        return type(self)(
            self.count + other.count,
            self.skipped + other.skipped,
            max(self.max_abs, other.max_abs),
            self.total + other.total,
            self.total_squares + other.total_squares,
        )

    @property
    def mean(self) -> float:
        """Mean difference (values - reference); NaN without trials."""
        return self.total / self.count if self.count else math.nan

    @property
    def rms(self) -> float:
        """Root of the mean square difference; NaN without trials."""
        return math.sqrt(self.total_squares / self.count) if self.count else math.nan
