"""Torsors of a part's features and datum frames, in the part's frame."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.model import Axis, Contribution, DatumFrame, Part, Plane, Point, RoundPlane
from tol3d.assembly.model.shape import Shape
from tol3d.assembly.torsors.columns import Columns
from tol3d.assembly.torsors.datum_frames import Displaced, displacement_of, kept_by
from tol3d.assembly.torsors.gauges import GaugesRoom, gauges_room
from tol3d.assembly.torsors.torsor import seen_from

Array = NDArray[np.float64]


class PartTorsors:
    """What a part's features and datum frames are displaced by, in the part's frame.

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

        It is not kept: most are asked for once, and those of thousands of features would fill the memory.
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

    def gauges(self, name: str) -> GaugesRoom:
        """The room of the gauges of a datum frame."""
        if name not in self._rooms:
            frame = self._frames[name]
            assert frame.gauges is not None
            rooms, datums = frame.gauges.rooms, self._datums(frame)
            kept = kept_by(frame, datums, self._columns, len(datums) - len(rooms))
            its = [(self._features[own.feature], self.feature(own.feature)) for own in rooms]
            self._rooms[name] = gauges_room(rooms, its, kept, self.size, self._columns)
        return self._rooms[name]

    def _datums(self, frame: DatumFrame) -> list[list[Displaced]]:
        return [[(self._features[each], self.feature(each)) for each in datum.features] for datum in frame.datums]

    def size(self, name: str) -> Array:
        """How much larger a feature is (columns,) [mm]."""
        return np.asarray(summed(self._features[name].size_by, 1, self._columns)[0])


def summed(contributions: Sequence[Contribution], components: int, columns: Columns) -> Array:
    """What contributors do together to components (components, columns)."""
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
            torsor = np.zeros((6, 4))
            torsor[[0, 1], [0, 1]] = torsor[[0, 1], [2, 3]] = 0.5
            torsor[4, [0, 2]] = -1.0 / shape.length, 1.0 / shape.length
            torsor[3, [1, 3]] = 1.0 / shape.length, -1.0 / shape.length
            return torsor
