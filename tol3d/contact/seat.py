"""Finite poses of a part within its clearances: centred, pushed to the limit, or some of the way along a ray.

A programme is one of small displacements. Its step is made as a finite motion, relations are met again, and offsets,
clearances and their changes are found anew, until nothing moves: there the conditions of the programme's optimum are
those of the finite one. What lies at a pose is asked of a `Room`, which alone knows of features.
"""

from dataclasses import dataclass
from typing import Final, NamedTuple, Protocol, Self

import numpy as np
from numpy.typing import NDArray

from tol3d.contact.programme import Programme
from tol3d.numerics.arrays import Array, Places

ROUNDS: Final = 40
"""Corrections of a pose at most, 2 or 3 in practice; each leaves a turn's share of the correction."""
MET: Final = 1e-10
"""Residual [mm] predicted from the ratio of two steps, at which a trial is done."""
TURNED: Final = 1e-5
"""Step, per mm of reach, after which the motions that keep the relations are found anew."""
LOST: Final = 1e-6
"""Step [mm] left after all rounds at which the pose counts as not found."""
NONE: Final = 1e-300
"""Step before the first."""

Pose = tuple[Array, ...]
"""Poses of a part and its bolts, in arrays with the trial last."""


class Place(NamedTuple):
    """Offsets o_k (places, 2, n), clearances c_k (places, n) and rows B_k (places, 2, unknowns, n or 1) at a pose."""

    offsets: Array
    clearances: Array
    rows: Array


class Room(Protocol):
    """Places in some trials, and motions that keep the part's relations."""

    @property
    def parts(self) -> int:
        """Number of the first unknowns that are the part's."""
        ...

    @property
    def reach(self) -> float:
        """Length over which a turn counts [mm]."""
        ...

    @property
    def steps(self) -> Array:
        """Nominal motions, turn times reach and shift (6, parts, 1)."""
        ...

    @property
    def rows(self) -> Array:
        """Nominal change of offsets by the unknowns (places, 2, unknowns, 1)."""
        ...

    def of(self, trials: Places) -> Self:
        """The same in some of its trials."""
        ...

    def place(self, pose: Pose, tangents: Array | None) -> Place:
        """Offsets and clearances at a pose, rows by motions (6, parts, n), or nominal ones."""
        ...

    def tangents(self, pose: Pose) -> Array:
        """Motions (6, parts, n) that keep the relations at a pose."""
        ...

    def moved(self, pose: Pose, tangents: Array, steps: Array) -> Pose:
        """A pose after steps (unknowns, n), as finite motions that keep the relations."""
        ...

    def goal(self, pose: Pose, tangents: Array | None) -> Array:
        """Direction of length 1 in which the part goes to the limit (unknowns, n or 1); nominal without tangents."""
        ...

    def unturned(self, pose: Pose, place: Place) -> Place:
        """The same with offsets in the axes that holes have nominally."""
        ...

    def way(self, place: Place, along: Array) -> Array:
        """Largest step along directions of the part (parts, n), until a clearance ends (n,); 0 where none does."""
        ...


@dataclass(frozen=True, eq=False)
class Seated:
    """Poses found.

    Args:
        pose: of all trials; where none is found the last one.
        found: trials that rest (n,).
        place: before the last step, which is shorter than LOST; if it is kept.
    """

    pose: Pose
    found: NDArray[np.bool_]
    place: Place | None


@dataclass(frozen=True, eq=False)
class _Going:
    """Trials that do not rest yet: their numbers, places, poses, motions, last steps [mm] and ways so far [mm]."""

    trials: Places
    room: Room
    pose: Pose
    tangents: Array
    previous: Array
    gone: Array

    def of(self, which: NDArray[np.bool_]) -> "_Going":
        """Some of them."""
        if which.all():
            return self
        own = np.flatnonzero(which)
        pose = tuple(np.take(array, own, axis=-1) for array in self.pose)
        return _Going(
            self.trials[own], self.room.of(own), pose, taken(self.tangents, own), self.previous[own], self.gone[own]
        )


def taken(array: Array, trials: Places) -> Array:
    """Some trials of an array (…, n); all of one that they share (…, 1)."""
    return array if array.shape[-1] == 1 else np.take(array, trials, axis=-1)


def _begun(room: Room, pose: Pose, asked: NDArray[np.bool_], keeps_place: bool) -> tuple[_Going, Seated]:
    """Trials at their first pose, and arrays for what is found."""
    count = pose[0].shape[-1]
    start = _Going(np.arange(count), room, pose, room.steps, np.full(count, NONE), np.zeros(count))
    made, (places, _, unknowns, _) = tuple(own.copy() for own in pose), room.rows.shape
    at = np.empty((places, 2, count)), np.empty((places, count)), np.empty((places, 2, unknowns, count))
    return start.of(asked), Seated(made, np.zeros(count, dtype=np.bool_), Place(*at) if keeps_place else None)


