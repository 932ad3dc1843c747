"""How a measure changes with each deviation, and where that is no single slope."""

from dataclasses import dataclass
from typing import Final

from tol3d.assembly.torsors.terms import Form
from tol3d.numerics.arrays import Array

STEP: Final = 1e-6
"""Step [mm] for slopes of what does not vary."""


@dataclass(frozen=True, eq=False)
class Bend:
    """A term of a measure that is not linear in the deviations.

    Args:
        form: how it depends on what it reads.
        columns: of the deviations that act through it, in order.
        weights: (numbers of the term,), with which it is added to the measure; all 0 where another one reads it.
        vectors: (vectors, size, columns of the deviations + 1), of a largest length that reads deviations alone: it is
            the largest of |vectors[..., :-1] @ deviations + vectors[..., -1]|; else None.
    """

    form: Form
    columns: tuple[int, ...]
    weights: Array
    vectors: Array | None = None


@dataclass(frozen=True, eq=False)
class Slopes:
    """A measure to first order at the means of the deviations.

    What it leaves out: of the columns in `bends` all but the mean slope from one sigma below to one above the mean, the
    others at their means. So of a largest amount that is 0 at the means nothing is left.

    Args:
        nominal, at_means: of the measure, without deviations and with all at their means [mm or rad].
        coefficients: change of the measure per deviation (columns,).
        bends: the terms that are not linear; none where the measure is smooth.
    """

    nominal: float
    at_means: float
    coefficients: Array
    bends: tuple[Bend, ...] = ()

    @property
    def bent(self) -> tuple[int, ...]:
        """Columns whose coefficients are mean slopes, in order."""
        return tuple(sorted({column for bend in self.bends for column in bend.columns}))
