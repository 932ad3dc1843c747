"""Certificates of programmes over cones: by full duals, no other motion goes farther."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.arrays import Array

CONDITIONS: Final = ("primal", "dual", "balance", "complementarity")
"""Rows of a certificate."""


def certificate(
    h: Array, rows: Array, dims: NDArray[np.int64], lifted: NDArray[np.bool_], goal: Array, x: Array, slack: Array,
    duals: Array,
) -> Array:  # fmt: skip
    """Residuals of the conditions of Karush, Kuhn and Tucker, 0 at an optimum (4, n).

    A place is y = h + B x, its first component less the slack where the place is lifted. All places lie in their cones:
    the first of d components is as long as the others together, or longer. Of such x the programme asks for the largest
    goal · x at a stated slack, or, where the goal is 0, for the largest slack. Duals z lie in the same cones and
    balance: the sum of B' z is -goal, and where the goal is 0 the first components of lifted places sum to 1. The
    programme is convex: where y · z = 0 too, no other x is better. Nothing is asked of how x was found.

    Source: Boyd and Vandenberghe, Convex Optimization, 2004, 5.9.2.

    Args:
        h: places without a motion (places, 4, n) [mm]; what is beyond their components does not count.
        rows: B, their change by a motion (places, 4, unknowns, n), or (…, 1) where trials share it.
        dims: components of the places, 1 to 4 (places,).
        lifted: places that give way to the slack (places,).
        goal: (unknowns, n), or (unknowns, 1).
        x: motions found (unknowns, n) [mm].
        slack: found or stated (n,) [mm].
        duals: z (places, 4, n).

    Returns:
        Primal: the farthest that a place lies out of its cone [mm]; dual: the same of duals; balance: the largest
        component that is left over; complementarity: the largest |y · z| [mm].
    """
    counts = np.arange(4)[None, :, None] < dims[:, None, None]
    y, z = np.where(counts, h, 0.0), np.where(counts, duals, 0.0)
    left = np.array(np.broadcast_to(goal, x.shape))
    for k, count in enumerate(dims):
        for c in range(int(count)):
            for f, row in enumerate(rows[k, c]):
                y[k, c] += row * x[f]
                left[f] += row * z[k, c]
    y[lifted, 0] -= slack
    centres = ~np.any(np.broadcast_to(goal, x.shape) != 0.0, axis=0)
    lift = np.where(centres, np.abs(1.0 - z[lifted, 0].sum(axis=0)), 0.0)
    return np.array(
        [
            _outside(y).max(axis=0),
            _outside(z).max(axis=0),
            np.maximum(np.abs(left).max(axis=0, initial=0.0), lift),
            np.abs((y * z).sum(axis=1)).max(axis=0),
        ]
    )


def _outside(places: Array) -> Array:
    """Ways out of the cones (places, n) along their first component, 0 inside."""
    return np.asarray(np.maximum(np.sqrt((places[:, 1:] ** 2).sum(axis=1)) - places[:, 0], 0.0))
