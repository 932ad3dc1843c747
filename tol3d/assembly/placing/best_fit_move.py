"""Parts that are fitted to points, by their residuals, trial by trial.

The least largest residual is not left to the programme of contact/: with cones of four components its kernel would take
three times as long to compile as this one, and where two residuals alone decide, what they leave open would end
elsewhere than in the middle of the others' room.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from tol3d.assembly.model import Assembly, BestFit
from tol3d.assembly.model.statuses import OK, SINGULAR
from tol3d.assembly.placing.freedoms import free_motions, seen_steps
from tol3d.assembly.placing.one_sided_gaps import stepped
from tol3d.assembly.placing.placer import Asked, Placer, frame_in_world, listed, point_rows
from tol3d.assembly.placing.poses import Codes, Pose, column, rotated
from tol3d.assembly.placing.world import World
from tol3d.errors import InputError
from tol3d.numerics.arrays import Array
from tol3d.numerics.compiled import kernel, nested
from tol3d.numerics.loops import copy_matrix, eliminated, fill, fill_matrix

STEPS: Final = 80
MET: Final = 1e-13
"""Step [rad, and mm per mm of reach] at which a trial is done."""
LEAST_SHARE: Final = 1e-11
"""mm; excess of the largest residual over its minimum, divided by twice the number of residuals."""
FALL: Final = 0.2
"""Factor of the share from one barrier to the next."""
CENTRED: Final = 1e-3
"""Newton's decrement, squared, at which a barrier's centre is found."""


@nested
def residual_of(pose: Any, fits: Any, f: int, i: int, arm: Any, residual: Any) -> Any:
    """A residual (3,), the arm R p of its point, and its length squared."""
    points, targets, directions, _ = fits
    p, q, d = min(i, points.shape[2] - 1), min(i, targets.shape[2] - 1), min(i, directions.shape[3] - 1)
    x, y, z = points[f, 0, p], points[f, 1, p], points[f, 2, p]
    for r in range(3):
        arm[r] = pose[r, 0] * x + pose[r, 1] * y + pose[r, 2] * z
    a = arm[0] + pose[0, 3] - targets[f, 0, q]
    b = arm[1] + pose[1, 3] - targets[f, 1, q]
    c = arm[2] + pose[2, 3] - targets[f, 2, q]
    square = 0.0
    for k in range(3):
        residual[k] = directions[f, k, 0, d] * a + directions[f, k, 1, d] * b + directions[f, k, 2, d] * c
        square += residual[k] * residual[k]
    return square


@nested
def rows_of(fits: Any, f: int, i: int, arm: Any, basis: Any, reach: float, rows: Any) -> None:
    """Change of a residual per step of the basis (3, steps)."""
    directions = fits[2]
    d = min(i, directions.shape[3] - 1)
    for s in range(basis.shape[1]):
        a, b, c = basis[0, s] / reach, basis[1, s] / reach, basis[2, s] / reach
        u = basis[3, s] + b * arm[2] - c * arm[1]
        v = basis[4, s] + c * arm[0] - a * arm[2]
        w = basis[5, s] + a * arm[1] - b * arm[0]
        for k in range(3):
            rows[k, s] = directions[f, k, 0, d] * u + directions[f, k, 1, d] * v + directions[f, k, 2, d] * w


@nested
def moved(pose: Any, basis: Any, direction: Any, share: float, reach: float, step: Any) -> Any:
    """Move a pose by a share of a search direction, which is given in the basis; the step's length."""
    for r in range(6):
        step[r] = 0.0
        for s in range(basis.shape[1]):
            step[r] += share * basis[r, s] * direction[s]
    return stepped(pose, step, reach)


