"""What a first-order stack-up leaves out of the first order, with its size: it can be held to that."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.stack_up.term import Term

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Bound:
    """A bound: `factor` times the absolute value of what some terms add up to."""

    factor: float
    terms: tuple[Term, ...]


@dataclass(frozen=True)
class Neglect:
    """Something that a stack-up leaves out on purpose, and by how much at most that changes j_bn.

    Args:
        words: what is left out, for people.
        parts: bounds that add up [mm].
    """

    words: str
    parts: tuple[Bound, ...]

    def bound(self, slices: Mapping[str, slice], deviations: Array, angles: tuple[Array, Array]) -> Array:
        """Largest change of j_bn that is left out [mm], (rows,); 0 where no deviation of its terms acts.

        Args:
            slices: columns of each contributor in the deviations.
            deviations: (rows, components) [mm, rad, K].
            angles: turns of driver and driven gear [rad], each (rows,).
        """
        total = np.zeros(len(deviations))
        for part in self.parts:
            change = np.zeros(len(deviations))
            for term in part.terms:
                change = change + term.change(deviations[:, slices[term.contributor.name]], angles)
            total = total + part.factor * np.abs(change)
        return total
