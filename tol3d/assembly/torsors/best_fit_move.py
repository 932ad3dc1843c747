"""Best fit: the torsor of a part by least squares of residuals, or by the least largest one."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from tol3d.assembly.model import BestFit, Fit
from tol3d.assembly.torsors.freedoms import Freedoms
from tol3d.assembly.torsors.terms import Form
from tol3d.assembly.torsors.torsor import (
    ordered_product,
    ordered_solution,
    ordered_sum,
    shift_at,
    squared_lengths,
)
from tol3d.assembly.torsors.world import World
from tol3d.numerics.arrays import Array

GAP = 1e-11
"""Relative error of the square of the largest residual at the end."""
MOST_STEPS = 300
"""In practice 10 to 60."""


@dataclass(frozen=True, eq=False)
class Minimax:
    """The unknowns z that minimise the longest of the residuals B z - b.

    Minimise tau subject to |B_k z - b_k|^2 <= tau: primal-dual interior points, from least squares. If the longest
    residuals leave z open, it is the one that keeps the others far from them (the analytic centre).

    Args:
        forms: b, (residuals * 3, columns).
        matrix: B, (residuals, 3, unknowns), of full rank over all of them.
    """

    forms: Array
    matrix: Array
    form: Form = "least largest residual"

    @property
    def count(self) -> int:
        """Unknowns."""
        return int(self.matrix.shape[2])

    @cached_property
    def _squares(self) -> Array:
        return np.asarray(np.linalg.pinv(self.matrix.reshape(-1, self.count)), dtype=np.float64)

    def values(self, read: Array) -> Array:
        """z (unknowns, trials) from b (residuals * 3, trials)."""
        start = ordered_product(self._squares, read)
        left = ordered_product(self.matrix.reshape(-1, self.count), start) - read
        size = np.sqrt(squared_lengths(left.reshape(len(self.matrix), 3, -1)).max(axis=0))
        amount = ordered_sum(read**2) ** 0.5
        varies = size > 1e-12 * amount  # else all residuals are nil already
        found = start.copy()
        scaled = left[:, varies] / size[varies]
        found[:, varies] += size[varies] * self._centred(scaled.reshape(len(self.matrix), 3, -1))
        return found

    def _centred(self, left: Array) -> Array:
        """The change of z (unknowns, trials) from residuals (residuals, 3, trials), the longest of which is 1."""
        trials = left.shape[2]
        z = np.zeros((self.count, trials))
        bound = np.full(trials, 1.5)
        multipliers = np.full((len(left), trials), 1.0 / len(left))
        going = np.arange(trials)
        for _ in range(MOST_STEPS):
            if not len(going):
                break
            state = z[:, going], bound[going], multipliers[:, going]
            z[:, going], bound[going], multipliers[:, going], gap = self._step(left[:, :, going], *state)
            going = going[gap > GAP]
        return z

    def _step(self, left: Array, z: Array, bound: Array, multipliers: Array) -> tuple[Array, Array, Array, Array]:
        """One Newton step on the conditions of the optimum, a tenth of the gap left; and the gap after it."""
        count = len(left)
        residuals = left + self._moved(z)
        slack = bound - squared_lengths(residuals)
        target = 0.1 * ordered_sum(slack * multipliers) / count
        gradients = 2.0 * np.array(
            [[ordered_sum(self.matrix[k, :, i, None] * residuals[k]) for i in range(self.count)] for k in range(count)]
        )
        stiffness, pushes = multipliers / slack, target / slack
        total = ordered_sum(stiffness)
        mean = [ordered_sum(stiffness * gradients[:, i]) / total for i in range(self.count)]
        aside = gradients - np.array(mean)
        system = np.empty((self.count, *z.shape))
        for i in range(self.count):
            for j in range(i + 1):
                curved = ordered_sum(self._curvature[k, i, j] * multipliers[k] for k in range(count))
                system[i, j] = system[j, i] = curved + ordered_sum(stiffness * aside[:, i] * aside[:, j])
        # the bound is eliminated: its change follows the mean of the gradients, each with its stiffness
        surplus = ordered_sum(pushes) - 1.0
        right = [mean[i] * surplus - ordered_sum(pushes * gradients[:, i]) for i in range(self.count)]
        step = ordered_solution(system, np.array(right))
        rise = surplus / total + ordered_sum(mean[i] * step[i] for i in range(self.count))
        widening = rise - ordered_sum(gradients[:, i] * step[i] for i in range(self.count))
        change = pushes - multipliers - stiffness * widening
        share = 0.99 * np.minimum(
            _until_nil(multipliers, change, np.zeros(1)),
            _until_nil(slack, widening, squared_lengths(self._moved(step))),
        )
        share = np.minimum(1.0, share)
        z, bound, multipliers = z + share * step, bound + share * rise, multipliers + share * change
        slack = bound - squared_lengths(left + self._moved(z))
        return z, bound, multipliers, ordered_sum(slack * multipliers)

    @cached_property
    def _curvature(self) -> Array:
        """(residuals, unknowns, unknowns): second derivatives of the squared lengths."""
        return 2.0 * self.matrix.transpose(0, 2, 1) @ self.matrix

    def _moved(self, z: Array) -> Array:
        """B z (residuals, 3, trials)."""
        return ordered_product(self.matrix.reshape(-1, self.count), z).reshape(len(self.matrix), 3, -1)


def _until_nil(values: Array, slopes: Array, falls: Array) -> Array:
    """The least share s at which one of values + s slopes - s^2 falls is nil (trials,); values > 0, falls >= 0."""
    below = np.sqrt(slopes**2 + 4.0 * falls * values) - slopes
    return np.asarray((2.0 * values / np.maximum(below, 1e-300)).min(axis=0))


def fitted(move: BestFit, world: World) -> World:
    """The world with a part by best fit; unaffected by residuals, the middle of its points stays."""
    residuals = [_residual(fit, move, world) for fit in move.fits]
    points = [world.origin(fit.moving) for fit in move.fits]
    freedoms = Freedoms(world.assembly.part[move.part].pose[:3, 3], points, world.columns.count)
    if move.criterion == "squares":
        weights = [np.full(len(rows), fit.weight**0.5) for fit, (rows, _) in zip(move.fits, residuals, strict=True)]
        rows, values = (np.concatenate(each) for each in zip(*residuals, strict=True))
        weight = np.concatenate(weights)[:, None]
        freedoms.take(weight * rows, weight * values)
        freedoms.settle(np.mean(points, axis=0))
        return world.with_part_at(move.part, freedoms.rest())
    # equal numbers of entries; those without a direction are 0
    rows = np.array([np.pad(rows, ((0, 3 - len(rows)), (0, 0))) for rows, _ in residuals]) @ freedoms.scale
    values = np.array([np.pad(values, ((0, 3 - len(values)), (0, 0))) for _, values in residuals])
    _, strengths, right = np.linalg.svd(rows.reshape(-1, 6))
    seen = right[strengths > 1e-8 * strengths[0]]
    found = world.columns.made_by(Minimax(values.reshape(-1, world.columns.count), rows @ seen.T))
    freedoms.take(seen @ np.linalg.inv(freedoms.scale), found)
    freedoms.settle(np.mean(points, axis=0))
    return world.with_part_at(move.part, freedoms.rest())


def _residual(fit: Fit, move: BestFit, world: World) -> tuple[Array, Array]:
    """Rows (directions, 6) and values (directions, columns): their difference is the residual, moving less target."""
    moving, target = world.origin(fit.moving), world.origin(fit.target)
    part = world.part_of(fit.target)
    directions = world.turned(fit.directions, part)
    at_moving, at_target = directions @ shift_at(moving), directions @ shift_at(target)
    other = at_moving @ world.parts[part] + at_target @ world.on_part(fit.target)
    gap = world.columns.constants(directions @ (moving - target))
    return at_moving, other - at_moving @ world.on_body(fit.moving, move.part) - gap
