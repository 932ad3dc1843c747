"""The terms of a sum, pooled over trials: each one's moments, and their covariance."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.arrays import Array
from tol3d.statistics.estimates import Moments, RegressorSums
from tol3d.study.system.breakdown import Breakdown
from tol3d.study.system.outcome import Outcome

Columns = Mapping[str, NDArray[Any]]


@dataclass(frozen=True)
class PooledTerms:
    """One method's terms of a breakdown, in its order; trials that could not be assembled are left out.

    Args:
        moments: of each term, in the breakdown's unit.
        sums: their co-moments; the last term is the target.
    """

    moments: tuple[Moments, ...]
    sums: RegressorSums

    @classmethod
    def of(cls, breakdown: Breakdown, method: str, columns: Columns, whole: Outcome) -> "PooledTerms | None":
        """The terms of one block; None if that method was not used.

        Args:
            breakdown, method: whose terms.
            columns: of the block.
            whole: outcome of the sum.
        """
        names = [breakdown.column(method, term.name) for term in breakdown.terms]
        if names[0] not in columns:
            return None
        rows = np.stack([np.asarray(columns[name], dtype=np.float64) for name in names])
        rows = rows[:, ~np.isnan(rows.sum(axis=0) + np.asarray(whole.values, dtype=np.float64))]
        return cls(tuple(Moments.of(row) for row in rows), RegressorSums.of_each(rows[:-1], rows[-1:])[0])

    def merge(self, other: "PooledTerms") -> "PooledTerms":
        """Both blocks as one."""
        moments = zip(self.moments, other.moments, strict=True)
        return PooledTerms(tuple(mine.merge(its) for mine, its in moments), self.sums.merge(other.sums))

    def shares(self, factors: Array) -> Array:
        """Each term's part of the variance of the sum of factor times term, (terms,); nan if nothing varies."""
        with np.errstate(invalid="ignore"):
            parts = factors * (self.sums.comoments @ factors)
            return np.asarray(parts / parts.sum())
