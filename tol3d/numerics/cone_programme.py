"""Range of one coordinate between straight and round gaps: a second-order cone programme per trial, batched.

The first unknown of y is the coordinate, the last a widening of all gaps, at a price. Newton's method on logarithms
of the remaining gaps finds the balance of weight / gap; the weight then shrinks. Source: S. Boyd, L.
Vandenberghe, Convex Optimization, Cambridge 2004, chapter 11. A trial's result does not depend on the others.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

PRICE: Final = 1000.0  # of widening all gaps, per length of the coordinate; forces should add up to far less
SHARE: Final = 1e-8  # mm; weight of each logarithm in the end
SHRINKS: Final = 0.1  # the weight, once Newton's method is near
CLOSE: Final = 1.0  # decrement at which it is
THERE: Final = 1e-4  # decrement at which forces are those of the last weight
INSIDE: Final = 0.95  # of the way to where the first gap closes
WIDER: Final = 0.01  # mm, to begin with, than the deepest overlap
MOST_STEPS: Final = 150


@dataclass(frozen=True)
class ConeProgramme:
    """Gaps of trials (trials, ...) by unknowns; lengths in mm.

    Args:
        rows: slopes of straight gaps (trials, rows, unknowns).
        gaps: their sizes where y = 0 (trials, rows).
        planes: slopes of displacements in round gaps (trials, cones, 2, unknowns).
        off: displacements where y = 0 (trials, cones, 2).
        radii: (trials, cones), above 0.
    """

    rows: Array
    gaps: Array
    planes: Array
    off: Array
    radii: Array

    def part(self, own: NDArray[np.int64]) -> "ConeProgramme":
        """Some of the trials."""
        return ConeProgramme(self.rows[own], self.gaps[own], self.planes[own], self.off[own], self.radii[own])

    def left(self, y: Array) -> tuple[Array, Array, Array]:
        """Straight gaps at y (trials, unknowns), displacements in round ones, and radius^2 - displacement^2."""
        straight = self.gaps + (self.rows @ y[:, :, None])[..., 0] + y[:, -1:]
        moved = self.off + (self.planes @ y[:, None, :, None])[..., 0]
        return straight, moved, (self.radii + y[:, -1:]) ** 2 - (moved * moved).sum(axis=-1)


@dataclass(frozen=True)
class Solved:
    """The farthest points, and forces per unit of the coordinate.

    Attributes:
        y: unknowns (trials, unknowns).
        gaps: straight ones there (trials, rows).
        straight: forces of straight gaps (trials, rows).
        round: forces of round gaps, along their displacements (trials, cones, 2).
    """

    y: Array
    gaps: Array
    straight: Array
    round: Array


def solve_cone_programme(given: ConeProgramme, sense: float) -> Solved:
    """Make the first coordinate as large as gaps let it (1), or as small (-1)."""
    trials, unknowns = len(given.gaps), given.rows.shape[2]
    y, weight = np.zeros((trials, unknowns)), np.empty(trials)
    deepest = (np.hypot(given.off[..., 0], given.off[..., 1]) - given.radii).max(axis=1)
    y[:, -1] = 2 * np.maximum(np.maximum(deepest, -given.gaps.min(axis=1)), 0.0) + WIDER
    weight[...] = PRICE * y[:, -1] / 10
    wanted = np.zeros(unknowns)
    wanted[0], wanted[-1] = -sense, PRICE
    going, own = np.arange(trials), given
    for _ in range(MOST_STEPS):
        at, w = y[going], weight[going]
        step, decrement = _newton(own, at, wanted / w[:, None])
        at = at + _length(own, at, step)[:, None] * step
        near = decrement < CLOSE
        done = (decrement < THERE) & (w <= SHARE)
        y[going], weight[going] = at, np.where(near, np.maximum(SHRINKS * w, SHARE), w)
        if done.any():
            going = going[~done]
            own = own.part(np.flatnonzero(~done))
        if not going.size:
            break
    straight, moved, left = given.left(y)
    return Solved(y, straight, weight[:, None] / straight, (2 * weight[:, None] / left)[..., None] * moved)


def _newton(given: ConeProgramme, y: Array, wanted: Array) -> tuple[Array, Array]:
    """Step (trials, unknowns) and decrement (trials,) of the objective over the weight, less all logarithms."""
    straight, moved, left = given.left(y)
    reach = given.radii + y[:, -1:]
    along = -2 * (moved[:, :, None] @ given.planes)[:, :, 0]
    along[..., -1] += 2 * reach
    sloped = given.rows / straight[..., None]
    sloped[..., -1] += 1 / straight
    bowed = along / left[..., None]
    gradient = wanted - sloped.sum(axis=1) - bowed.sum(axis=1)
    gradient[:, -1] -= 1 / y[:, -1]
    round_ = given.planes * np.sqrt(2 / left)[..., None, None]
    stacked = np.concatenate([sloped, bowed, round_.reshape(len(y), -1, y.shape[1])], axis=1)
    bent = np.swapaxes(stacked, 1, 2) @ stacked
    bent[:, -1, -1] += 1 / y[:, -1] ** 2 - (2 / left).sum(axis=1)
    step = -np.linalg.solve(bent, gradient[..., None])[..., 0]
    return step, np.sqrt(np.maximum(-(gradient * step).sum(axis=1), 0.0))


def _length(given: ConeProgramme, y: Array, step: Array) -> Array:
    """Largest fraction of a step (trials,) that leaves every gap open."""
    straight, moved, left = given.left(y)
    by = (given.rows @ step[:, :, None])[..., 0] + step[:, -1:]
    turned = (given.planes @ step[:, None, :, None])[..., 0]
    wider, reach = step[:, -1:], given.radii + y[:, -1:]
    square = wider**2 - (turned * turned).sum(axis=-1)
    half = reach * wider - (moved * turned).sum(axis=-1)
    root = np.sqrt(np.maximum(half * half - square * left, 0.0))
    with np.errstate(divide="ignore", invalid="ignore"):
        closes = np.where(by < 0.0, -straight / by, np.inf).min(axis=1)
        closes = np.minimum(closes, np.where(step[:, -1] < 0.0, -y[:, -1] / step[:, -1], np.inf))
        shut = np.where((half + root <= 0.0) | (square < 0.0), left / (root - half), np.inf)
        shut = np.where(shut > 0.0, shut, np.inf).min(axis=1)
    return np.asarray(np.minimum(1.0, INSIDE * np.minimum(closes, shut)))
