"""Datum frames on gauges of virtual condition: position of the gauges in their common clearance, trial by trial.

The datums before them are met first and kept. In the freedoms left the gauges, all of one piece, lie like a part with
play (`engaging`): the programme of `rooms` with the offsets at a pose, its steps as finite motions, until it rests.
Datums regardless of size after them take from the room first what they can (`later_datums`).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from tol3d.assembly.model import Engage, Floating, Gauges
from tol3d.assembly.model.statuses import FITS, NO_BUILD, OK, SINGULAR
from tol3d.assembly.placing.actual_feature import ActualFeature, actual_size
from tol3d.assembly.placing.alignment import Seat
from tol3d.assembly.placing.datum_seats import Actual, DatumSeats
from tol3d.assembly.placing.floats import axes_of
from tol3d.assembly.placing.growth import Mask, centred
from tol3d.assembly.placing.later_datums import LaterDatums, later_datums
from tol3d.assembly.placing.poses import IDENTITY, Codes, Pose, full
from tol3d.assembly.placing.rooms import room_found
from tol3d.assembly.placing.seen_motions import SeenMotions, seen_motions
from tol3d.numerics.arrays import Array, times

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
        order, axes = axes_of(self.freedoms)
        uniforms = floating.sweeps(columns[floating.columns], order, 0)
        stated = np.isnan(uniforms[0])
        gone = self._swept(offsets, clearances, rows, centred, axes, uniforms)
        last = 2.0 * uniforms[-len(axes) :] - 1.0
        gone = np.where(stated, times(axes.T, last), gone)
        length = np.sqrt(sum(own * own for own in gone))
        along = gone / np.where(length > 0.0, length, 1.0)
        way = self._way(offsets, clearances, rows, centred, along)
        share = np.minimum(np.where(stated, length * way, length), way)
        return np.asarray(centred + np.where((slacks > 0.0) & (length > 0.0), share * along, 0.0))

    def _swept(
        self, offsets: Array, clearances: Array, rows: Array, centred: Array, axes: Array, uniforms: Array
    ) -> Array:
        """Steps (freedoms, n) from the centred pose after all sweeps; see `engaged_poses.drawn_ray`."""
        at, gone, count = offsets + times(rows, centred), np.zeros(centred.shape), len(axes)
        directions = _conjugate(at, clearances, rows, axes)
        for k, drawn in enumerate(uniforms):
            along, still = directions[k % count], np.zeros(centred.shape)
            back, ahead = (self._way(at, clearances, rows, still, sign * along) for sign in (-1.0, 1.0))
            step = ((back + ahead) * drawn - back) * along
            gone, at = gone + step, at + times(rows, step)
        return gone

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


def _conjugate(offsets: Array, clearances: Array, rows: Array, axes: Array) -> list[Array]:
    """Directions of the freedoms (freedoms, n); see `engaged_poses.conjugate`."""
    with np.errstate(divide="ignore", invalid="ignore"):  # without room, which is not asked for
        room = clearances**2 - offsets[:, 0] ** 2 - offsets[:, 1] ** 2
        out = offsets[:, 0, None] * rows[:, 0, :, None] + offsets[:, 1, None] * rows[:, 1, :, None]
        both = np.einsum("krf,krg->kfg", rows, rows, optimize=False)[..., None]
        room = room[:, None, None]
        stiffness = np.asarray(sum(2.0 * both / room + 4.0 * out[:, :, None] * out[:, None] / room**2))
        found = list[Array]()
        for own in axes:
            along = own[:, None] * np.ones(offsets.shape[2])
            for other in found:
                along = along - other * _by_stiffness(other, stiffness, along)
            found.append(along / np.sqrt(_by_stiffness(along, stiffness, along)))
    return found


def _by_stiffness(left: Array, stiffness: Array, right: Array) -> Array:
    """Product (n,) of directions (freedoms, n), by (freedoms, freedoms, n)."""
    size = range(len(left))
    return np.asarray(sum(left[f] * sum(stiffness[f, g] * right[g] for g in size) for f in size))


@dataclass(frozen=True, eq=False)
class GaugedFrame(SeenMotions):
    """The gauges of a datum frame, as they lie nominally: as the datum features at their boundary see the part.

    Args:
        gauges: the gauges.
        floats: position of the part within the clearance.
        later: datums after them.
    """

    gauges: Gauges
    floats: GaugeFloats
    later: LaterDatums

    def placed(self, seats: Sequence[Seat], actual: Actual, columns: Array) -> tuple[Pose, Codes]:
        """The part in the frame of its gauges, and status codes (n,).

        Args:
            seats: of all ties of the frame.
            actual: the features of the part.
            columns: the deviations (width, n).
        """
        trials, features = columns.shape[1], [actual(own.feature) for own in self.gauges.rooms]
        after = [actual(name) for name in self.later.features]
        pose, codes = self.as_kept(seats, full(IDENTITY, trials))
        size = self.freedoms.shape[1]
        steps, slacks, left = np.zeros((size, trials)), np.zeros(trials), self.later.left
        asked, found, lacking = np.ones(trials, dtype=bool), np.ones(trials, dtype=bool), np.full(trials, np.inf)
        deciding, places = np.zeros(trials, dtype=np.int64), len(self.rows)
        before = np.zeros((places, trials)), np.zeros((places, trials), dtype=np.int64)
        clearances = self.clearances(features, columns)
        for _ in range(ROUNDS):
            offsets = self.offsets(pose, features, trials)
            room_found(offsets, clearances, self.rows, self.floats.push, asked, steps, slacks, deciding, found, *before)
            if after:
                whole = self.later.nearest(pose, after, offsets, clearances, self.rows, asked)
                if left.shape[1]:
                    its = offsets + times(self.rows, whole), clearances, self.rows @ left
                    whole = whole + times(left, self._floating(*its, columns, asked))
            else:
                whole = self.floats.steps(offsets, clearances, self.rows, steps, slacks, columns)
            lacking = np.where(asked, np.abs(whole).max(axis=0, initial=0.0), lacking)
            moved, _ = self.as_kept(seats, self.moved(pose, whole))
            pose = Pose(np.where(asked, moved.turn, pose.turn), np.where(asked, moved.shift, pose.shift))
            asked = asked & (lacking > MET)
            if not asked.any():
                break
        codes = np.where(codes == OK, np.where(slacks < FITS, NO_BUILD, OK), codes)
        lost = ~(found & (lacking < LOST))
        return pose, np.where((codes == OK) & lost, SINGULAR, codes).astype(np.int8)

    def _floating(self, offsets: Array, clearances: Array, rows: Array, columns: Array, asked: Mask) -> Array:
        """Steps (left, n) to where the part lies in the freedoms that later datums leave."""
        steps, slacks = centred(offsets, clearances, rows, asked)
        floats = replace(self.floats, freedoms=self.floats.freedoms @ self.later.left)
        return floats.steps(offsets, clearances, rows, steps, slacks, columns)

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
    ties = [tie for tie, k in zip(seats.alignment.ties, seats.datums, strict=True) if k < frame.regardless]
    its = seats.of(seats.nominal.__getitem__)[: len(ties)]
    after = [seats.nominal[own.features[0]] for own in frame.later]
    seen = seen_motions(ties, its, [*nominal, *after])
    floating = gauges.floating or Floating("centred")
    freedoms = seen.freedoms
    floats = GaugeFloats(Engage(frame.name, frame.part, (), (), floating), freedoms, np.zeros(freedoms.shape[1]))
    places = sum(len(own.ends) for own in nominal)
    own = replace(seen, nominal=tuple(nominal), rows=np.ascontiguousarray(seen.rows[:places]))
    return GaugedFrame(**vars(own), gauges=gauges, floats=floats, later=later_datums(frame, after, seen))
