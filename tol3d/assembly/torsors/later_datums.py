"""Datums regardless of size after ones at their boundary, to first order: as near as the room of the gauges lets them.

One after the other each takes, of the motions that are left, those that bring it nearest to its simulator within the
room; what it has taken stays.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import singledispatch
from typing import Final

import numpy as np

from tol3d.assembly.model import Datum, Feature, Slot
from tol3d.assembly.model.feature import Facts, Flat
from tol3d.assembly.torsors.room import Room, changes, least_slack
from tol3d.assembly.torsors.terms import Form
from tol3d.assembly.torsors.torsor import height_at, ordered_product, shift_at, turn_about
from tol3d.contact.programme import SPARE, least_growth
from tol3d.errors import InputError
from tol3d.numerics.arrays import Array

SEEN: Final = 1e-6
"""Change of what is asked by a freedom of length 1 [mm] that is none."""


@dataclass(frozen=True, eq=False)
class Ask:
    """One thing that a later datum asks.

    Args:
        forms: what it lacks (places * 2, columns) [mm], then heights of corners over the centre (corners, columns), of
            which the largest length of one counts as well.
        rows: its change by the freedoms (places, 2, freedoms).
        corners: that of the corners (corners, numbers, freedoms).
        open: what earlier asks leave of the freedoms (freedoms, open), orthonormal.
        held: projector to what it takes of these (open, open).
    """

    forms: Array
    rows: Array
    corners: Array
    open: Array
    held: Array

    def offsets(self, read: Array, steps: Array) -> Array:
        """Distances that it lacks after steps (freedoms, trials), (places, 2, trials) [mm]."""
        places = len(self.rows)
        found = read[: 2 * places].reshape(places, 2, -1) + changes(self.rows, steps)
        if len(self.corners):
            count, numbers, freedoms = self.corners.shape
            tops = read[2 * places :] + ordered_product(self.corners.reshape(-1, freedoms), steps)
            found[0, 0] += np.abs(np.hypot.reduce(tops.reshape(count, numbers, -1), axis=1)).max(axis=0)
        return found


@dataclass(frozen=True, eq=False)
class LaterDatums:
    """The asks of the later datums of a frame, in order.

    Args:
        asks: each.
        left: freedoms that they leave (freedoms, left), orthonormal.
    """

    asks: tuple[Ask, ...]
    left: Array

    @property
    def forms(self) -> Array:
        """Lengths that they read (lengths, columns)."""
        return np.concatenate([ask.forms for ask in self.asks])

    def nearest(self, read: Array, offsets: Array, clearances: Array, rows: Array) -> Array:
        """Steps (freedoms, trials) to where each is met as nearly as the room lets it.

        Args:
            read: of `forms` (lengths, trials) [mm].
            offsets, clearances, rows: of the room (places, 2, trials), (places, trials) [mm], (places, 2, freedoms).
        """
        steps, first = np.zeros((rows.shape[2], read.shape[1])), 0
        for k, ask in enumerate(self.asks):
            own = ask.offsets(read[first : first + len(ask.forms)], steps)
            first += len(ask.forms)
            every = np.concatenate([own, offsets + changes(rows, steps)])
            room = np.concatenate([np.zeros((len(own), read.shape[1])), clearances + k * SPARE])
            some = least_growth(every, room, np.concatenate([ask.rows, rows]) @ ask.open, len(own), rounds=1)[1]
            steps = steps + ordered_product(ask.open @ ask.held, some)
        return steps


@dataclass(frozen=True, eq=False)
class RoomAfter:
    """The freedoms of a frame on gauges with later datums, and its slack, trial by trial.

    Args:
        room: as it is without them.
        later: the later datums.
    """

    room: Room
    later: LaterDatums
    form: Form = "place in a room"

    @property
    def forms(self) -> Array:
        """Those of the room, then of the later datums."""
        return np.concatenate([self.room.forms, self.later.forms])

    @property
    def count(self) -> int:
        """As of the room."""
        return self.room.count

    def values(self, read: Array) -> Array:
        """(freedoms + 1, trials) [mm]."""
        its, own = np.split(read, [len(self.room.forms)])
        rows, left, places = self.room.rows, self.later.left, len(self.room.rows)
        offsets, clearances = its[: 2 * places].reshape(places, 2, -1), its[2 * places : 3 * places]
        steps = self.later.nearest(own, offsets, clearances, rows)
        offsets = offsets + changes(rows, steps)
        slack = least_slack(offsets, clearances)
        if left.shape[1]:
            some = replace(self.room, rows=rows @ left, directions=left.T @ self.room.directions, push=left[0] * 0.0)
            found = some.values(np.concatenate([offsets.reshape(2 * places, -1), its[2 * places :]]))
            steps, slack = steps + ordered_product(left, found[:-1]), found[-1]
        return np.concatenate([steps, slack[None]])


def later_datums(
    datums: Sequence[tuple[Datum, Feature, Array]], rest: Array, motions: Array, reach: float, name: str
) -> LaterDatums:
    """The asks of the later datums of a frame.

    Args:
        datums: each with its feature and that one's torsor (6, columns).
        rest: the frame's torsor (6, columns) by the datums before the gauges.
        motions: the torsors of the part by its freedoms (6, freedoms).
        reach: length that a turn counts by [mm].
        name: of the frame.

    Raises:
        InputError: one takes no freedom.
    """
    left, asks = np.eye(motions.shape[1]), list[Ask]()
    for datum, feature, torsor in datums:
        count = len(asks)
        for equations, corners in _asked(feature.shape, datum, feature.frame, reach):
            rows = equations @ motions
            _, sizes, right = np.linalg.svd((rows @ left).reshape(2 * len(rows), left.shape[1]))
            rank = int(np.sum(sizes > SEEN))
            if rank:
                lacks = np.concatenate([*(equations @ (torsor - rest)), corners.reshape(-1, 6) @ (torsor - rest)])
                held = right[:rank].T @ right[:rank]
                asks.append(Ask(lacks, rows, corners @ motions, left, held))
                left = left @ right[rank:].T
        if len(asks) == count:
            raise InputError(
                f"datum frame {name}: {feature.name} takes no freedom: datums before it hold all that it asks; "
                "leave it out"
            )
    return LaterDatums(tuple(asks), left)


NO_CORNERS: Final = np.zeros((0, 1, 6))


@singledispatch
def _asked(shape: Facts, datum: Datum, frame: Array, reach: float) -> list[tuple[Array, Array]]:
    """Equations (places, 2, 6) of each thing that a datum asks, and rises of corners beside it (corners, numbers, 6).

    By its shape; here an axis.
    """
    aside = (frame[:3, :2].T @ shift_at(frame[:3, 3]))[None]
    return [(aside, NO_CORNERS), (reach * turn_about(frame[:3, :2].T)[None], NO_CORNERS)]


@_asked.register
def _(shape: Slot, datum: Datum, frame: Array, reach: float) -> list[tuple[Array, Array]]:
    places = [frame[:3, :3] @ end + frame[:3, 3] for end in shape.ends]
    return [(np.stack([_alone(height_at(place, frame[:3, 2])) for place in places]), NO_CORNERS)]


@_asked.register
def _(shape: Flat, datum: Datum, frame: Array, reach: float) -> list[tuple[Array, Array]]:
    centre, (x, y, z) = frame[:3, 3], frame[:3, :3].T
    if datum.targets is not None:
        return [(_alone(height_at(frame[:3, :3] @ target + centre, z))[None], NO_CORNERS) for target in datum.targets]
    height, corners = height_at(centre, z), NO_CORNERS
    if datum.simulator == "contact":
        ways = shape.rim @ np.array([shape.reach[0] * x, shape.reach[1] * y])
        corners = np.array([[(height_at(centre + own, z) - height).reshape(6) for own in some] for some in ways])
    return [(reach * turn_about(frame[:3, :2].T)[None], NO_CORNERS), (_alone(height)[None], corners)]


def _alone(row: Array) -> Array:
    return np.concatenate([np.atleast_2d(row), np.zeros((1, 6))])
