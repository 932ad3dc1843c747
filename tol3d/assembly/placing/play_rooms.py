"""Rooms of parts with play: what their places, relations and goals are at a finite pose."""

from dataclasses import dataclass, replace
from typing import Final, Self

import numpy as np

from tol3d.assembly.placing.chords import bolt_way, way_along
from tol3d.assembly.placing.mate_move import Kept
from tol3d.assembly.placing.play_offsets import ENDS, BoltInHole, EngagedPlace
from tol3d.assembly.placing.poses import Pose, column, cross, dot, rotated, turned_by
from tol3d.contact.seat import Place, taken
from tol3d.numerics.arrays import Array, Places, times

LEFT: Final = 1e-9
"""Part of a motion that relations may see: its effect on rows is of second order in the slack."""
MET: Final = 1e-13
"""Step [rad, and mm per mm of reach] at which relations are met again."""
TIMES: Final = 40
"""Corrections of the relations; a turn of 0.1 takes 13."""


@dataclass(frozen=True, eq=False)
class Push:
    """A goal: as far as a part can go.

    Args:
        along: nominal direction of its freedoms (freedoms,).
        point: a point of the part, from the middle in its frame (3, n) [mm].
        force: in which direction the point goes; 0 where it is the freedoms that count (3,).
        turn: of the part as it lies nominally (3, 3).
    """

    along: Array
    point: Array
    force: Array
    turn: Array


