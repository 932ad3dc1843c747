"""Gauges of virtual condition in the datum features of a frame, to first order: their common clearance."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from tol3d.assembly.model import Datum, Feature, Floating, Shape
from tol3d.assembly.model.datum_frame import GaugeRoom
from tol3d.assembly.torsors.columns import Columns, without_rounding
from tol3d.assembly.torsors.freedoms import Freedoms
from tol3d.assembly.torsors.later_datums import LaterDatums, RoomAfter, later_datums
from tol3d.assembly.torsors.room import Room
from tol3d.assembly.torsors.torsor import cross_matrix, shift_at
from tol3d.numerics.arrays import Array

SEEN = 1e-6
"""Change of all offsets by a freedom of length 1 [mm] that is none."""


@dataclass(frozen=True, eq=False)
class GaugesRoom:
    """Play between gauges and a part that the datums before them leave free.

    Args:
        rest: the frame's torsor (6, columns) by those datums, with no other shift or turn.
        motions: the torsors of the part by its freedoms (6, freedoms), of which those are shift of the middle of all
            places and turn times their largest distance from it.
        directions: the freedoms in these (freedoms, 6).
        offsets: of the datum features from the gauges (places * 2, columns) [mm].
        clearances: (places, columns) [mm].
        rows: change of the offsets by the freedoms (places, 2, freedoms).
        later: datums regardless of size after these; None without any.
    """

    rest: Array
    motions: Array
    directions: Array
    offsets: Array
    clearances: Array
    rows: Array
    later: LaterDatums | None = None

    def displacement(self, floating: Floating, columns: Columns) -> Array:
        """The frame's torsor (6, columns) with the gauges somewhere in their room."""
        drawn = np.eye(columns.count)[list(range(floating.columns.start, floating.columns.stop))]
        forms = without_rounding(np.concatenate([self.offsets, self.clearances, drawn]))
        still = np.zeros(self.rows.shape[2])
        room = Room(forms, self.rows, floating, self.directions, still)
        made = columns.made_by(room if self.later is None else RoomAfter(room, self.later))
        return np.asarray(self.rest - self.motions @ made[:-1])


def gauges_room(
    rooms: Sequence[GaugeRoom],
    datums: Sequence[tuple[Feature, Array]],
    kept: Freedoms,
    size: Callable[[str], Array],
    columns: Columns,
    later: Sequence[tuple[Datum, Feature, Array]],
    name: str,
) -> GaugesRoom:
    """The play of some gauges.

    Args:
        rooms: of each datum.
        datums: the features at their boundary with their torsors (6, columns).
        kept: freedoms held by the datums before them.
        size: how much larger a feature is than nominally (columns,) [mm].
        columns: of the assembly.
        later: datums regardless of size after these, with their features and torsors.
        name: of the frame.
    """
    left, rest = kept.left, kept.rest()
    seeing = [feature for feature, _ in datums] + [feature for _, feature, _ in later]
    points = [feature.frame[:3, :3] @ end + feature.frame[:3, 3] for feature in seeing for end in feature.shape.ends]
    middle = np.mean(points, axis=0)
    reach = max(1.0, *(float(np.linalg.norm(point - middle)) for point in points))
    to_torsor = np.eye(6)
    to_torsor[:3, 3:] = cross_matrix(middle) / reach
    to_torsor[3:, 3:] /= reach
    ways, offsets, clearances = [], [], []
    for room, (feature, torsor) in zip(rooms, datums, strict=True):
        nominal, directions = feature.shape.nominal_size or 0.0, counted(feature.frame, feature.shape)
        over = size(room.feature) + columns.constants(np.array([nominal - room.virtual]))[0]
        for end in feature.shape.ends:
            rows = directions @ shift_at(feature.frame[:3, :3] @ end + feature.frame[:3, 3])
            ways.append(rows @ to_torsor)
            offsets.append(rows @ (torsor - rest))
            clearances.append(0.5 * over if room.grows else -0.5 * over)
    free = np.linalg.qr(np.linalg.solve(to_torsor, left))[0]
    for _, feature, _ in later:
        for end in feature.shape.ends:
            place = feature.frame[:3, :3] @ end + feature.frame[:3, 3]
            ways.append(counted(feature.frame, feature.shape) @ shift_at(place) @ to_torsor)
    whole = np.array(ways) @ free
    _, strengths, right = np.linalg.svd(whole.reshape(2 * len(whole), free.shape[1]))
    seen = right[: int(np.sum(strengths > SEEN))].T
    motions = to_torsor @ _least(free @ seen, free @ right[seen.shape[1] :].T)
    after = later_datums(later, rest, motions, reach, name) if later else None
    rows = whole[: len(clearances)] @ seen
    return GaugesRoom(rest, motions, (free @ seen).T, np.concatenate(offsets), np.array(clearances), rows, after)


def _least(seen: Array, unseen: Array) -> Array:
    """Effective freedoms (6, freedoms), with as much of the others as makes the part turn least, and then shift least.

    Args:
        seen: shifts [mm] and turns [rad] of the effective ones (6, freedoms).
        unseen: of the others (6, others).
    """
    _, strengths, right = np.linalg.svd(unseen[3:])
    turning, shifting = np.split(right.T, [int(np.sum(strengths > SEEN))], axis=1)
    found = seen
    for ways, own in ((unseen @ turning, slice(3, 6)), (unseen @ shifting, slice(0, 3))):
        found = found - ways @ np.linalg.lstsq(ways[own], found[own], rcond=None)[0]
    return np.asarray(found, dtype=np.float64)


def counted(frame: Array, shape: Shape) -> Array:
    """Directions (2, 3) in which the ends of a feature in a frame count; of a plane or slot its normal, and none."""
    sides = frame[:3, shape.located].T
    return np.concatenate([sides, np.zeros((2 - len(sides), 3))])
