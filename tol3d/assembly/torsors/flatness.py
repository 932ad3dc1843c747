"""The smallest distance of two parallel planes with points between them, as a largest amount."""

from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from tol3d.errors import InputError

Array = NDArray[np.float64]

MOST_POINTS = 20
"""4845 sets of four."""
IN_LINE = 1e-6
"""Points that are so near to a line, over their extent, are in line."""
IDLE = 1e-8
"""Points with less weight are none of the set; less than of a fourth point beside three that are not in line."""


def balances(points: Array) -> Array:
    """Weights (sets, points) whose products with the heights of points have the flatness as their largest amount.

    By duality it is the largest of sum(w h) over weights with sum(w) = 0, sum(w p) = 0 and sum |w| = 2; the largest is
    at one of the weights that are not nil at as few points as can be: four, three in a line, or two at one place.

    Args:
        points: in the nominal plane (points, 2) [mm].

    Raises:
        InputError: more than 20 points.
    """
    if len(points) > MOST_POINTS:
        raise InputError(f"flatness of {len(points)} points; expected {MOST_POINTS} at most on the analytic road")
    size = max(float(np.ptp(points, axis=0).max()), 1e-300)
    sums = np.vstack([np.ones(len(points)), ((points - points.mean(axis=0)) / size).T])
    found = []
    for count in (2, 3, 4):
        for chosen in combinations(range(len(points)), count):
            _, strengths, right = np.linalg.svd(sums[:, chosen])
            weights = right[-1]
            if np.sum(strengths > IN_LINE) == count - 1 and np.abs(weights).min() > IDLE:
                row = np.zeros(len(points))
                row[list(chosen)] = 2.0 * weights / np.abs(weights).sum()
                found.append(row)
    return np.array(found).reshape(-1, len(points))
