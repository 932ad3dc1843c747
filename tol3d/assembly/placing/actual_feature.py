"""Features as they are in a trial, in the frame of their part."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar, Final, Self

import numpy as np

from tol3d.assembly.model.feature import Axis, Cone, Contribution, Feature, Plane, Point, RoundPlane, Slot
from tol3d.assembly.placing.poses import Pose, dot, least_rotation, length, product, repeated, rotated, square_to, unit
from tol3d.numerics.arrays import Array

_Z = np.array([[0.0], [0.0], [1.0]])


def total(contributions: Sequence[Contribution], components: int, columns: Array) -> list[Array]:
    """Sum of contributions, component by component, (n,) or (1,) where nothing varies.

    Args:
        contributions: to be added in this order.
        components: their number.
        columns: the deviations, (width, n) [mm].
    """
    totals = [np.zeros(1) for _ in range(components)]
    for contribution in contributions:
        drawn = columns[contribution.columns]
        for row, weights in enumerate(contribution.matrix):
            for weight, values in zip(weights, drawn, strict=True):
                if weight:
                    totals[row] = totals[row] + weight * values
    return totals


@dataclass(frozen=True, eq=False)
class ActualFeature:
    """A feature in its trials, in the frame in which `base` has its nominal frame; as given here, a point.

    Args:
        feature: the feature.
        base: pose of its nominal frame as carried by its datum frame.
        centre: where its origin lies in that frame, (3, n) [mm].
        span: from its origin to its ends in that frame, each (3, n) [mm]: of an axis to its end, of a plane to where
            its reaches along x and y end, at the heights that it has there.
    """

    feature: Feature
    base: Pose
    centre: Array
    span: tuple[Array, ...]

    asked: ClassVar[tuple[str, ...]] = ()
    """Quantities that a datum after gauges asks, in order: of a slot or tab, on which walls close, all corners."""

    @classmethod
    def of(cls, feature: Feature, base: Pose, moved: Sequence[Array]) -> Self:
        """A feature by its shape's components, each (n,) [mm]."""
        return cls(feature, base, _vector(*moved), ())

    @cached_property
    def origin(self) -> Array:
        """Its origin (3, n) [mm]."""
        return self.base.point(self.centre)

    @cached_property
    def _tilted(self) -> Array:
        """z of its frame before the turn of `base` (3, n)."""
        return _Z

    @cached_property
    def direction(self) -> Array:
        """z of its frame (3, n), of unit length."""
        return rotated(self.base.turn, self._tilted)

    @cached_property
    def spans(self) -> tuple[Array, ...]:
        """As `span`, turned with the frame (3, n) [mm]."""
        return tuple(rotated(self.base.turn, span) for span in self.span)

    @cached_property
    def pose(self) -> Pose:
        """Its frame, with the least rotation from its nominal z."""
        if not self.span:
            return Pose(self.base.turn, self.origin)
        return Pose(product(self.base.turn, least_rotation(_Z, self._tilted)), self.origin)

    @property
    def ends(self) -> list[Array]:
        """Points at which its position is evaluated, each (3, n) [mm]; of a disc, the ends of its reaches."""
        return [self.origin]

    @property
    def axes(self) -> tuple[Array, ...]:
        """Directions across which it leaves play (3, n), as a hole or slot."""
        return (self.direction,)

    def moved(self, pose: Pose) -> "ActualFeature":
        """It in another frame, to which the pose takes its own."""
        return replace(self, base=pose @ self.base)

    def repeated(self, trials: int) -> "ActualFeature":
        """It in trials that follow each other several times."""
        span = tuple(repeated(own, trials) for own in self.span)
        return replace(self, base=self.base.repeated(trials), centre=repeated(self.centre, trials), span=span)

    def rise(self, direction: Array) -> Array:
        """Extent over its origin along a direction (3, n), in the frame of `base` [mm]."""
        return np.zeros(1)

    def at(self, target: Array) -> Array:
        """A point of a plane or an axis, stated in its frame (3,), as high or far aside as it is there (3, n) [mm]."""
        return self.base.point(self.centre + np.reshape(target, (3, 1)))

    def within(self, place: Array) -> Array:
        """The point of it as a hole or slot, at a place in its frame (3,), from which offsets of a pin or tab count."""
        return self.origin

    def seen(self, along: Array) -> tuple[Array, Array]:
        """Part of its size that a slot sees, and the change of that, by the cosine of their directions (n,)."""
        return np.abs(along), np.where(along > 0.0, 1.0, -1.0)

    def counted(self, aside: Array, z: Array) -> Array:
        """The part of an offset (3, n) that counts in its position, whose nominal z is (3, 1): of a point all of it."""
        return aside

    def farthest(self, frame: Array) -> Array:
        """The largest offset that counts of its ends from their places in a nominal frame (4, 4) (n,) [mm]."""
        found, z = np.zeros(1), frame[:3, 2:3]
        for end, place in zip(self.ends, self.feature.shape.ends, strict=True):
            aside = end - (frame[:3, :3] @ place + frame[:3, 3])[:, None]
            found = np.maximum(found, length(self.counted(aside, z)))
        return found

    def lean(self, z: Array) -> Array:
        """Width (n,) of the zone along a nominal z (3, 1) that holds its direction [mm]; 0 of a point."""
        return np.zeros(1)


