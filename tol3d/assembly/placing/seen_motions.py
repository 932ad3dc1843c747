"""Motions of a part that the first datums of a frame leave, as later features see them; and patterns laid by them.

A pattern is laid where the squares of its places' distances from their nominal ones are least: both ends of an axis
across it, corners of a plane along its normal, centres of points and balls. What it holds then counts as one axis,
plane or point of the part, so that later datums take what it leaves.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from tol3d.assembly.model.feature import Asks, Held
from tol3d.assembly.placing.actual_feature import ActualFeature
from tol3d.assembly.placing.alignment import Alignment, Seat, Tie
from tol3d.assembly.placing.freedoms import aligned
from tol3d.assembly.placing.poses import IDENTITY, Codes, Pose, column, cross, dot, full, moved_about, rotated_back
from tol3d.errors import InputError
from tol3d.numerics.arrays import Array, times

SEEN: Final = 1e-6
"""Change of all offsets by a motion of length 1 [mm] that is none."""
HELD: Final = 1e-6
"""Part of a motion that earlier datums see, under which they do not hold it."""
ROUNDS: Final = 5
"""Rounds of least squares; each leaves a turn's share, 1e-3 or less, of what it corrects."""


@dataclass(frozen=True, eq=False)
class SeenMotions:
    """Motions of a part that earlier datums leave and that features see.

    Args:
        kept: of the datums before them, in order.
        count: how many ties these make.
        nominal: the features, in order.
        middle: of all places (3,) [mm].
        reach: of them about it [mm].
        freedoms: motions that earlier datums leave and the features see: shift of the middle, turn times reach (6,
            freedoms), orthonormal.
        motions: by these, with the least turn and the least shift of the middle that they do not see (6, freedoms).
        rows: change of each offset by them (cones, 2, freedoms).
    """

    kept: Alignment
    count: int
    nominal: tuple[ActualFeature, ...]
    middle: Array
    reach: float
    freedoms: Array
    motions: Array
    rows: Array

    def as_kept(self, seats: Sequence[Seat], start: Pose) -> tuple[Pose, Codes]:
        """A pose as the earlier datums keep it."""
        pose, codes = self.kept.poses(seats[: self.count], start)
        return full(pose, start.shift.shape[1]), codes

    def moved(self, pose: Pose, steps: Array) -> Pose:
        """A pose after steps (freedoms, n) as finite motions."""
        motion = times(self.motions, steps)
        return moved_about(pose, self.middle, motion[:3], motion[3:] / self.reach)

    def offsets(self, pose: Pose, features: Sequence[ActualFeature], trials: int) -> Array:
        """Offsets of the features from their nominal places (cones, 2, n) [mm]."""
        found = np.zeros((len(self.rows), 2, trials))
        for k, (end, place, sides) in enumerate(self._places(pose, features)):
            for r, across in enumerate(sides):
                found[k, r] = dot(column(across), end - place)
        return found

    def _places(self, pose: Pose, features: Sequence[ActualFeature]) -> Iterator[tuple[Array, Array, Array]]:
        """Each place (3, n) with where it is nominally and the directions that count, a cone each."""
        for own, nominal in zip(features, self.nominal, strict=True):
            for end, place in zip(own.moved(pose).ends, nominal.ends, strict=True):
                for sides in sides_of(nominal):
                    yield end, place, sides


@dataclass(frozen=True, eq=False)
class Pattern(SeenMotions):
    """Features that are one datum together.

    Args:
        ties: what they hold.
        centre: about which they turn (3,): the middle of their centres [mm].
        directions: of each tie (ties, 3).
    """

    ties: tuple[Asks, ...]
    centre: Array
    directions: Array

    def seats(self, before: Sequence[Seat], features: Sequence[ActualFeature]) -> Iterator[Seat]:
        """A seat for each tie: in the part where the pattern says, on the part's nominal place.

        Args:
            before: the seats of earlier datums.
            features: of the pattern, in their trials.
        """
        pose = self._laid(before, features)
        middle = column(self.centre)
        point = pose.inverse.point(middle)
        for along in self.directions:
            toward = column(along)
            yield Seat(point, middle, rotated_back(pose.turn, toward), toward)

    def _laid(self, before: Sequence[Seat], features: Sequence[ActualFeature]) -> Pose:
        """Pose of the part with the least sum of squares (n,)."""
        trials = max([feature.origin.shape[1] for feature in features] + [own.point.shape[1] for own in before])
        size, middle = self.motions.shape[1], column(self.middle)
        pose, _ = self.as_kept(before, full(IDENTITY, trials))
        for _ in range(ROUNDS):
            square, missing = np.zeros((trials, size, size)), np.zeros((trials, size))
            for end, place, sides in self._places(pose, features):
                for across in map(column, sides):
                    turning = cross(end - middle, across) / self.reach
                    seen = np.concatenate([np.broadcast_to(across, turning.shape), turning])
                    row = times(self.motions.T, seen).T
                    square += row[:, :, None] * row[:, None, :]
                    missing += row * dot(across, end - place)[:, None]
            steps = -np.linalg.solve(square, missing[:, :, None])[:, :, 0].T
            pose, _ = self.as_kept(before, self.moved(pose, steps))
        return pose


