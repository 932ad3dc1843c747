"""Datum frames on gauges of virtual condition: position of the gauges in their common clearance, trial by trial.

The datums before them are met first and kept. In the freedoms left the gauges, all of one piece, lie like a part with
play (`engaging`): the programme of `rooms` with the offsets at a pose, its steps as finite motions, until it rests.
Datums regardless of size after them take from the room first what they can (`later_datums`).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.model import Engage, Floating, Gauges
from tol3d.assembly.model.statuses import FITS, NO_BUILD, OK, SINGULAR
from tol3d.assembly.placing.actual_feature import ActualFeature, actual_size
from tol3d.assembly.placing.alignment import Seat
from tol3d.assembly.placing.chords import ray, way_along
from tol3d.assembly.placing.datum_seats import Actual, DatumSeats
from tol3d.assembly.placing.float_position import axes_of
from tol3d.assembly.placing.later_datums import LaterDatums, later_datums
from tol3d.assembly.placing.poses import IDENTITY, Codes, Pose, full
from tol3d.assembly.placing.seen_motions import SeenMotions, seen_motions
from tol3d.contact.programme import Programme
from tol3d.contact.seat import Place
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
    """

    move: Engage
    freedoms: Array

    def steps(
        self, offsets: Array, clearances: Array, rows: Array, centred: Array, slacks: Array, columns: Array
    ) -> Array:
        """Steps (freedoms, n) from offsets o_k to where the part lies.

        Args:
            offsets, clearances, rows: o_k (cones, 2, n), c_k (cones, n) [mm], B_k (cones, 2, freedoms).
            centred: steps to the centred pose (freedoms, n).
            slacks: of the centred pose (n,) [mm].
            columns: the deviations (width, n).
        """
        floating = self.move.floating
        if floating.kind != "random":
            return centred
        order, axes = axes_of(self.freedoms)
        uniforms = floating.sweeps(columns[floating.columns], order, 0)
        place = Place(offsets + times(rows, centred), clearances, rows[..., None])
        along, share = ray(place, axes, uniforms, _way)
        return np.asarray(centred + np.where(slacks > 0.0, share * _way(place, along) * along, 0.0))


def _way(place: Place, along: Array) -> Array:
    """Distance along directions to the limit of the clearance (n,) [mm]; 0 where there is none."""
    way = way_along(place, along)
    return np.where(np.isfinite(way), way, 0.0)


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
        trials, features = columns.shape[1], [actual(room.feature) for room in self.gauges.rooms]
        after = [actual(name) for name in self.later.features]
        pose, codes = self.as_kept(seats, full(IDENTITY, trials))
        size = self.freedoms.shape[1]
        left, asked, lacking = self.later.left, np.ones(trials, dtype=bool), np.full(trials, np.inf)
        clearances, programme = self.clearances(features, columns), Programme.of(len(self.rows), size, trials)
        for _ in range(ROUNDS):
            offsets = self.offsets(pose, features, trials)
            programme.solve(offsets, clearances, self.rows[..., None], asked=asked)
            if after:
                whole = self.later.nearest(pose, after, offsets, clearances, self.rows, asked)
                if left.shape[1]:
                    its = offsets + times(self.rows, whole), clearances, self.rows @ left
                    whole = whole + times(left, self._floating(*its, columns, asked))
            else:
                its = offsets, clearances, self.rows
                whole = self.floats.steps(*its, programme.steps, programme.slack, columns)
            lacking = np.where(asked, np.abs(whole).max(axis=0, initial=0.0), lacking)
            moved, _ = self.as_kept(seats, self.moved(pose, whole))
            pose = Pose(np.where(asked, moved.turn, pose.turn), np.where(asked, moved.shift, pose.shift))
            asked = asked & (lacking > MET)
            if not asked.any():
                break
        codes = np.where(codes == OK, np.where(programme.slack < FITS, NO_BUILD, OK), codes)
        lost = ~(programme.found & (lacking < LOST))
        return pose, np.where((codes == OK) & lost, SINGULAR, codes).astype(np.int8)

    def _floating(
        self, offsets: Array, clearances: Array, rows: Array, columns: Array, asked: NDArray[np.bool_]
    ) -> Array:
        """Steps (left, n) to where the part lies in the freedoms that later datums leave."""
        centred = Programme.of(len(rows), rows.shape[2], columns.shape[1])
        centred.solve(offsets, clearances, rows[..., None], asked=asked)
        floats = replace(self.floats, freedoms=self.floats.freedoms @ self.later.left)
        return floats.steps(offsets, clearances, rows, centred.steps, centred.slack, columns)

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
    frame, nominal = seats.frame, [seats.nominal[room.feature] for room in gauges.rooms]
    ties = [tie for tie, k in zip(seats.alignment.ties, seats.datums, strict=True) if k < frame.regardless]
    its = seats.of(seats.nominal.__getitem__)[: len(ties)]
    after = [seats.nominal[own.features[0]] for own in frame.later]
    seen = seen_motions(ties, its, [*nominal, *after])
    floating = gauges.floating or Floating("centred")
    freedoms = seen.freedoms
    floats = GaugeFloats(Engage(frame.name, frame.part, (), (), floating), freedoms)
    places = sum(len(own.ends) for own in nominal)
    own = replace(seen, nominal=tuple(nominal), rows=np.ascontiguousarray(seen.rows[:places]))
    return GaugedFrame(**vars(own), gauges=gauges, floats=floats, later=later_datums(frame, after, seen))
