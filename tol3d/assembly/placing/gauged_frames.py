"""Datum frames on gauges of virtual condition: position of the gauges in their common clearance, trial by trial.

The datums regardless of size are met first and kept. In the freedoms left the gauges, all of one piece, lie like a part
with play (`engaging`): the programme of `rooms` with the offsets at a pose, its steps as finite motions, until nothing
moves.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from tol3d.assembly.model import Axis, Engage, Floating, Gauges
from tol3d.assembly.model.statuses import NO_BUILD, OK, SINGULAR
from tol3d.assembly.placing.actual_feature import ActualFeature, actual_size
from tol3d.assembly.placing.alignment import Alignment, Seat, Tie
from tol3d.assembly.placing.datum_seats import DatumSeats
from tol3d.assembly.placing.engaging import SEEN, moved_about
from tol3d.assembly.placing.freedoms import aligned
from tol3d.assembly.placing.poses import IDENTITY, Codes, Pose, column, dot
from tol3d.assembly.placing.rooms import room_found
from tol3d.numerics.arrays import Array

ROUNDS: Final = 12
"""Corrections of a pose at most; each leaves a turn's share, 1e-3 or less, of the correction."""
MET: Final = 3e-8
"""Step [mm] at which a trial is done."""
LOST: Final = 1e-6
"""Step [mm] left after all rounds at which the pose counts as not found."""


@dataclass(frozen=True, eq=False)
class GaugeFloats:
    """Float of gauges.

    Args:
        move: the move.
        freedoms: (6, freedoms), orthonormal.
        push: direction in which the part is pushed to the limit (freedoms,); 0 for none.
    """

    move: Engage
    freedoms: Array
    push: Array

    def steps(
        self, offsets: Array, clearances: Array, rows: Array, centred: Array, slacks: Array, columns: Array
    ) -> Array:
        """Steps (freedoms, n) from offsets o_k to where the part lies.

        Args:
            offsets, clearances, rows: o_k (cones, 2, n), c_k (cones, n) [mm], B_k (cones, 2, freedoms).
            centred: steps to the centred pose (freedoms, n), or as far as it goes along `push`.
            slacks: of the centred pose (n,) [mm].
            columns: the deviations (width, n).
        """
        floating = self.move.floating
        if floating.kind != "random":
            return centred
        drawn = columns[floating.columns]
        along = np.stack([sum(self.freedoms[r, f] * drawn[r] for r in range(6)) for f in range(len(centred))])
        size = np.sqrt(sum(own * own for own in along))
        along = along / np.where(size > 0.0, size, 1.0)
        way = self._way(offsets, clearances, rows, centred, along)
        share = drawn[6] ** (1.0 / len(centred)) * way
        return np.asarray(centred + np.where((slacks > 0.0) & (size > 0.0), share, 0.0) * along)

    def _way(self, offsets: Array, clearances: Array, rows: Array, centred: Array, along: Array) -> Array:
        """Distance from the centred pose to the limit of the clearance (n,) [mm]."""
        way = np.full(offsets.shape[2], np.inf)
        for own, clearance, row in zip(offsets, clearances, rows, strict=True):
            at = [own[r] + sum(row[r, f] * centred[f] for f in range(len(centred))) for r in (0, 1)]
            gone = [sum(row[r, f] * along[f] for f in range(len(centred))) for r in (0, 1)]
            # |at + t gone| = clearance
            square = gone[0] * gone[0] + gone[1] * gone[1]
            slope = at[0] * gone[0] + at[1] * gone[1]
            room = clearance * clearance - at[0] * at[0] - at[1] * at[1]
            root = np.sqrt(np.maximum(slope * slope + square * room, 0.0))
            away = slope > 0.0
            ahead = np.where(away, room, root - slope) / np.where(
                away, slope + root, np.where(square > 0.0, square, 1.0)
            )
            way = np.where(square > 0.0, np.minimum(way, np.maximum(ahead, 0.0)), way)
        return np.where(np.isfinite(way), way, 0.0)


