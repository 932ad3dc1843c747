"""Minimum zone of points: the smallest distance of two parallel planes with all of them between."""

from collections.abc import Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.placing.poses import cross, dot

Array = NDArray[np.float64]


def widths(points: Sequence[Array]) -> Array:
    """Widths of points, each (3, n) or (3, 1), in their trials (n,) [mm].

    At the least width one plane touches three points, or each of them two: all such directions are tried.
    """
    least = np.full(1, np.inf)
    for normal in _normals(points):
        square = dot(normal, normal)
        some = square > 0
        heights = [dot(normal, point - points[0]) for point in points]
        spread = np.maximum.reduce(np.broadcast_arrays(*heights)) - np.minimum.reduce(np.broadcast_arrays(*heights))
        least = np.minimum(least, np.where(some, spread / np.sqrt(np.where(some, square, 1.0)), np.inf))
    return np.where(least == np.inf, 0.0, least)


def _normals(points: Sequence[Array]) -> list[Array]:
    faces = [cross(b - a, c - a) for a, b, c in combinations(points, 3)]
    for a, b, c, d in combinations(points, 4):
        faces += [cross(b - a, d - c), cross(c - a, d - b), cross(d - a, c - b)]
    return faces
