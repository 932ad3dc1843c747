"""A measure that is a sum: its terms, which are kept and pooled beside it."""

from dataclasses import dataclass


@dataclass(frozen=True)
class SumTerm:
    """One term of a sum.

    Args:
        name: of the term, such as the link whose play it is.
        factor: of the term in the sum.
    """

    name: str
    factor: float


@dataclass(frozen=True)
class Breakdown:
    """The terms of a measure.

    Args:
        measure: its name.
        terms: in the order in which they are added up.
        unit: of their columns.
        per_internal: one mm or rad in that unit.
    """

    measure: str
    terms: tuple[SumTerm, ...]
    unit: str
    per_internal: float

    def column(self, method: str, term: str) -> str:
        """Name of the column with a method's values of a term."""
        return f"{method}:{self.measure}:{term} [{self.unit}]"