def seated(
    room: Room, start: Pose, programme: Programme, asked: NDArray[np.bool_], *, pushes: bool = False,
    keeps_place: bool = False,
) -> Seated:  # fmt: skip
    """Stationary poses of all trials, centred or pushed to the limit.

    Where the first round of the nominal programme leaves freedoms open, rows stay nominal: what those of the pose would
    gain along them is of second order, and a part would swing through its clearance for it. A push is then nominal too,
    and offsets are in the axes that holes have nominally.

    Args:
        room: the places.
        start: nearby poses.
        programme: of the pose before; changed to that of the last pose.
        asked: mask of the trials (n,); the others are left where they are.
        pushes: True for the limit of the room's goal.
        keeps_place: True to keep the place at the last pose.
    """
    going, made = _begun(room, start, asked, keeps_place)
    groups = [(going, True, 0)]
    while groups:
        going, nominal, count = groups.pop()
        on = _solved(made, going, nominal, count, programme, pushes)
        if count == 0:
            is_open = programme.left[on.trials] > 0
            groups += [(on.of(which), which is is_open, 1) for which in (is_open, ~is_open) if which.any()]
        elif len(on.trials) and count + 1 < ROUNDS:
            groups.append((on, nominal, count + 1))
    return made


def _solved(made: Seated, going: _Going, nominal: bool, count: int, programme: Programme, pushes: bool) -> _Going:
    """The trials that do not rest after one more step, which all make."""
    room, trials, tangents = going.room, going.trials, going.tangents
    if not nominal:
        tangents = _tangents(going, (count == 1) | (going.previous > TURNED * room.reach))
    place, goal = room.place(going.pose, None if nominal else tangents), None
    if pushes:
        goal = room.goal(going.pose, None if nominal else tangents)
        place = room.unturned(going.pose, place) if nominal else place
    programme.solve(*place, goal=goal, parts=room.parts, trials=trials)
    found = programme.found[trials]
    steps = np.where(found, np.take(programme.steps, trials, axis=-1), 0.0)
    size = np.abs(steps[: room.parts]).max(axis=0, initial=0.0)
    ends = size * np.minimum(1.0, size / going.previous) <= MET
    ends &= np.abs(steps[room.parts :]).max(axis=0, initial=0.0) < LOST  # bolts may still move
    pose = room.moved(going.pose, tangents, steps)
    _note(made, trials, pose, place, found & (ends | ((count + 1 == ROUNDS) & (size < LOST))))
    after = _Going(trials, room, pose, tangents, np.maximum(size, NONE), going.gone)
    return after.of(found & ~ends)


def _tangents(going: _Going, turned: NDArray[np.bool_]) -> Array:
    """Motions that keep the relations, found anew where parts have turned."""
    if turned.all():
        return going.room.tangents(going.pose)
    own, tangents = np.flatnonzero(turned), going.tangents
    if len(own) and tangents.shape[-1] == len(turned):
        tangents = tangents.copy()
        poses = tuple(np.take(array, own, axis=-1) for array in going.pose)
        tangents[..., own] = going.room.of(own).tangents(poses)
    return tangents


def _note(made: Seated, trials: Places, pose: Pose, place: Place, found: NDArray[np.bool_]) -> None:
    """Keep what is so far known of some trials."""
    known = zip((*made.pose, *(made.place or ())), (*pose, *(place if made.place else ())), strict=True)
    for own, array in known:
        own[..., trials] = array
    made.found[trials] = found


def strayed(room: Room, start: Pose, ray: Array, share: Array, asked: NDArray[np.bool_]) -> Seated:
    """Poses some of the way along rays, by which a part gets to the limit of its clearances.

    Args:
        room: the places.
        start: the poses where rays begin.
        ray: directions of the part's freedoms, of length 1 (parts, n).
        share: of the way (n,).
        asked: mask of the trials (n,); the others are left where they are.
    """
    going, made = _begun(room, start, asked, keeps_place=False)
    for count in range(ROUNDS):
        own, trials = going.room, going.trials
        tangents = own.tangents(going.pose) if count == 0 else going.tangents
        place, along = own.place(going.pose, tangents), np.take(ray, trials, axis=-1)
        more = own.way(place, along)
        gone, size = going.gone + more, np.abs(more)
        ends = size * np.minimum(1.0, size / going.previous) <= MET
        steps = np.zeros((place.rows.shape[2], len(trials)))
        if count == 0 and len(steps) > room.parts:
            ends[:] = False
        steps[: room.parts] = gone * along * np.where(ends, share[trials], 1.0)
        pose = own.moved(tuple(np.take(each, trials, axis=-1) for each in start), tangents, steps)
        _note(made, trials, pose, place, ends | ((count + 1 == ROUNDS) & (size < LOST)))
        going = _Going(trials, own, pose, tangents, np.maximum(size, NONE), gone).of(~ends)
        if not len(going.trials):
            break
    return made
