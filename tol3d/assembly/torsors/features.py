"""Torsors of a part's features and datum frames, in the part's frame."""

from collections.abc import Sequence
from functools import singledispatch

import numpy as np

from tol3d.assembly.model import Axis, Contribution, Datum, DatumFrame, Feature, Part, Slot
from tol3d.assembly.model.feature import Facts, Flat
from tol3d.assembly.torsors.columns import Columns
from tol3d.assembly.torsors.freedoms import Freedoms
from tol3d.assembly.torsors.gauges import GaugesRoom, gauges_room
from tol3d.assembly.torsors.torsor import height_at, perpendicular, seen_from, shift_at, torsor_of, turn_about
from tol3d.errors import InputError
from tol3d.numerics.arrays import Array

NEARER = 1e-6
"""Lever [mm] that counts as none: a slot whose end lies on the axis of the turn is held by its place."""

Displaced = tuple[Feature, Array]
"""A feature and its torsor (6, columns), in the part's frame."""


def displacement_of(frame: DatumFrame, datums: Sequence[Sequence[Displaced]], columns: Columns) -> Array:
    """The torsor (6, columns) of a datum frame, in the part's frame.

    Args:
        frame: the datum frame.
        datums: the features of each of its datums.
        columns: of the assembly; contact adds its own.

    Raises:
        InputError: a datum takes no freedom.
    """
    freedoms = _without_any(datums, columns)
    for datum, features in zip(frame.datums, datums, strict=True):
        before = freedoms.count
        _take(freedoms, datum, features, columns)
        if freedoms.count == before and datum not in frame.later:  # which take from the room of the gauges
            raise InputError(
                f"datum frame {frame.name}: {'-'.join(datum.features)} takes no freedom: datums before it hold all "
                "that it asks; leave it out"
            )
    return freedoms.rest()


def kept_by(frame: DatumFrame, datums: Sequence[Sequence[Displaced]], columns: Columns, count: int) -> Freedoms:
    """Freedoms held by the first datums of a frame, and those left; see `displacement_of`."""
    freedoms = _without_any(datums, columns)
    for datum, features in zip(frame.datums[:count], datums[:count], strict=True):
        _take(freedoms, datum, features, columns)
    return freedoms


def _without_any(datums: Sequence[Sequence[Displaced]], columns: Columns) -> Freedoms:
    centres = [feature.frame[:3, 3] for features in datums for feature, _ in features]
    return Freedoms(np.zeros(3), centres, columns.count)


def _take(freedoms: Freedoms, datum: Datum, features: Sequence[Displaced], columns: Columns) -> None:
    """Take what a datum holds, and the turn to it, about its centre: of several the middle of theirs."""
    if datum.simulator == "pattern":
        _take_pattern(freedoms, features)
    elif len(features) > 1:
        _take_line(freedoms, features)
    else:
        _take_one(features[0][0].shape, freedoms, datum, features[0], columns)
    freedoms.settle(np.mean([own.frame[:3, 3] for own, _ in features], axis=0))


@singledispatch
def _take_one(shape: Facts, freedoms: Freedoms, datum: Datum, displaced: Displaced, columns: Columns) -> None:
    """Take what a datum of one feature holds, by its shape; here a point."""
    feature, torsor = displaced
    position = shift_at(feature.frame[:3, 3])
    freedoms.take(position, position @ torsor)


@_take_one.register
def _(shape: Axis, freedoms: Freedoms, datum: Datum, displaced: Displaced, columns: Columns) -> None:
    feature, torsor = displaced
    _take_axis(freedoms, feature.frame[:3, 3], feature.frame[:3, :2].T, torsor, whole="along" in shape.components)