HELD: Final = 1e-6
"""Part of a motion that affects earlier datums, below which they do not hold it."""


@dataclass(frozen=True, eq=False)
class GaugedFrame:
    """The gauges of a datum frame, as they lie nominally.

    Args:
        gauges: the gauges.
        kept: of the datums before them, in order.
        count: how many ties these make.
        nominal: the datum features at their boundary, in order.
        middle: of all places (3,) [mm].
        reach: of them about it [mm].
        freedoms: motions that earlier datums leave and gauges see: shift of the middle, turn times reach (6, freedoms),
            orthonormal.
        motions: by these, with the least turn and the least shift of the middle that gauges do not see (6, freedoms).
        rows: change of each offset by them (cones, 2, freedoms).
        floats: position of the part within the clearance.
    """

    gauges: Gauges
    kept: Alignment
    count: int
    nominal: tuple[ActualFeature, ...]
    middle: Array
    reach: float
    freedoms: Array
    motions: Array
    rows: Array
    floats: GaugeFloats

    def placed(self, seats: Sequence[Seat], features: Sequence[ActualFeature], columns: Array) -> tuple[Pose, Codes]:
        """The part in the frame of its gauges, and status codes (n,).

        Args:
            seats: of all ties of the frame.
            features: the datum features at their boundary.
            columns: the deviations (width, n).
        """
        trials = columns.shape[1]
        pose, codes = self.as_kept(seats, full(IDENTITY, trials))
        steps, slacks = np.zeros((self.freedoms.shape[1], trials)), np.zeros(trials)
        asked, found, lacking = np.ones(trials, dtype=bool), np.ones(trials, dtype=bool), np.full(trials, np.inf)
        deciding, places = np.zeros(trials, dtype=np.int64), len(self.rows)
        before = np.zeros((places, trials)), np.zeros((places, trials), dtype=np.int64)
        clearances = self.clearances(features, columns)
        for _ in range(ROUNDS):
            offsets = self.offsets(pose, features, trials)
            room_found(offsets, clearances, self.rows, self.floats.push, asked, steps, slacks, deciding, found, *before)
            whole = self.floats.steps(offsets, clearances, self.rows, steps, slacks, columns)
            lacking = np.where(asked, np.abs(whole).max(axis=0, initial=0.0), lacking)
            moved, _ = self.as_kept(seats, self.moved(pose, whole))
            pose = Pose(np.where(asked, moved.turn, pose.turn), np.where(asked, moved.shift, pose.shift))
            asked = asked & (lacking > MET)
            if not asked.any():
                break
        codes = np.where(codes == OK, np.where(slacks < 0.0, NO_BUILD, OK), codes)
        lost = ~(found & (lacking < LOST))
        return pose, np.where((codes == OK) & lost, SINGULAR, codes).astype(np.int8)

    def as_kept(self, seats: Sequence[Seat], start: Pose) -> tuple[Pose, Codes]:
        """A pose corrected to keep the datums before the gauges."""
        pose, codes = self.kept.poses(seats[: self.count], start)
        return full(pose, start.shift.shape[1]), codes

    def moved(self, pose: Pose, steps: Array) -> Pose:
        """A pose after steps (freedoms, n) as finite motions."""
        motion = np.einsum("rf,fn->rn", self.motions, steps, optimize=False)
        return moved_about(pose, self.middle, motion[:3], motion[3:] / self.reach)

    def offsets(self, pose: Pose, features: Sequence[ActualFeature], trials: int) -> Array:
        """Offsets of the datum features from their gauges (cones, 2, n) [mm]."""
        found = np.zeros((len(self.rows), 2, trials))
        k = 0
        for own, nominal in zip(features, self.nominal, strict=True):
            seen = own.moved(pose)
            for end, place in zip(seen.ends, nominal.ends, strict=True):
                for r, across in enumerate(_across(nominal)):
                    found[k, r] = dot(column(across), end - place)
                k += 1
        return found

    def clearances(self, features: Sequence[ActualFeature], columns: Array) -> Array:
        """Clearance of each offset (cones, n) [mm]."""
        found = np.empty((len(self.rows), columns.shape[1]))
        k = 0
        for room, own in zip(self.gauges.rooms, features, strict=True):
            size = actual_size(own.feature, columns)
            ends = len(own.ends)
            found[k : k + ends] = 0.5 * (size - room.virtual if room.grows else room.virtual - size)
            k += ends
        return found