def seen_motions(ties: Sequence[Tie], seats: Sequence[Seat], nominal: Sequence[ActualFeature]) -> SeenMotions:
    """The motions that ties leave and features see, nominally.

    Args:
        ties, seats: of the datums before the features.
        nominal: the features.
    """
    at = np.concatenate([np.array([end[:, 0] for end in own.ends]) for own in nominal])
    middle = at.mean(axis=0)
    reach = max(float(np.linalg.norm(at - middle, axis=1).max()), 1.0)
    places = [(end, sides) for own in nominal for end in own.ends for sides in sides_of(own)]
    ways = np.array([_rows_of(end, sides, middle, reach) for end, sides in places])
    free = _left(ties, seats, middle, reach)
    _, sizes, right = np.linalg.svd((ways @ free).reshape(2 * len(ways), free.shape[1]), full_matrices=True)
    rank = int(np.sum(sizes > SEEN))
    freedoms = free @ right[:rank].T
    motions = _least_motions(freedoms, free @ right[rank:].T)
    rows, kept = np.ascontiguousarray(ways @ freedoms), aligned(ties, seats, IDENTITY)
    return SeenMotions(kept, len(ties), tuple(nominal), middle, reach, freedoms, motions, rows)


def pattern(name: str, ties: Sequence[Tie], seats: Sequence[Seat], nominal: Sequence[ActualFeature]) -> Pattern:
    """Features as one datum, nominally.

    Args:
        name: of the datum, for messages.
        ties, seats: of the datums before it.
        nominal: its features.

    Raises:
        InputError: together they hold no axis, plane or point.
    """
    alone = seen_motions((), (), nominal)
    unseen = np.linalg.svd(alone.freedoms.T)[2][alone.freedoms.shape[1] :].T
    left, sizes, right = np.linalg.svd(unseen[3:])
    turns = int(np.sum(sizes > HELD))
    shifts = unseen[:3] @ right[turns:].T  # without turns
    along = shifts[:, 0] if shifts.size else np.eye(3)[2]
    if turns == 1:
        along = left[:, 0]
        shift = unseen[:3] @ right[0] - shifts @ shifts.T @ unseen[:3] @ right[0]
        if np.linalg.norm(shift) > HELD:
            turns = 3
    parallel = shifts.shape[1] < 1 or bool(np.linalg.norm(np.cross(shifts.T, along)) < HELD)
    held: dict[tuple[int, int], Held] = {(0, 0): "all", (1, 0): "all", (0, 1): "across", (1, 1): "across"}
    if (turns, shifts.shape[1]) == (1, 2) and np.abs(along @ shifts).max() < HELD:
        asked: list[Asks] = [("along", "direction")]
    elif (turns, shifts.shape[1]) in held and parallel:
        asked = [(held[turns, shifts.shape[1]], "direction")]
    else:
        raise InputError(
            f"{name} holds no axis, plane or point: expected parallel holes or pins, flat faces, balls or points, "
            "two or more beside each other"
        )
    directions = [along]
    if turns == 0:  # and how it is turned about that
        side = np.cross(along, np.eye(3)[int(np.argmin(np.abs(along)))])
        asked, directions = [*asked, ("along", "direction")], [along, side / np.linalg.norm(side)]
    centre = np.mean([own.origin[:, 0] for own in nominal], axis=0)
    seen = seen_motions(ties, seats, nominal)
    return Pattern(**vars(seen), ties=tuple(asked), centre=centre, directions=np.array(directions))


def _least_motions(seen: Array, unseen: Array) -> Array:
    """Motions that are seen (6, motions), with unseen ones (6, unseen) so that they turn, then shift least."""
    found, left = seen, unseen
    for rows in (np.eye(6)[3:], np.eye(6)[:3]):
        acts = np.where(np.abs(rows @ left) < HELD, 0.0, rows @ left)
        found = found - left @ np.linalg.pinv(acts, rcond=HELD) @ rows @ found
        left = left @ np.linalg.svd(acts)[2][int(np.linalg.matrix_rank(acts, HELD)) :].T
    return found


def sides_of(nominal: ActualFeature) -> Sequence[Array]:
    """Directions in which a place counts, at most two a cone: two of an axis, one of a plane, three of a point."""
    sides = nominal.feature.frame[:3, nominal.feature.shape.located].T
    return (sides,) if len(sides) <= 2 else (sides[:2], sides[2:])


def _rows_of(end: Array, sides: Array, middle: Array, reach: float) -> Array:
    """Change of an offset with the shift of the middle and turn times reach (2, 6)."""
    found = np.zeros((2, 6))
    for r, across in enumerate(sides):
        found[r] = point_row(end[:, 0] - middle, across, reach)
    return found


def point_row(arm: Array, direction: Array, reach: float) -> Array:
    """Motion of a point along a direction with the shift of the middle and turn times reach (6,)."""
    return np.concatenate([direction, np.cross(arm, direction) / reach])


def _left(ties: Sequence[Tie], seats: Sequence[Seat], middle: Array, reach: float) -> Array:
    """Orthonormal motions (6, free) that ties leave."""
    rows = [np.zeros((0, 6))]
    for tie, seat in zip(ties, seats, strict=True):
        toward = np.eye(3)[:, :1] if seat.toward is None else seat.toward
        sides = np.linalg.svd(toward.T)[2][1:]
        held = {"all": np.eye(3), "along": toward.T, "across": sides}[tie.held]
        rows.append(np.array([point_row(seat.target[:, 0] - middle, own, reach) for own in held]))
        if tie.turning == "direction":
            rows.append(np.hstack([np.zeros((2, 3)), sides]))
    _, sizes, right = np.linalg.svd(np.concatenate(rows))
    return np.asarray(right[int(np.sum(sizes > HELD)) :].T)
