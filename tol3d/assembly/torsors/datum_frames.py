"""Datum frames: how far a part's datums, in their order, displace the frame that they make."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.model import Axis, Datum, DatumFrame, Feature, Plane, Point, RoundPlane, Slot
from tol3d.assembly.torsors.columns import Columns
from tol3d.assembly.torsors.freedoms import Freedoms
from tol3d.assembly.torsors.torsor import height_at, perpendicular, shift_at, torsor_of, turn_about
from tol3d.errors import InputError

Array = NDArray[np.float64]

NEARER = 1e-6
"""Lever [mm] that is none: a slot whose end lies on the axis of the turn is held by its place."""

Displaced = tuple[Feature, Array]
"""A feature and its torsor (6, columns), in the part's frame."""


def displacement_of(frame: DatumFrame, datums: Sequence[Sequence[Displaced]], columns: Columns) -> Array:
    """The torsor (6, columns) of a datum frame, in the part's frame.

    Args:
        frame: which.
        datums: the features of each of its datums.
        columns: of the assembly; contact adds its own.

    Raises:
        InputError: a datum takes no freedom.
    """
    freedoms = _without_any(datums, columns)
    for datum, features in zip(frame.datums, datums, strict=True):
        before = freedoms.count
        _take(freedoms, datum, features, columns)
        if freedoms.count == before:
            raise InputError(
                f"datum frame {frame.name}: {'-'.join(datum.features)} takes no freedom: datums before it hold all "
                "that it asks; leave it out"
            )
    return freedoms.rest()


def kept_by(frame: DatumFrame, datums: Sequence[Sequence[Displaced]], columns: Columns, count: int) -> Freedoms:
    """What the first datums of a frame hold, and leave; see `displacement_of`."""
    freedoms = _without_any(datums, columns)
    for datum, features in zip(frame.datums[:count], datums[:count], strict=True):
        _take(freedoms, datum, features, columns)
    return freedoms


def _without_any(datums: Sequence[Sequence[Displaced]], columns: Columns) -> Freedoms:
    centres = [feature.frame[:3, 3] for features in datums for feature, _ in features]
    return Freedoms(np.zeros(3), centres, columns.count)


def _take(freedoms: Freedoms, datum: Datum, features: Sequence[Displaced], columns: Columns) -> None:
    """What a datum holds, and the turn to it, about its centre: of two the middle between them."""
    (feature, torsor), *others = features
    if others:
        _take_line(freedoms, (feature, torsor), others[0])
    else:
        _take_one(freedoms, datum, feature, torsor, columns)
    freedoms.settle(np.mean([own.frame[:3, 3] for own, _ in features], axis=0))


def _take_one(freedoms: Freedoms, datum: Datum, feature: Feature, torsor: Array, columns: Columns) -> None:
    match feature.shape:
        case Slot() as slot:
            _take_slot(freedoms, slot, feature.frame, torsor)
        case Plane() | RoundPlane():
            _take_plane(freedoms, datum, feature, torsor, columns)
        case Axis():
            _take_axis(freedoms, feature.frame[:3, 3], feature.frame[:3, :2].T, torsor)
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
    """How far the outermost corner stands out of the material over the centre (columns,), of a plane that is tilted.

    Args:
        feature: the plane.
        tilt: turns about its x and y (2, columns), from the plane that it touches to itself.
        columns: to which the largest of its corners is added.
    """
    about_x, about_y = tilt
    if isinstance(feature.shape, RoundPlane):
        return columns.largest(feature.shape.radius * tilt[None])
    assert isinstance(feature.shape, Plane)
    along_x, along_y = feature.shape.reach  # opposite corners stand out and in by the same
    return columns.largest(np.array([[along_y * about_x - along_x * about_y], [along_y * about_x + along_x * about_y]]))


def _take_axis(freedoms: Freedoms, centre: Array, across: Array, torsor: Array) -> None:
    aside = across @ shift_at(centre)
    freedoms.take(aside, aside @ torsor)
    turns = turn_about(across)
    freedoms.take(turns, turns @ torsor)


def _take_line(freedoms: Freedoms, first: Displaced, second: Displaced) -> None:
    """A common datum: the line through the centres of two features."""
    ends = [feature.frame[:3, 3] for feature, _ in (first, second)]
    shifts = [shift_at(end) @ torsor for end, (_, torsor) in zip(ends, (first, second), strict=True)]
    middle, apart = (ends[0] + ends[1]) / 2.0, ends[1] - ends[0]
    turn = np.cross(apart, shifts[1] - shifts[0], axisb=0, axisc=0) / (apart @ apart)
    torsor = torsor_of(middle, (shifts[0] + shifts[1]) / 2.0, turn)
    _take_axis(freedoms, middle, perpendicular(apart / np.linalg.norm(apart)), torsor)
