"""Regressors of a measure on contributors, by which its variance is shared: a few rows for each contributor."""

from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.arrays import Array
from tol3d.study.system.contributor import Contributor
from tol3d.study.system.draw import component_sigmas

MOST_COMPONENTS: Final = 8
"""Most components of a contributor that have a row each; a larger group has two rows, its first-order term and the
square of it."""


def is_group(contributor: Contributor) -> bool:
    """True if a contributor has too many components for a row each."""
    return len(contributor.draw.components) > MOST_COMPONENTS


def has_square(contributor: Contributor) -> bool:
    """True for a single component and for a group: two rows, of which the second is the square of the first."""
    return not 1 < len(contributor.draw.components) <= MOST_COMPONENTS


def regressor_count(contributor: Contributor) -> int:
    """Number of a contributor's rows: one per component of several, else two; see `has_square`."""
    return 2 if has_square(contributor) else len(contributor.draw.components)


def regress_plainly(rows: Array, contributor: Contributor, values: Sequence[Array]) -> None:
    """Write rows of a deviation whose direction does not turn, over its sigma.

    A single component has its value less the mean, and the square of that; several have a row each, means included.

    Args:
        rows: of the contributor (regressors, trials), written.
        contributor: of up to MOST_COMPONENTS components.
        values: each component (trials,) [mm, rad, K].
    """
    law = contributor.distribution
    if len(values) == 1:
        regress_term(rows, values[0] - law.mean, law.sigma)
        return
    per_sigma = 1.0 / (law.sigma or 1.0)
    for row, component in zip(rows, values, strict=True):
        np.multiply(component, per_sigma, out=row)


def regress_term(rows: Array, term: Array, sigma: float) -> None:
    """Write a centred term (trials,) over its sigma, and the square of that: rows (2, trials)."""
    np.multiply(term, 1.0 / (sigma or 1.0), out=rows[0])
    np.square(rows[0], out=rows[1])


def regress_squares(rows: Array, contributor: Contributor, columns: Mapping[str, NDArray[Any]]) -> None:
    """Write rows (regressors, trials) of a contributor without a slope, which acts alike to both sides of its mean.

    Components are centred and divided by their sigmas. Of several, each row is the square of one; a single component
    has itself and its square, a group the sum of its components and the sum of their squares.

    Args:
        rows: of the contributor (regressors, trials), written.
        contributor: any.
        columns: of the block, by name, in the units of columns.
    """
    sigmas = component_sigmas(contributor.draw)
    means = contributor.draw.mean(turning=False)
    scaled = [
        (np.asarray(columns[name], dtype=np.float64) * contributor.per_unit - mean) / (sigma or 1.0)
        for name, mean, sigma in zip(contributor.columns, means, sigmas, strict=True)
    ]
    if has_square(contributor):
        rows[0], rows[1] = sum(scaled), sum(component * component for component in scaled)
    else:
        for row, component in zip(rows, scaled, strict=True):
            np.square(component, out=row)
