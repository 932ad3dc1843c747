"""Regions in which draws lie: the furthest point along slopes, and the nearest point to one that is outside.

A worst case is looked for in the product of the regions of all contributors. Of a law without limits of its own they
end where its `low` and `high` do: at 0.135 % and 99.865 %, as 3 sigma of a normal law. Features that are drawn each for
itself are all at their own worst ends, however rare that is.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from typing_extensions import override

from tol3d.numerics.arrays import Array
from tol3d.statistics.distributions import DeviationLaw, Distribution
from tol3d.study.system.draw import Ball, Draw, Each, Planar, Scalar
from tol3d.study.system.each_planar import EachOwn
from tol3d.study.system.remembered import Remembered


@runtime_checkable
class Independent(Protocol, metaclass=Remembered):
    """A Draw whose components are drawn each by a law of its own, as those of a process are."""

    @property
    def own_laws(self) -> Sequence[DeviationLaw]:
        """The law of each component."""
        ...


@runtime_checkable
class Filled(Protocol, metaclass=Remembered):
    """A Draw that states whether it may lie anywhere between two of its deviations."""

    @property
    def fills(self) -> bool:
        """True if its region is convex; of others its ends alone are taken, and the mean of one that reads none."""
        ...


class Region(ABC):
    """Region of the components of one contributor."""

    fills: bool = True
    """True if all points between two of its points belong to it too, once they are confined."""

    @abstractmethod
    def furthest(self, slopes: Array) -> Array:
        """The points (rows, components) that lie furthest along slopes (rows, components); any where these are 0."""

    def confined(self, points: Array) -> Array:
        """The points of the region nearest to others (rows, components)."""
        return points

    @property
    def has_nearest(self) -> bool:
        """True if `confined` takes any point into the region, not only those between its points."""
        return True

    def halves(self, slopes: Array) -> Array:
        """Half of the effect of each of its independent parts between its ends (parts,), by slopes (components,)."""
        ends = self.furthest(np.stack([slopes, -slopes]))
        return np.array([abs(float((ends[0] - ends[1]) @ slopes)) / 2])


@dataclass(frozen=True, eq=False)
class Box(Region):
    """Components each between its own ends (components,) [mm, rad or K]."""

    low: Array
    high: Array

    @override
    def furthest(self, slopes: Array) -> Array:
        return np.where(slopes > 0.0, self.high, self.low)

    @override
    def confined(self, points: Array) -> Array:
        return np.clip(points, self.low, self.high)

    def halves(self, slopes: Array) -> Array:
        """See Region: each component by itself."""
        return np.asarray(np.abs(slopes) * (self.high - self.low) / 2)


@dataclass(frozen=True, eq=False)
class Round(Region):
    """Lengths from `inner` to `outer` in any direction of a plane or of space."""

    inner: float
    outer: float

    @override
    def furthest(self, slopes: Array) -> Array:
        return self.outer * _directions(slopes)

    @override
    def confined(self, points: Array) -> Array:
        sizes = np.linalg.norm(points, axis=-1, keepdims=True)
        return np.asarray(np.clip(sizes, self.inner, self.outer) * _directions(points))


@dataclass(frozen=True, eq=False)
class Along(Region):
    """Lengths from `low` to `high` in one direction (components,)."""

    direction: Array
    low: float
    high: float

    @override
    def furthest(self, slopes: Array) -> Array:
        return np.where(slopes @ self.direction > 0.0, self.high, self.low)[:, None] * self.direction

    @override
    def confined(self, points: Array) -> Array:
        return np.clip(points @ self.direction, self.low, self.high)[:, None] * self.direction


@dataclass(frozen=True, eq=False)
class EachIn(Region):
    """The same region for each of several features, one after the other."""

    each: Region
    count: int

    def __post_init__(self) -> None:
        object.__setattr__(self, "fills", self.each.fills)

    @override
    def furthest(self, slopes: Array) -> Array:
        return self.each.furthest(slopes.reshape(len(slopes) * self.count, -1)).reshape(slopes.shape)

    @override
    def confined(self, points: Array) -> Array:
        return self.each.confined(points.reshape(len(points) * self.count, -1)).reshape(points.shape)

    @property
    @override
    def has_nearest(self) -> bool:
        return self.each.has_nearest

    def halves(self, slopes: Array) -> Array:
        """See Region: each feature by itself."""
        return np.concatenate([self.each.halves(own) for own in slopes.reshape(self.count, -1)])


@dataclass(frozen=True, eq=False)
class Asked(Region):
    """A region known by the ends that its draw gives, of any kind."""

    draw: Draw
    turning: bool

    def __post_init__(self) -> None:
        object.__setattr__(self, "fills", isinstance(self.draw, Filled) and self.draw.fills)

    @override
    def furthest(self, slopes: Array) -> Array:
        return np.array([self._furthest(slope) for slope in slopes]).reshape(slopes.shape)

    def _furthest(self, slopes: Array) -> Array:
        ends = self.draw.ends(lambda rows: np.asarray(rows @ slopes), turning=self.turning)
        return np.asarray(ends[int(np.argmax(ends @ slopes))])

    @property
    @override
    def has_nearest(self) -> bool:
        return False


def region_of(draw: Draw, *, turning: bool) -> Region:
    """The region of a draw; `turning` where its direction turns through all angles from trial to trial."""
    if isinstance(draw, Scalar | Each):
        law, count = draw.distribution, len(draw.components)
        return Box(np.full(count, law.low), np.full(count, law.high))
    if isinstance(draw, Planar) and draw.direction is not None and not turning:
        direction = np.array([math.cos(draw.direction), math.sin(draw.direction)])
        return Along(direction, draw.distribution.low, draw.distribution.high)
    if isinstance(draw, Planar | Ball):
        return Round(_inner(draw.distribution), draw.distribution.radius)
    if isinstance(draw, EachOwn):
        return EachIn(region_of(draw.each, turning=turning), len(draw.names))
    if isinstance(draw, Independent):
        laws = draw.own_laws
        return Box(np.array([own.low for own in laws]), np.array([own.high for own in laws]))
    return Asked(draw, turning)


def _inner(law: Distribution) -> float:
    """The least length of a law with limits of its own."""
    if not law.limits:
        return 0.0
    low, high = law.limits
    return max(low, -high, 0.0)


def _directions(vectors: Array) -> Array:
    """Unit vectors (rows, components); the first axis where there is no direction."""
    sizes = np.linalg.norm(vectors, axis=-1, keepdims=True)
    first = np.eye(vectors.shape[-1])[0]
    return np.where(sizes > 0.0, vectors / np.where(sizes > 0.0, sizes, 1.0), first)