def with_gauges(seats: Mapping[str, DatumSeats]) -> dict[str, DatumSeats]:
    """Datum frames of a part, those with gauges with them."""
    return {
        name: own if own.frame.gauges is None else replace(own, gauged=_gauged(own, own.frame.gauges))
        for name, own in seats.items()
    }


def _gauged(seats: DatumSeats, gauges: Gauges) -> GaugedFrame:
    """The gauges of a datum frame, by its nominal geometry."""
    frame, nominal = seats.frame, [seats.nominal[own.feature] for own in gauges.rooms]
    at = np.concatenate([np.array([end[:, 0] for end in own.ends]) for own in nominal])
    middle = at.mean(axis=0)
    reach = max(float(np.linalg.norm(at - middle, axis=1).max()), 1.0)
    first = len(frame.datums) - len(gauges.rooms)
    ties = [tie for tie, k in zip(seats.alignment.ties, seats.datums, strict=True) if k < first]
    its = seats.of(seats.nominal.__getitem__)[: len(ties)]
    ways = np.concatenate([np.array([_rows_of(own, end, middle, reach) for end in own.ends]) for own in nominal])
    free = _left(ties, its, middle, reach)
    _, sizes, right = np.linalg.svd((ways @ free).reshape(-1, free.shape[1]), full_matrices=True)
    rank = int(np.sum(sizes > SEEN))
    freedoms = free @ right[:rank].T
    motions = _least_motions(freedoms, free @ right[rank:].T)
    floating = gauges.floating or Floating("centred")
    floats = GaugeFloats(Engage(frame.name, frame.part, (), (), floating), freedoms, np.zeros(freedoms.shape[1]))
    rows, kept = np.ascontiguousarray(ways @ freedoms), aligned(ties, its, IDENTITY)
    return GaugedFrame(gauges, kept, len(ties), tuple(nominal), middle, reach, freedoms, motions, rows, floats)


def _least_motions(seen: Array, unseen: Array) -> Array:
    """Motions that are seen (6, motions), with unseen ones (6, unseen) so that they turn, then shift least."""
    found, left = seen, unseen
    for rows in (np.eye(6)[3:], np.eye(6)[:3]):
        acts = np.where(np.abs(rows @ left) < HELD, 0.0, rows @ left)
        found = found - left @ np.linalg.pinv(acts, rcond=HELD) @ rows @ found
        left = left @ np.linalg.svd(acts)[2][int(np.linalg.matrix_rank(acts, HELD)) :].T
    return found


def _across(nominal: ActualFeature) -> Array:
    """Directions in which a gauge is limited: two of a pin, one of a blade (directions, 3)."""
    frame = nominal.feature.frame[:3, :3].T
    return frame[:2] if isinstance(nominal.feature.shape, Axis) else frame[2:]


def _rows_of(nominal: ActualFeature, end: Array, middle: Array, reach: float) -> Array:
    """Change of an offset per shift of the middle and turn times reach (2, 6)."""
    found = np.zeros((2, 6))
    for r, across in enumerate(_across(nominal)):
        found[r] = point_row(end[:, 0] - middle, across, reach)
    return found


def point_row(arm: Array, direction: Array, reach: float) -> Array:
    """Displacement of a point along a direction per shift of the middle and turn times reach (6,)."""
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


def full(pose: Pose, trials: int) -> Pose:
    """With a trial of its own each."""
    return Pose(
        np.array(np.broadcast_to(pose.turn, (3, 3, trials))), np.array(np.broadcast_to(pose.shift, (3, trials)))
    )
