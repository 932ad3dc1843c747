"""How far the geometric road lies from the analytic one, block by block: by which contributors, and where most."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tol3d.study.regression import Sums, merged

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Disagreement:
    """Differences (geometric - analytic) of the trials in which a scalar measure has both, in its unit.

    Args:
        sums: what they have in common with the measure's features.
        largest: the largest |difference|, 0 without trials.
        trial: the first trial that has it; -1 without trials.
    """

    sums: Sums
    largest: float
    trial: int

    @classmethod
    def of(cls, first: int, difference: Array, sums: Sums) -> "Disagreement":
        """Of a block that begins at trial `first`; difference (trials,), nan where a road has no value."""
        size = np.where(np.isnan(difference), -1.0, np.abs(difference))
        at = int(np.argmax(size))
        return cls(sums, float(size[at]), first + at) if size[at] >= 0.0 else cls(sums, 0.0, -1)

    def merge(self, other: "Disagreement") -> "Disagreement":
        """Both blocks as one."""
        further = other if other.trial >= 0 and (self.trial < 0 or other.largest > self.largest) else self
        return Disagreement(merged(self.sums, other.sums), further.largest, further.trial)
