"""Regressors of a measure's variance: a few rows for each contributor."""

from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.arrays import Array
from tol3d.study.system.contributor import Contributor
from tol3d.study.system.draw import component_sigmas

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


def regress_squares(rows: Array, contributor: Contributor, columns: Mapping[str, NDArray[Any]]) -> None:
    """Write rows (regressors, trials) of a contributor without a slope, which acts alike to both sides of its mean.

    Each component less its mean over its sigma, squared; of a large group their sum, and before it that of the
    components themselves. A single component has a row of its own before its square.
    """
    sigmas = component_sigmas(contributor.draw)
    means = contributor.draw.mean(turning=False)
    own = [
        (np.asarray(columns[name], dtype=np.float64) * contributor.per_unit - mean) / (sigma or 1.0)
        for name, mean, sigma in zip(contributor.columns, means, sigmas, strict=True)
    ]
    if has_square(contributor):
        rows[0], rows[1] = sum(own), sum(each * each for each in own)
    else:
        for row, each in zip(rows, own, strict=True):
            np.square(each, out=row)
