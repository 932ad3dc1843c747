"""Surfaces of two features, at least one of them round: common normal, least gap, and distance at contact."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.model import Shape
from tol3d.assembly.placing.actual_feature import ActualFeature, actual_size
from tol3d.assembly.placing.poses import NO_LENGTH, cross, dot, unit
from tol3d.numerics.arrays import Array

PARALLEL: Final = 1e-6
"""Sine of the angle between two axes below which they are nominally parallel."""


def touching_distance(start: ActualFeature, end: ActualFeature, columns: Array) -> Array:
    """Distance of axes or middles at contact (n,) or (1,) [mm]: the sum of the radii, or hole less pin."""
    radii = [actual_size(side.feature, columns) / 2 for side in (start, end)]
    if start.feature.shape.inner:
        return radii[0] - radii[1]
    return radii[1] - radii[0] if end.feature.shape.inner else radii[0] + radii[1]


def is_inside(start: Shape, end: Shape) -> bool:
    """True if one of the two is a bore or a socket that holds the other."""
    return start.inner or end.inner


def gap_of(start: ActualFeature, end: ActualFeature, columns: Array, *, parallel: bool) -> Array:
    """Least gap between two surfaces over the length that both have (n,) [mm]; negative if they overlap.

    A cylinder in a bore: the radius of the bore less its own, less the largest distance of the axes along the length in
    common. Cylinders outside each other: the least distance of their axes between their ends, less the radii. A
    cylinder over a plane: the least height of its lines where its axis is over the plane, or all along if it is over
    none of it. Parallel cylinders without a length in common are read at the ends that face each other. A sphere or
    point has one place; the plane or cylinder beside it has no ends then, see `common_normal`.

    Args:
        start, end: the features in one frame.
        columns: the deviations, (width, n) [mm].
        parallel: True if two axes are nominally parallel.
    """
    touching = touching_distance(start, end, columns)
    match start.feature.shape.surface, end.feature.shape.surface:
        case "plane", "axis":
            return _above(start, end, touching)
        case "axis", "plane":
            return _above(end, start, touching)
        case "axis", "axis" if start.feature.shape.inner:
            return np.asarray(touching - np.maximum(*_aside(start, end)[1:]))
        case "axis", "axis" if end.feature.shape.inner:
            return np.asarray(touching - np.maximum(*_aside(end, start)[1:]))
        case "axis", "axis" if parallel:
            has_common, *facing = _aside(start, end)
            return np.where(has_common, _between(start, end), np.minimum(*facing)) - touching
        case "axis", "axis":
            return _between(start, end) - touching
    gap = common_normal(start, end, parallel=parallel)[1] - touching
    return -gap if is_inside(start.feature.shape, end.feature.shape) else gap


def _stretch(middle: Array, half: Array, reach: Array | float) -> tuple[Array, Array]:
    """First and last place of an axis, -1 to 1 from end to end, whose foot lies on another feature (n,), (n,).

    If no foot does, the first is larger than the last.

    Args:
        middle: along the other feature, from its middle to the foot of the axis' middle (n,) [mm].
        half: from there to the foot of the axis' end at 1 (n,) [mm].
        reach: of the other feature to both sides [mm].
    """
    steps = np.where(half == 0.0, NO_LENGTH, half)
    bounds = (-reach - middle) / steps, (reach - middle) / steps
    return np.maximum(-1.0, np.minimum(*bounds)), np.minimum(1.0, np.maximum(*bounds))


def _crossing(middle: Array, half: Array, reach: float) -> tuple[Array, Array]:
    """First and last place of an axis within a reach, by one coordinate or two together (n,), (n,); see `over`."""
    if len(middle) == 1:
        return _stretch(middle[0], half[0], reach)
    square = half[0] * half[0] + half[1] * half[1]
    nearest = -(middle[0] * half[0] + middle[1] * half[1]) / np.where(square == 0.0, NO_LENGTH, square)
    x, y = middle + nearest * half
    beside = reach**2 - x * x - y * y
    low, high = _stretch(-nearest, np.ones(1), np.sqrt(np.maximum(beside / np.maximum(square, NO_LENGTH), 0.0)))
    return np.where(beside < 0.0, np.inf, low), high


def over(plane: Shape, middle: Array, half: Array) -> tuple[Array, Array]:
    """First and last place of an axis, -1 to 1 from end to end, over a plane (n,), (n,); its ends if it is nowhere.

    Args:
        plane: the plane.
        middle: the axis' middle along x and y of the plane (2, n) [mm].
        half: from there to its end at 1 (2, n) [mm].
    """
    starts, ends = zip(*(_crossing(middle[k], half[k], plane.reach[k.start]) for k in plane.together), strict=True)
    low, high = np.maximum.reduce(starts), np.minimum.reduce(ends)
    return np.where(low <= high, low, -1.0), np.where(low <= high, high, 1.0)


def _above(plane: ActualFeature, line: ActualFeature, radius: Array) -> Array:
    """Least height of a cylinder's lines over a plane (n,) [mm], where its axis is over the plane."""
    normal, apart, (half,) = plane.direction, line.origin - plane.origin, line.spans
    shape, turn, rise = plane.feature.shape, plane.pose.turn, dot(half, normal)
    places = (np.stack(np.broadcast_arrays(*(dot(vector, turn[:, k]) for k in (0, 1)))) for vector in (apart, half))
    low, high = over(shape, *places)
    sine = np.sqrt(np.maximum(1.0 - rise * rise / dot(half, half), 0.0))
    return np.asarray(dot(apart, normal) + np.minimum(low * rise, high * rise) - radius * sine)