@nested
def by_squares(pose: Any, fits: Any, i: int, basis: Any, reach: float, rooms: Any) -> bool:
    """Find the least-squares pose; True if found."""
    matrix, right, arm, residual, rows, step, _ = rooms
    weights, count = fits[3], basis.shape[1]
    for _ in range(STEPS):
        fill_matrix(matrix, 0.0)
        fill(right, 0.0)
        for f in range(weights.shape[0]):
            residual_of(pose, fits, f, i, arm, residual)
            rows_of(fits, f, i, arm, basis, reach, rows)
            for k in range(3):
                for s in range(count):
                    right[s] -= weights[f] * rows[k, s] * residual[k]
                    for t in range(count):
                        matrix[s, t] += weights[f] * rows[k, s] * rows[k, t]
        if eliminated(matrix, right, count)[0] == 0.0:
            return False
        if moved(pose, basis, right, 1.0, reach, step) <= MET:
            return True
    return False


@nested
def largest(pose: Any, fits: Any, i: int, arm: Any, residual: Any) -> Any:
    """The largest residual, squared."""
    square = 0.0
    for f in range(fits[3].shape[0]):
        square = max(square, residual_of(pose, fits, f, i, arm, residual))
    return square


@nested
def barrier_step(pose: Any, top: float, share: float, fits: Any, i: int, basis: Any, reach: float, rooms: Any) -> Any:
    """Newton's step to a barrier's centre, that of T last; its decrement squared, negative where there is none."""
    matrix, right, arm, residual, rows, _, pull = rooms
    count = basis.shape[1]
    fill_matrix(matrix, 0.0)
    fill(right, 0.0)
    right[count] = -1.0 / share
    for f in range(fits[3].shape[0]):
        room = top * top - residual_of(pose, fits, f, i, arm, residual)
        rows_of(fits, f, i, arm, basis, reach, rows)
        for s in range(count):
            pull[s] = 2.0 * (rows[0, s] * residual[0] + rows[1, s] * residual[1] + rows[2, s] * residual[2]) / room
        pull[count] = -2.0 * top / room
        for s in range(count + 1):
            right[s] -= pull[s]
            for t in range(count + 1):
                matrix[s, t] += pull[s] * pull[t]
        for s in range(count):
            for t in range(count):
                for k in range(3):
                    matrix[s, t] += 2.0 * rows[k, s] * rows[k, t] / room
        matrix[count, count] -= 2.0 / room
    for s in range(count + 1):
        pull[s] = right[s]
    if eliminated(matrix, right, count + 1)[0] == 0.0:
        return -1.0
    decrement = 0.0
    for s in range(count + 1):
        decrement += pull[s] * right[s]
    return decrement


@nested
def by_barriers(pose: Any, fits: Any, i: int, basis: Any, reach: float, rooms: Any) -> bool:
    """Find the pose with the smallest maximum residual, from the least-squares pose; True if found."""
    _, right, arm, residual, _, step, _ = rooms
    count = basis.shape[1]
    trial, top = pose.copy(), np.sqrt(largest(pose, fits, i, arm, residual))
    share = max(top, 10 * LEAST_SHARE)
    top = top + share
    while share > LEAST_SHARE:
        share = max(FALL * share, LEAST_SHARE)
        for _ in range(STEPS):
            decrement = barrier_step(pose, top, share, fits, i, basis, reach, rooms)
            if not decrement >= 0.0:
                return False
            length = 1.0 / (1.0 + np.sqrt(decrement))
            for _ in range(STEPS):  # inside: the barrier holds for finite turns
                copy_matrix(trial, pose)
                moved(trial, basis, right, length, reach, step)
                its_top = top + length * right[count]
                if its_top > 0.0 and its_top * its_top > largest(trial, fits, i, arm, residual):
                    break
                length = length / 2
            copy_matrix(pose, trial)
            top = its_top
            if decrement < CENTRED:
                break
    return bool(np.isfinite(top))


@nested
def kept(pose: Any, found: bool, i: int, turns: Any, shifts: Any, met: Any) -> None:
    """Keep a trial's pose, NaN where none is found."""
    met[i] = found
    for r in range(3):
        for c in range(3):
            turns[r, c, i] = pose[r, c] if found else np.nan
        shifts[r, i] = pose[r, 3] if found else np.nan