@dataclass(frozen=True, eq=False)
class EngagedRoom:
    """The room of a part with play in some trials; poses are turn (3, 3, n), shift (3, n) and bolts (bolts, 4, n).

    Args:
        places: where it engages.
        kept: what relations keep, of a part whose middle is at the pose's shift.
        undo: steps, turn times reach and shift, that undo a change of it (6, kept).
        first: what is kept, as relations lay the part (kept, n).
        steps: motions that keep it nominally, turn times reach and shift (6, freedoms, 1).
        rows: nominal change of offsets by these, and by shifts and leans of each bolt (places, 2, unknowns, 1).
        reach: of all places about their middle [mm].
        push: its goal; None where it has none.
    """

    places: tuple[EngagedPlace, ...]
    kept: Kept
    undo: Array
    first: Array
    steps: Array
    rows: Array
    reach: float
    push: Push | None = None

    @property
    def parts(self) -> int:
        """Number of the part's freedoms."""
        return int(self.steps.shape[1])

    def of(self, trials: Places) -> Self:
        """The same in some of its trials."""
        kept = replace(self.kept, vectors=taken(self.kept.vectors, trials), normals=taken(self.kept.normals, trials))
        push = None if self.push is None else replace(self.push, point=taken(self.push.point, trials))
        places = tuple(place.of(trials) for place in self.places)
        return replace(self, places=places, kept=kept, first=taken(self.first, trials), push=push)

    def place(self, pose: tuple[Array, ...], tangents: Array | None) -> Place:
        """Offsets and clearances at a pose, rows by motions (6, freedoms, n), or nominal ones."""
        turn, shift, bolts = pose
        at, trials = Pose(turn, shift), shift.shape[1]
        offsets, clearances = np.zeros((len(self.places), 2, trials)), np.empty((len(self.places), trials))
        rows = self.rows if tangents is None else np.zeros((*self.rows.shape[:3], trials))
        for k, place in enumerate(self.places):
            clearances[k], seen = place.seen(at, bolts)
            for c, own in enumerate(seen):
                offsets[k, c] = own.offset
                if tangents is None:
                    continue
                moment = cross(own.arm, own.force)
                moment = (moment if own.moment is None else moment + own.moment) / self.reach
                for f in range(self.parts):
                    rows[k, c, f] = dot(moment, tangents[:3, f]) + dot(own.force, tangents[3:, f])
                if own.bolt is not None and isinstance(place, BoltInHole):
                    first = self.parts + ENDS * place.number
                    rows[k, c, first : first + ENDS] = own.bolt
        return Place(offsets, clearances, rows)

    def tangents(self, pose: tuple[Array, ...]) -> Array:
        """Motions (6, freedoms, n) that keep the relations at a pose, to LEFT.

        The nominal ones nearly do; their error is undone by nominal steps, each reducing it by the turn.
        """
        kept, (turn, shift, _) = self.kept, pose
        if not len(kept.shifts) or not self.parts:
            return self.steps
        found, rows = np.repeat(self.steps, shift.shape[1], axis=2), np.empty((len(kept.shifts), 6, shift.shape[1]))
        for own, vector, normal, by_shift in zip(rows, kept.vectors, kept.normals, kept.shifts, strict=True):
            own[:3], own[3:] = cross(rotated(turn, vector), normal) / self.reach, by_shift * normal
        go, before = np.ones(shift.shape[1], dtype=bool), np.full(shift.shape[1], np.inf)
        while go.any():
            changes = np.stack([dot(row[:3, None], found[:3]) + dot(row[3:, None], found[3:]) for row in rows])
            undone = times(self.undo, changes.reshape(len(rows), -1)).reshape(found.shape)
            found, largest = found - np.where(go, undone, 0.0), np.abs(changes).max(axis=(0, 1))
            go, before = go & (largest > LEFT) & (largest < before), largest
        return found

    def moved(self, pose: tuple[Array, ...], tangents: Array, steps: Array) -> tuple[Array, ...]:
        """A pose after steps (unknowns, n), as finite motions after which relations are met again."""
        turn, shift, bolts = pose
        motion = sum((tangents[:, f] * steps[f] for f in range(self.parts)), np.zeros((6, steps.shape[1])))
        turn, shift = self._stepped(turn, shift, motion)
        go = np.ones(shift.shape[1], dtype=bool)
        for _ in range(TIMES if len(self.first) else 0):
            changes = self.kept_at(turn, shift) - self.first
            undone = -np.where(go, times(self.undo, changes), 0.0)
            turn, shift = self._stepped(turn, shift, undone)
            go = go & (np.abs(undone).max(axis=0) / self.reach > MET)
            if not go.any():
                break
        return turn, shift, bolts + steps[self.parts :].reshape(bolts.shape)

    def kept_at(self, turn: Array, shift: Array) -> Array:
        """Quantities that relations keep, n . (R p + s t), at a pose (kept, n)."""
        kept, found = self.kept, np.empty((len(self.kept.shifts), shift.shape[1]))
        for own, vector, normal, by_shift in zip(found, kept.vectors, kept.normals, kept.shifts, strict=True):
            own[:] = dot(normal, rotated(turn, vector) + by_shift * shift)
        return found

    def _stepped(self, turn: Array, shift: Array, step: Array) -> tuple[Array, Array]:
        by = step[:3] / self.reach
        return turned_by(turn, by), shift + step[3:]

    def goal(self, pose: tuple[Array, ...], tangents: Array | None) -> Array:
        """Direction of length 1 in which the part goes to the limit (unknowns, n or 1).

        Where motions are nominal, so is the arm of a point: by that of the pose a turn that leaves the point where it
        is would count as a way on.
        """
        push = self.push
        assert push is not None
        along = push.along[:, None]
        if tangents is not None and push.force.any():
            force = column(push.force)
            moment = cross(rotated(pose[0], push.point), force) / self.reach
            along = np.stack([dot(moment, swapax[:3]) + dot(force, swapax[3:]) for swapax in tangents.swapaxes(0, 1)])
        found, square = np.zeros((self.rows.shape[2], along.shape[1])), np.zeros(along.shape[1])
        for own in along:
            square += own * own
        found[: self.parts] = along / np.sqrt(np.where(square > 0.0, square, 1.0))
        return found

    def unturned(self, pose: tuple[Array, ...], place: Place) -> Place:
        """The same with offsets in the axes that holes have nominally."""
        assert self.push is not None
        at, turn = Pose(pose[0], pose[1]), self.push.turn[:, :, None]
        its = [own.unturned(at, turn, offsets) for own, offsets in zip(self.places, place.offsets, strict=True)]
        return place._replace(offsets=np.stack(its))

    def way(self, place: Place, along: Array) -> Array:
        """Largest step along directions of the part (freedoms, n), until an offset is as long as its clearance.

        With bolts: until one of them no longer fits. 0 where none does.
        """
        bolt_of = np.array([own.number if isinstance(own, BoltInHole) else -1 for own in self.places])
        pins, far = Place(*(own[bolt_of < 0] for own in place)), np.full(along.shape[1], np.inf)
        way = way_along(pins, along) if len(pins.clearances) else far
        for number in range(bolt_of.max(initial=-1) + 1):
            its = Place(*(own[bolt_of == number] for own in place))
            first = self.parts + ENDS * number
            limit = bolt_way(its, its.rows[:, :, first : first + ENDS], along)
            way = np.where(limit < way, limit, way)
        return np.where(np.isfinite(way), way, 0.0)