def _aside(actual_feature: ActualFeature, other: ActualFeature) -> tuple[NDArray[np.bool_], Array, Array]:
    """True if two axes have a length in common (n,), and their distances at both ends of it (n,), (n,) [mm].

    Without a length in common the distances are those at the ends that face each other.
    """
    direction, apart, (half,) = actual_feature.direction, other.origin - actual_feature.origin, other.spans
    middle, step = dot(apart, direction), dot(half, direction)
    low, high = _stretch(middle, step, np.sqrt(dot(actual_feature.spans[0], actual_feature.spans[0])))
    aside, change = apart - middle * direction, half - step * direction
    start, end = (np.sqrt(dot(place, place)) for place in (aside + low * change, aside + high * change))
    return low <= high, start, end


def _between(start: ActualFeature, end: ActualFeature) -> Array:
    """Least distance of two axes between their ends (n,) [mm].

    Source: C. Ericson, Real-Time Collision Detection, 5.1.9.
    """
    apart, (half,), (end_half,) = end.origin - start.origin, start.spans, end.spans
    square, end_square, both = dot(half, half), dot(end_half, end_half), dot(half, end_half)
    along, end_along = dot(half, apart), dot(end_half, apart)
    spread = square * end_square - both * both
    free = np.where(spread > 0.0, along * end_square - end_along * both, 0.0)
    at = np.clip(free / np.where(spread > 0.0, spread, 1.0), -1.0, 1.0)
    end_at = np.clip((both * at - end_along) / end_square, -1.0, 1.0)
    at = np.clip((both * end_at + along) / square, -1.0, 1.0)
    nearest = apart + end_at * end_half - at * half
    return np.asarray(np.sqrt(dot(nearest, nearest)))


def common_normal(start: ActualFeature, end: ActualFeature, *, parallel: bool) -> tuple[Array, Array]:
    """Unit normal from start to end, between planes, axes and middles (3, n), and their distance along it (n,) [mm].

    Args:
        start, end: the features in one frame.
        parallel: True if two axes are nominally parallel: the normal is then at the middle of `end`.
    """
    apart = end.origin - start.origin
    match start.feature.shape.surface, end.feature.shape.surface:
        case "plane", _:
            return start.direction, dot(apart, start.direction)
        case _, "plane":
            return -end.direction, -dot(apart, end.direction)
        case "axis", "axis" if not parallel:
            normal = unit(cross(start.direction, end.direction))
            normal = normal * np.where(dot(normal, apart) < 0.0, -1.0, 1.0)
            return normal, dot(normal, apart)
        case "axis", _:
            apart = apart - dot(apart, start.direction) * start.direction
        case _, "axis":
            apart = apart - dot(apart, end.direction) * end.direction
    return unit(apart), np.asarray(np.sqrt(dot(apart, apart)))