@_take_one.register
def _(shape: Slot, freedoms: Freedoms, datum: Datum, displaced: Displaced, columns: Columns) -> None:
    """The median plane of a slot or tab, on which walls close in about its nominal place.

    They leave the smallest of |height of its middle| + |rise along x| + |rise along y|, that of its corners. Where one
    motion alone is left, which moves all three in proportion, the one that it moves most becomes 0: the height, or the
    rises together. Otherwise its direction is met by turns, then its height.
    """
    frame, torsor = displaced[0].frame, displaced[1]
    height = height_at(frame[:3, 3], frame[:3, 2])
    turns = turn_about(frame[:3, :2].T)
    moved = np.concatenate([height, turns]) @ freedoms.left
    about_x, about_y = np.abs(moved[1:]).max(axis=1, initial=0.0)
    by_place = np.abs(moved[0]).max(initial=0.0) > shape.reach[1] * about_x + shape.reach[0] * about_y - NEARER
    order = (height, turns) if by_place and np.linalg.matrix_rank(moved, tol=NEARER) == 1 else (turns, height)
    for equations in order:
        freedoms.take(equations, equations @ torsor)


@_take_one.register
def _(shape: Flat, freedoms: Freedoms, datum: Datum, displaced: Displaced, columns: Columns) -> None:
    feature, torsor = displaced
    normal, centre = feature.frame[:3, 2], feature.frame[:3, 3]
    if datum.simulator == "targets" and datum.targets is not None:
        for target in datum.targets:
            height = height_at(feature.frame[:3, :3] @ target + centre, normal)
            freedoms.take(height, height @ torsor)
        return
    turns = turn_about(feature.frame[:3, :2].T)
    freedoms.take(turns, turns @ torsor)
    height = height_at(centre, normal)
    if freedoms.holds(height):
        return
    values = height @ torsor
    if datum.simulator == "contact":
        values = values + _outermost(shape, turns @ (torsor - freedoms.torsor), columns)
    freedoms.take(height, values)


def _outermost(shape: Flat, tilt: Array, columns: Columns) -> Array:
    """Height of a tilted plane's outermost point over the centre, out of the material (columns,).

    Args:
        shape: of the plane.
        tilt: turns about its x and y (2, columns), from the plane that it touches to itself.
        columns: extended by the maximum over its corners or rim.
    """
    rises = np.array([-shape.reach[0] * tilt[1], shape.reach[1] * tilt[0]])
    return columns.largest(shape.rim @ rises)


def _take_axis(freedoms: Freedoms, centre: Array, across: Array, torsor: Array, *, whole: bool = False) -> None:
    """An axis, or a cone, which is held as a whole: along itself too."""
    aside = shift_at(centre) if whole else across @ shift_at(centre)
    freedoms.take(aside, aside @ torsor)
    turns = turn_about(across)
    freedoms.take(turns, turns @ torsor)


def _take_line(freedoms: Freedoms, features: Sequence[Displaced]) -> None:
    """A common datum: the line through the centres of two features, or of more by least squares.

    Of more, the turn is the slope of the regression of their shifts across the line on their places along it.
    """
    ends = [feature.frame[:3, 3] for feature, _ in features]
    shifts = [shift_at(end) @ torsor for end, (_, torsor) in zip(ends, features, strict=True)]
    middle, apart = (ends[0] + ends[-1]) / 2.0, ends[-1] - ends[0]
    if len(features) > 2:
        middle = np.mean(ends, axis=0)
        arms = [end - middle for end in ends]
        turns = [np.cross(arm, shift, axisb=0, axisc=0) for arm, shift in zip(arms, shifts, strict=True)]
        turn = np.sum(turns, axis=0) / sum(float(arm @ arm) for arm in arms)
        torsor = torsor_of(middle, np.mean(shifts, axis=0), turn)
        _take_axis(freedoms, middle, perpendicular(apart / np.linalg.norm(apart)), torsor)
        return
    turn = np.cross(apart, shifts[1] - shifts[0], axisb=0, axisc=0) / (apart @ apart)
    torsor = torsor_of(middle, (shifts[0] + shifts[1]) / 2.0, turn)
    _take_axis(freedoms, middle, perpendicular(apart / np.linalg.norm(apart)), torsor)


