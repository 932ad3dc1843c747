"""Parts that are fitted to points: what their residuals ask, trial by trial."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.model import BestFit
from tol3d.assembly.model.statuses import OK, SINGULAR
from tol3d.assembly.placing.fits import least_largest, least_squares
from tol3d.assembly.placing.free_motion import free_motions, seen_steps
from tol3d.assembly.placing.poses import Codes, Pose, column, rotated
from tol3d.assembly.placing.world import World
from tol3d.errors import InputError

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class BestFitting:
    """A best fit, as its points are nominally; solved in the world, with the middle of the part's points at 0.

    Args:
        move: which.
        weights: of the squares (fits,).
        reach: of the points about their middle [mm].
        basis: steps that residuals see, turn times reach and shift (6, steps).
        start: the nominal pose there (3, 4).
        middle: of the points, in the part's frame (3, 1) [mm].
        origin: where that lies nominally in the world (3, 1) [mm].
    """

    move: BestFit
    weights: Array
    reach: float
    basis: Array
    start: Array
    middle: Array
    origin: Array

    def placed(self, world: World) -> tuple[World, Codes]:
        """The world after the move, and what became of it (n,)."""
        points, targets, directions = _asked(self.move, world)
        turn, shift = np.empty((3, 3, world.trials)), np.empty((3, world.trials))
        met = np.empty(world.trials, dtype=bool)
        fitted = least_squares if self.move.criterion == "squares" else least_largest
        points, targets = np.ascontiguousarray(points - self.middle), np.ascontiguousarray(targets - self.origin)
        fitted(points, targets, directions, self.weights, self.basis, self.start, self.reach, turn, shift, met)
        pose = Pose(turn, shift + self.origin - rotated(turn, self.middle))
        return world.with_part_at(self.move.part, pose), np.where(met, OK, SINGULAR).astype(np.int8)


def best_fitting(move: BestFit, nominal: World) -> BestFitting:
    """A best fit.

    Args:
        move: which.
        nominal: the world before it without deviations, the part at its nominal pose.

    Raises:
        InputError: a weight is not positive; nothing is seen of the part.
    """
    pose = nominal.poses[move.part]
    points, _, directions = _asked(move, nominal)
    turn, middle = pose.turn[:, :, 0], points[:, :, 0].mean(axis=0)
    arms = (points[:, :, 0] - middle) @ turn.T
    reach = max(float(np.linalg.norm(arms, axis=1).max()), 1.0)
    for fit in move.fits:
        if not fit.weight > 0:
            raise InputError(f"moves.{move.name}: expected a positive weight of {fit.moving}, got {fit.weight}")
    # of a residual by shift of the middle and turn: D v + D (w x arm)
    rows = np.concatenate(
        [np.hstack([own, np.cross(arm, own)]) for own, arm in zip(directions[:, :, :, 0], arms, strict=True)]
    )
    basis = seen_steps(free_motions(rows, np.zeros(3), reach), reach)
    if not basis.shape[1]:
        raise InputError(f"moves.{move.name}: no residual sees {move.part}: expected directions in which they count")
    weights = np.array([fit.weight for fit in move.fits])
    return BestFitting(
        move,
        weights / weights.max(),
        reach,
        basis,
        np.ascontiguousarray(np.column_stack([turn, np.zeros(3)])),
        column(middle),
        pose.point(column(middle)),
    )


def _asked(move: BestFit, world: World) -> tuple[Array, Array, Array]:
    """Points of the part in its frame, their targets (fits, 3, n), and directions (fits, 3, 3, n) in the world."""
    points = [world.on_body(fit.moving, move.part).origin for fit in move.fits]
    targets = [world.placed(fit.target).origin for fit in move.fits]
    directions = []
    for fit in move.fits:
        turn = world.poses[world.part_of(fit.target)].turn
        own = [rotated(turn, column(direction)) for direction in fit.directions]
        own += [column(np.zeros(3))] * (3 - len(own))
        directions.append(np.stack(np.broadcast_arrays(*own)))
    return _stacked(points), _stacked(targets), _stacked(directions)


def _stacked(arrays: Sequence[Array]) -> Array:
    """Of all fits, (fits, ..., n) or (fits, ..., 1)."""
    return np.stack(np.broadcast_arrays(*arrays))
