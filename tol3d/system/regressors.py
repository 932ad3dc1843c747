"""Regressors of a measure's variance: a few rows for each contributor."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from tol3d.numerics.arrays import Array
from tol3d.system.contributor import Contributor

MOST_COMPONENTS: Final = 8
"""Components of a contributor that each have a row; a larger group has one of its own first-order term, and its
square."""


def is_group(contributor: Contributor) -> bool:
    """True if it has more components than have a row each."""
    return len(contributor.draw.components) > MOST_COMPONENTS


def has_square(contributor: Contributor) -> bool:
    """True if the second of its two rows is the square of the first: of one component, and of a group."""
    return not 1 < len(contributor.draw.components) <= MOST_COMPONENTS


def regressor_count(contributor: Contributor) -> int:
    """Rows of a contributor: value and square; each component of several; first-order term and square of a group."""
    return 2 if has_square(contributor) else len(contributor.draw.components)


def regress_plainly(rows: Array, contributor: Contributor, values: Sequence[Array]) -> None:
    """Write rows (regressors, trials) of a deviation whose direction does not turn, over its sigma.

    Args:
        rows: of the contributor.
        contributor: of up to MOST_COMPONENTS components.
        values: each component (trials,) [mm, rad, K].
    """
    law = contributor.distribution
    per_spread = 1.0 / (law.sigma or 1.0)
    if len(values) == 1:
        regress_term(rows, values[0] - law.mean, law.sigma)
        return
    for row, component in zip(rows, values, strict=True):
        np.multiply(component, per_spread, out=row)


def regress_term(rows: Array, term: Array, sigma: float) -> None:
    """Write one value (trials,) less its mean, and its square, over its sigma: rows (2, trials)."""
    np.multiply(term, 1.0 / (sigma or 1.0), out=rows[0])
    np.square(rows[0], out=rows[1])