class ActualAxis(ActualFeature):
    """An axis in its trials."""

    asked: ClassVar[tuple[str, ...]] = ("aside", "direction")

    @classmethod
    def of(cls, feature: Feature, base: Pose, moved: Sequence[Array]) -> Self:
        start_x, start_y, end_x, end_y, *along = moved
        (half,) = feature.shape.reach
        middle = _vector((start_x + end_x) / 2, (start_y + end_y) / 2, along[0] if along else 0.0)
        return cls(feature, base, middle, (_vector((end_x - start_x) / 2, (end_y - start_y) / 2, half),))

    @cached_property
    def _tilted(self) -> Array:
        return unit(self.span[0])

    @property
    def ends(self) -> list[Array]:
        return [self.origin - self.spans[0], self.origin + self.spans[0]]

    def rise(self, direction: Array) -> Array:
        return np.abs(dot(direction, self.spans[0]))

    def at(self, target: Array) -> Array:
        """See ActualFeature; of its two coordinates across none counts."""
        (half,) = self.feature.shape.reach
        return np.asarray(self.origin + target[2] / half * self.spans[0])

    @property
    def axes(self) -> tuple[Array, ...]:
        return self.pose.turn[:, 0], self.pose.turn[:, 1]

    def within(self, place: Array) -> Array:
        return self.at(place)

    def seen(self, along: Array) -> tuple[Array, Array]:
        share = np.sqrt(np.maximum(1.0 - along * along, 0.0))
        return share, np.where(share > 0.0, -along / np.where(share > 0.0, share, 1.0), 0.0)

    def counted(self, aside: Array, z: Array) -> Array:
        return square_to(aside, z)

    def lean(self, z: Array) -> Array:
        return 2.0 * length(square_to(self.spans[0], z))


class ActualPlane(ActualFeature):
    """A rectangle in its trials."""

    asked: ClassVar[tuple[str, ...]] = ("direction", "height")

    @classmethod
    def of(cls, feature: Feature, base: Pose, moved: Sequence[Array]) -> Self:
        (offset, rise_x, rise_y), (a, b) = moved, feature.shape.reach
        return cls(feature, base, _vector(0.0, 0.0, offset), (_vector(a, 0.0, rise_x), _vector(0.0, b, rise_y)))

    @cached_property
    def _tilted(self) -> Array:
        (a, b), (along_x, along_y) = self.feature.shape.reach, self.span
        return unit(np.stack(np.broadcast_arrays(-_slope(along_x[2], a), -_slope(along_y[2], b), np.ones(1))))

    @property
    def ends(self) -> list[Array]:
        x, y = self.spans
        return [self.origin + x + y, self.origin - x + y, self.origin - x - y, self.origin + x - y]

    def rise(self, direction: Array) -> Array:
        x, y = (np.abs(dot(direction, span)) for span in self.spans)
        return x + y

    def at(self, target: Array) -> Array:
        (a, b), (along_x, along_y) = self.feature.shape.reach, self.spans
        lifted = self.origin + _slope(1.0, a) * target[0] * along_x + _slope(1.0, b) * target[1] * along_y
        return np.asarray(lifted + target[2] * self.direction)

    def counted(self, aside: Array, z: Array) -> Array:
        return dot(aside, z) * z

    def lean(self, z: Array) -> Array:
        return 2.0 * self.rise(z)


class ActualSlot(ActualPlane):
    """A slot or tab in its trials."""

    asked: ClassVar[tuple[str, ...]] = ("corners",)


class ActualDisc(ActualPlane):
    """A disc in its trials."""

    @property
    def ends(self) -> list[Array]:
        x, y = self.spans
        return [self.origin + x, self.origin + y, self.origin - x, self.origin - y]

    def rise(self, direction: Array) -> Array:
        x, y = (np.abs(dot(direction, span)) for span in self.spans)
        return np.asarray(np.sqrt(x * x + y * y))

    def farthest(self, frame: Array) -> Array:
        z = frame[:3, 2:3]
        return np.asarray(np.abs(dot(z, self.origin - frame[:3, 3:])) + self.rise(z))


ACTUAL: Final[Mapping[type, type[ActualFeature]]] = {
    Point: ActualFeature, Axis: ActualAxis, Cone: ActualAxis,
    Plane: ActualPlane, Slot: ActualSlot, RoundPlane: ActualDisc,
}  # fmt: skip
"""By shape; no other place of this method asks for the class of one."""


def _slope(rise: Array | float, reach: float) -> Array:
    """A rise over its reach, 0 where there is no reach."""
    return np.asarray(rise) / reach if reach else np.zeros(1)


def actual(feature: Feature, base: Pose, columns: Array) -> ActualFeature:
    """A feature in its trials.

    Args:
        feature: the feature.
        base: of its nominal frame in the part's, as its datum frame carries it in the trials.
        columns: the deviations, (width, n) [mm].
    """
    moved = total(feature.moved_by, len(feature.shape.components), columns)
    found = ACTUAL[type(feature.shape)].of(feature, base, moved)
    if not feature.grown_by:
        return found
    return replace(found, centre=found.centre + _vector(*total(feature.grown_by, 3, columns)))


def nominally(feature: Feature) -> ActualFeature:
    """A feature without deviations, where it is nominally in its part."""
    bare = Feature(feature.name, feature.part, feature.shape, feature.frame)
    return actual(bare, Pose.of(feature.frame), np.zeros((0, 1)))


def actual_size(feature: Feature, columns: Array) -> Array:
    """Its diameter or width in its trials (n,) or (1,) [mm]; of a feature that has one."""
    return (feature.shape.nominal_size or 0.0) + total(feature.size_by, 1, columns)[0]


def mating_size(feature: Feature, columns: Array) -> Array:
    """Its diameter or width that a fit sees, form included, in its trials (n,) or (1,) [mm]."""
    return (feature.shape.nominal_size or 0.0) + total(feature.mating_by, 1, columns)[0]


def _vector(x: Array | float, y: Array | float, z: Array | float) -> Array:
    trials = max(1 if isinstance(own, float) else len(own) for own in (x, y, z))
    found = np.empty((3, trials))
    found[0], found[1], found[2] = x, y, z
    return found
