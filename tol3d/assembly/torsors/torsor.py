"""Torsors: small displacements of a rigid body, six numbers (shift at the origin of a frame [mm], turn [rad]).

A point p of the body is displaced by shift + turn x p. In this folder a torsor is a matrix (6, columns): linear in the
columns of a trial (see columns.py). Torsors in one frame add up.
"""

from collections.abc import Iterable
from functools import reduce
from operator import add

import numpy as np
import scipy.sparse

from tol3d.numerics.arrays import Array


def cross_matrix(vector: Array) -> Array:
    """(3, 3): applied to another vector, the cross product of this one with it."""
    x, y, z = vector
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def shift_at(point: Array) -> Array:
    """(3, 6): applied to a torsor, the displacement of a point [mm]."""
    return np.hstack([np.eye(3), -cross_matrix(point)])


def height_at(point: Array, normal: Array) -> Array:
    """(1, 6): applied to a torsor, the displacement of a point along a direction [mm]; (n, p x n)."""
    (x, y, z), (u, v, w) = point.tolist(), normal.tolist()
    return np.array([[u, v, w, y * w - z * v, z * u - x * w, x * v - y * u]])


def turn_about(directions: Array) -> Array:
    """(directions, 6): applied to a torsor, its turn about each of them (directions, 3) [rad]."""
    return np.hstack([np.zeros_like(directions), directions])


def seen_from(pose: Array) -> Array:
    """(6, 6): a torsor in a frame -> the same one in that in which the frame has this pose (4, 4)."""
    rotation = pose[:3, :3]
    change = np.zeros((6, 6))
    change[:3, :3] = change[3:, 3:] = rotation
    change[:3, 3:] = cross_matrix(pose[:3, 3]) @ rotation
    return change


def torsor_of(point: Array, shift: Array, turn: Array) -> Array:
    """The torsor (6, columns) by which a point is displaced by a shift (3, columns), with a turn (3, columns)."""
    return np.vstack([shift + cross_matrix(point) @ turn, turn])


def perpendicular(direction: Array) -> Array:
    """Two directions (2, 3) of unit length, perpendicular to one and to each other."""
    first = np.cross(direction, np.eye(3)[np.argmin(np.abs(direction))])
    first /= np.linalg.norm(first)
    return np.array([first, np.cross(direction, first)])


MANY = 64
"""Size of a nonzero matrix from which its sparse form, which adds in the same order, is quicker."""
UNDECIDED = 1e-13
"""Part of a pivot of positive definite equations that is left of it, below which it is rounding."""


def ordered_sum(addends: Iterable[Array]) -> Array:
    """Their sum, the first two first."""
    return reduce(add, addends)


def ordered_product(matrix: Array, columns: Array) -> Array:
    """(rows, trials) from a matrix (rows, columns) and columns (columns, trials); what is times 0 does not count.

    Each row's addends in the order of the columns.
    """
    if np.count_nonzero(matrix) > MANY:
        return np.asarray(scipy.sparse.csr_array(matrix) @ columns)
    product = np.zeros((len(matrix), columns.shape[1]))
    for row, weights in zip(product, matrix, strict=True):
        for k in np.flatnonzero(weights):
            row += weights[k] * columns[k]
    return product


def squared_lengths(vectors: Array) -> Array:
    """Squared lengths (vectors, trials) of (vectors, size, trials)."""
    return ordered_sum(vectors[:, k] ** 2 for k in range(vectors.shape[1]))


def ordered_solution(matrix: Array, right: Array) -> Array:
    """Solutions (unknowns, trials) of positive definite equations (unknowns, unknowns, trials), by L D L^T.

    What the equations do not decide beyond rounding stays 0.
    """
    count = len(right)
    matrix, solution = matrix.copy(), right.copy()
    pivots = np.empty(right.shape)
    sizes = [matrix[k, k].copy() for k in range(count)]
    for k in range(count):
        pivots[k] = np.where(matrix[k, k] > UNDECIDED * sizes[k], matrix[k, k], np.inf)
        column = matrix[:, k].copy()
        matrix[k + 1 :, k] /= pivots[k]
        for i in range(k + 1, count):
            for j in range(k + 1, i + 1):
                matrix[i, j] -= matrix[i, k] * column[j]
            solution[i] -= matrix[i, k] * solution[k]
    solution /= pivots
    for k in range(count - 1, -1, -1):
        for i in range(k + 1, count):
            solution[k] -= matrix[i, k] * solution[i]
    return solution