def _take_pattern(freedoms: Freedoms, features: Sequence[Displaced]) -> None:
    """A pattern: least squares of what its places are off, of each feature where and as its position is judged."""
    rows, values = [], []
    for feature, torsor in features:
        turn, shape = feature.frame[:3, :3], feature.shape
        sides = turn.T[shape.located]
        for end in shape.ends:
            rows.append(sides @ shift_at(turn @ end + feature.frame[:3, 3]))
            values.append(rows[-1] @ torsor)
    freedoms.take(np.concatenate(rows), np.concatenate(values))


class PartTorsors:
    """Displacements of a part's features and datum frames, in the part's frame.

    Args:
        part: its model.
        columns: of its assembly.
    """

    def __init__(self, part: Part, columns: Columns) -> None:
        self._columns = columns
        self._features = {feature.name: feature for feature in part.features}
        self._frames = {frame.name: frame for frame in part.datum_frames}
        self._displacements: dict[str, Array] = {}
        self._rooms: dict[str, GaugesRoom] = {}

    def feature(self, name: str) -> Array:
        """The torsor (6, columns) of a feature: of the datum frame to which it is toleranced, and its own.

        It is not cached: most are needed once, and those of thousands of features would fill the memory.
        """
        feature = self._features[name]
        shape = feature.shape
        own = np.vstack([shape.origin_by, shape.turn_by])  # of its components: its torsor, in its frame
        own = own @ summed(feature.moved_by, len(shape.components), self._columns)
        own[:3] += summed(feature.grown_by, 3, self._columns)
        return self.datum_frame(feature.parent) + seen_from(feature.frame) @ own

    def datum_frame(self, name: str) -> Array:
        """The torsor (6, columns) of a datum frame; 0 for "", the part's own."""
        if not name:
            return self._columns.zeros(6)
        if name not in self._displacements:
            frame = self._frames[name]
            found = displacement_of(frame, self._datums(frame), self._columns)
            if frame.gauges is not None and frame.gauges.floating is not None:
                found = self.gauges(name).displacement(frame.gauges.floating, self._columns)
            found[:3] += summed(frame.shifted_by, 3, self._columns)
            self._displacements[name] = found
        return self._displacements[name]

    def left_by(self, name: str) -> Array:
        """Directions (3, turns) about which the datums of a frame let the part turn; all for "", the part's frame."""
        if not name:
            return np.eye(3)
        frame = self._frames[name]
        left = kept_by(frame, self._datums(frame), self._columns, len(frame.datums)).left
        ways, sizes, _ = np.linalg.svd(left[3:])
        return np.asarray(ways[:, : int(np.sum(sizes > NEARER * np.abs(left).max(initial=0.0)))])

    def gauges(self, name: str) -> GaugesRoom:
        """The play of the gauges of a datum frame."""
        if name not in self._rooms:
            frame = self._frames[name]
            assert frame.gauges is not None
            rooms, datums = frame.gauges.rooms, self._datums(frame)
            kept = kept_by(frame, datums, self._columns, frame.regardless)
            its = [(self._features[room.feature], self.feature(room.feature)) for room in rooms]
            later = [(own, *datums[frame.datums.index(own)][0]) for own in frame.later]
            self._rooms[name] = gauges_room(rooms, its, kept, self.size, self._columns, later, name)
        return self._rooms[name]

    def _datums(self, frame: DatumFrame) -> list[list[Displaced]]:
        return [
            [(self._features[feature], self.feature(feature)) for feature in datum.features] for datum in frame.datums
        ]

    def size(self, name: str) -> Array:
        """Deviation of a feature's size (columns,) [mm]."""
        return np.asarray(summed(self._features[name].size_by, 1, self._columns)[0])

    def mating_size(self, name: str) -> Array:
        """Deviation of the size of a feature that a fit sees (columns,) [mm]."""
        return np.asarray(summed(self._features[name].mating_by, 1, self._columns)[0])


def summed(contributions: Sequence[Contribution], components: int, columns: Columns) -> Array:
    """Summed effect of contributors on components (components, columns)."""
    total = columns.zeros(components)
    for contribution in contributions:
        total[:, contribution.columns] += contribution.matrix
    return total