@nested
def new_rooms(count: int) -> Any:
    """Work arrays for the steps."""
    size = count + 1
    return (
        np.empty((size, size)),
        np.empty(size),
        np.empty(3),
        np.empty(3),
        np.empty((3, size)),
        np.empty(6),
        np.empty(size),
    )


FITS: Final = (
    "float64[:,:,::1], float64[:,:,::1], float64[:,:,:,::1], float64[::1], float64[:,::1], float64[:,::1], float64, "
    "float64[:,:,::1], float64[:,::1], boolean[::1]"
)


@kernel(arrays=FITS)
def least_squares(
    points: Any,
    targets: Any,
    directions: Any,
    weights: Any,
    basis: Any,
    start: Any,
    reach: float,
    turns: Any,
    shifts: Any,
    met: Any,
) -> None:
    """Poses of least squares.

    Args:
        points, targets: p, q (fits, 3, n) [mm]; (..., 1) of what does not vary.
        directions: D (fits, 3, 3, n) or (..., 1), with rows of 0 for what does not count.
        weights: of the squares (fits,).
        basis: steps that residuals see: turn times reach, and shift (6, steps).
        start: the nominal pose (3, 4).
        reach: of the points [mm].
        turns, shifts: found (3, 3, n), (3, n) [mm]; NaN where they are not.
        met: whether they are (n,).
    """
    fits, rooms, pose = (points, targets, directions, weights), new_rooms(basis.shape[1]), np.empty((3, 4))
    for i in range(met.shape[0]):
        copy_matrix(pose, start)
        kept(pose, by_squares(pose, fits, i, basis, reach, rooms), i, turns, shifts, met)


@kernel(arrays=FITS)
def least_largest(
    points: Any,
    targets: Any,
    directions: Any,
    weights: Any,
    basis: Any,
    start: Any,
    reach: float,
    turns: Any,
    shifts: Any,
    met: Any,
) -> None:
    """Poses of the least largest residual; see `least_squares`, whose weights count for where it starts only."""
    fits, rooms, pose = (points, targets, directions, weights), new_rooms(basis.shape[1]), np.empty((3, 4))
    for i in range(met.shape[0]):
        copy_matrix(pose, start)
        found = by_squares(pose, fits, i, basis, reach, rooms) and by_barriers(pose, fits, i, basis, reach, rooms)
        kept(pose, found, i, turns, shifts, met)


@dataclass(frozen=True, eq=False)
class BestFitting(Placer):
    """A best fit at its nominal points; solved in the world, with the middle of the part's points at 0.

    Args:
        move: the move.
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
        """The world after the move, and status codes (n,)."""
        points, targets, directions = _asked(self.move, world)
        turn, shift = np.empty((3, 3, world.trials)), np.empty((3, world.trials))
        met = np.empty(world.trials, dtype=bool)
        fitted = least_squares if self.move.criterion == "squares" else least_largest
        points, targets = np.ascontiguousarray(points - self.middle), np.ascontiguousarray(targets - self.origin)
        fitted(points, targets, directions, self.weights, self.basis, self.start, self.reach, turn, shift, met)
        pose = Pose(turn, shift + self.origin - rotated(turn, self.middle))
        return world.with_part_at(self.move.part, pose), np.where(met, OK, SINGULAR).astype(np.int8)

    def asked(self, assembly: Assembly, middle: Array) -> Iterator[Asked]:
        """All points at once."""
        rows = []
        for fit in self.move.fits:
            turn = assembly.part[assembly.features[fit.target].part].pose[:3, :3]
            rows.append(point_rows(frame_in_world(assembly, fit.moving)[:3, 3] - middle, fit.directions @ turn.T))
        yield Asked(f"fit of {listed([own.moving for own in self.move.fits])}", np.concatenate(rows))


def best_fitting(move: BestFit, nominal: World) -> BestFitting:
    """A best fit.

    Args:
        move: the move.
        nominal: the world before it without deviations, the part at its nominal pose.

    Raises:
        InputError: a weight is not positive, or no residual depends on the part.
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
    """Arrays of all fits, (fits, ..., n) or (fits, ..., 1)."""
    return np.stack(np.broadcast_arrays(*arrays))
