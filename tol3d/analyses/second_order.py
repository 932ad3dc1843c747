"""Probabilities by second order (SORM): the curvatures of the limit at its design point correct the first order.

Sources: Breitung 1984; Hohenbichler and Rackwitz 1988.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from tol3d.analyses.design_points import DesignPoint
from tol3d.analyses.limit_state import LimitState, repeated
from tol3d.numerics.arrays import Array

WIDTH: Final = 0.05
"""Central differences of second order, in standard normals."""


@dataclass(frozen=True)
class SecondOrder:
    """A probability by second order, the mean over positions.

    Args:
        breitung: asymptotic: Φ(-β) Π (1 + β κ)^(-1/2).
        hohenbichler: with φ(β)/Φ(-β) in place of β, nearer for small β.
    """

    breitung: float
    hohenbichler: float


def second_order(
    state: LimitState, points: Sequence[Sequence[DesignPoint]], weights: Array, out: NDArray[np.bool_]
) -> tuple[SecondOrder | None, str]:
    """By the nearest design point of each position; None where one has no curvatures, and why.

    Args:
        state: the limit state.
        points: of each position; where there are none all builds do as the one at the origin.
        weights: how much each position stands for.
        out: where the build at the origin fails.
    """
    sums, count = np.zeros(2), len(points)
    for own, weight, fails in zip(points, weights, out, strict=True):
        if not own:
            sums += weight * float(fails)
            continue
        nearest = own[0]
        if not nearest.smooth or not nearest.gradient.any():
            return None, "second order: the design point lies at an edge, where there are no curvatures"
        curved, _ = curvatures(state, nearest)
        found = corrected(nearest.distance, -curved if nearest.beyond else curved)
        if found is None:
            return None, "second order: the limit curves round the origin as much as its distance; not known"
        sums += weight * (1.0 - np.array(found) if nearest.beyond else np.array(found))
    return (SecondOrder(*(sums / count).tolist()), "") if any(points) else (None, "")


def corrected(beta: float, curved: Array) -> tuple[float, float] | None:
    """Probabilities of a distance and of curvatures, positive where the limit bends away from the origin's side.

    >>> corrected(3.0, np.zeros(2)) == (float(ndtr(-3.0)),) * 2
    True
    """
    first = float(ndtr(-beta))
    mills = math.exp(-(beta**2) / 2) / math.sqrt(2 * math.pi) / first
    found = []
    for factor in (beta, mills):
        terms = 1.0 + factor * curved
        if (terms <= 0.0).any():
            return None
        found.append(min(1.0, first / math.sqrt(float(np.prod(terms)))))
    return found[0], found[1]


def curvatures(state: LimitState, point: DesignPoint) -> tuple[Array, Array]:
    """Main curvatures of the limit at a design point (n - 1,) and their directions (n - 1, dimension).

    They are above 0 where the limit bends away from the origin; n normals act. By the Hessian in a frame whose last
    axis is the design point's, without that axis, by the slope there.
    """
    acting, size = state.acting, float(np.linalg.norm(point.gradient))
    count = len(acting)
    if count < 2:
        return np.zeros(0), np.zeros((0, state.dimension))
    axes = np.zeros((count - 1, state.dimension))
    axes[:, acting] = _tangents(point.gradient[acting] / size)
    first, other = np.triu_indices(count - 1, 1)
    shifts = WIDTH * np.concatenate([np.zeros((1, state.dimension)), axes, -axes, axes[first] + axes[other]])
    shifts = np.concatenate([shifts, -WIDTH * (axes[first] + axes[other])])
    found = state.at(point.normals + shifts, repeated(point.positions, len(shifts)))[0]
    centre, plus, minus = found[0], found[1:count], found[count : 2 * count - 1]
    both, neither = np.split(found[2 * count - 1 :], 2)
    hessian = np.diag((plus - 2 * centre + minus) / WIDTH**2)
    mixed = both + neither - plus[first] - minus[first] - plus[other] - minus[other] + 2 * centre
    hessian[first, other] = hessian[other, first] = mixed / (2 * WIDTH**2)
    values, turned = np.linalg.eigh(np.nan_to_num(hessian))
    return np.asarray(values / size), np.asarray(turned.T @ axes)


def _tangents(direction: Array) -> Array:
    """Orthonormal rows across a unit direction (n,): (n - 1, n)."""
    count = len(direction)
    turned, _ = np.linalg.qr(np.column_stack([direction, np.eye(count)]))
    return np.asarray(turned.T[1:count])
