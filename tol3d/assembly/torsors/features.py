"""Torsors of a part's features and datum frames, in the part's frame."""

from collections.abc import Sequence

import numpy as np

from tol3d.assembly.model import (
    Axis,
    Cone,
    Contribution,
    Datum,
    DatumFrame,
    Feature,
    Part,
    Plane,
    Point,
    RoundPlane,
    Slot,
)
from tol3d.assembly.model.feature import Shape
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
    (feature, torsor), *others = features
    if datum.simulator == "pattern":
        _take_pattern(freedoms, features)
    elif others:
        _take_line(freedoms, features)
    else:
        _take_one(freedoms, datum, feature, torsor, columns)
    freedoms.settle(np.mean([own.frame[:3, 3] for own, _ in features], axis=0))


def _take_one(freedoms: Freedoms, datum: Datum, feature: Feature, torsor: Array, columns: Columns) -> None:
    match feature.shape:
        case Slot() as slot:
            _take_slot(freedoms, slot, feature.frame, torsor)
        case Plane() | RoundPlane():
            _take_plane(freedoms, datum, feature, torsor, columns)
        case Axis() as axis:
            _take_axis(freedoms, feature.frame[:3, 3], feature.frame[:3, :2].T, torsor, whole=isinstance(axis, Cone))
        case Point():
            position = shift_at(feature.frame[:3, 3])
            freedoms.take(position, position @ torsor)


def _take_slot(freedoms: Freedoms, slot: Slot, frame: Array, torsor: Array) -> None:
    """The median plane of a slot or tab, on which walls close in about its nominal place.

    They leave the smallest of |height of its middle| + |rise along x| + |rise along y|, that of its corners. Where one
    motion alone is left, which moves all three in proportion, the one that it moves most becomes 0: the height, or the
    rises together. Otherwise its direction is met by turns, then its height.
    """
    height = height_at(frame[:3, 3], frame[:3, 2])
    turns = turn_about(frame[:3, :2].T)
    moved = np.concatenate([height, turns]) @ freedoms.left
    about_x, about_y = np.abs(moved[1:]).max(axis=1, initial=0.0)
    by_place = np.abs(moved[0]).max(initial=0.0) > slot.reach[1] * about_x + slot.reach[0] * about_y - NEARER
    order = (height, turns) if by_place and np.linalg.matrix_rank(moved, tol=NEARER) == 1 else (turns, height)
    for equations in order:
        freedoms.take(equations, equations @ torsor)


def _take_plane(freedoms: Freedoms, datum: Datum, feature: Feature, torsor: Array, columns: Columns) -> None:
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
        values = values + _outermost(feature, turns @ (torsor - freedoms.torsor), columns)
    freedoms.take(height, values)


def _outermost(feature: Feature, tilt: Array, columns: Columns) -> Array:
    """Height of a tilted plane's outermost corner over the centre, out of the material (columns,).

    Args:
        feature: the plane.
        tilt: turns about its x and y (2, columns), from the plane that it touches to itself.
        columns: extended by the maximum over its corners.
    """
    about_x, about_y = tilt
    if isinstance(feature.shape, RoundPlane):
        return columns.largest(feature.shape.radius * tilt[None])
    along_x, along_y = feature.shape.reach  # opposite corners stand out and in by the same amount
    return columns.largest(np.array([[along_y * about_x - along_x * about_y], [along_y * about_x + along_x * about_y]]))


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
        own = from_components(feature.shape) @ summed(feature.moved_by, len(feature.shape.components), self._columns)
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
            its = [(self._features[own.feature], self.feature(own.feature)) for own in rooms]
            later = [(own, *datums[frame.datums.index(own)][0]) for own in frame.later]
            self._rooms[name] = gauges_room(rooms, its, kept, self.size, self._columns, later, name)
        return self._rooms[name]

    def _datums(self, frame: DatumFrame) -> list[list[Displaced]]:
        return [[(self._features[each], self.feature(each)) for each in datum.features] for datum in frame.datums]

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


def from_components(shape: Shape) -> Array:
    """(6, components): the components of a shape -> its torsor, in the feature's frame.

    A plane's height is w + alpha y - beta x, with its rises at the ends of x and y; an axis passes both its ends.
    """
    match shape:
        case Point():
            return np.eye(6)[:, :3]
        case Plane() | RoundPlane():
            along_x, along_y = shape.reach
            torsor = np.zeros((6, 3))
            torsor[2, 0] = 1.0
            torsor[3, 2] = 1.0 / along_y
            torsor[4, 1] = -1.0 / along_x
            return torsor
        case Axis():
            torsor = np.zeros((6, len(shape.components)))
            torsor[[0, 1], [0, 1]] = torsor[[0, 1], [2, 3]] = 0.5
            torsor[4, [0, 2]] = -1.0 / shape.length, 1.0 / shape.length
            torsor[3, [1, 3]] = 1.0 / shape.length, -1.0 / shape.length
            torsor[2, 4:] = 1.0  # of a cone, along
            return torsor
