"""Surfaces of two features, at least one of them round: common normal, distance, and distance at contact."""

from typing import Final, Literal

import numpy as np

from tol3d.assembly.model import Plane, Point, RoundPlane, Shape
from tol3d.assembly.model.moves import is_inner
from tol3d.assembly.placing.actual_feature import ActualFeature, actual_size
from tol3d.assembly.placing.poses import cross, dot, unit
from tol3d.numerics.arrays import Array

Kind = Literal["point", "line", "plane"]

PARALLEL: Final = 1e-6
"""Sine of the angle of two axes that nominally lie along each other, not across."""


def kind_of(shape: Shape) -> Kind:
    """Kind of a shape, apart from its radius: centre, axis or plane."""
    if isinstance(shape, Point):
        return "point"
    return "plane" if isinstance(shape, Plane | RoundPlane) else "line"


def touching_distance(start: ActualFeature, end: ActualFeature, columns: Array) -> Array:
    """The sum of two radii, or their difference where one is inside the other (n,) or (1,) [mm]."""
    radii = [actual_size(own.feature, columns) / 2 for own in (start, end)]
    if is_inner(start.feature.shape):
        return radii[0] - radii[1]
    return radii[1] - radii[0] if is_inner(end.feature.shape) else radii[0] + radii[1]


def is_inside(start: Shape, end: Shape) -> bool:
    """True if one of the two is a bore or a socket, in which the other lies."""
    return is_inner(start) or is_inner(end)


def gap_of(start: ActualFeature, end: ActualFeature, columns: Array, *, parallel: bool) -> Array:
    """Gap between two surfaces (n,) [mm]; negative if they overlap. See `common_normal`."""
    gap = common_normal(start, end, parallel=parallel)[1] - touching_distance(start, end, columns)
    return -gap if is_inside(start.feature.shape, end.feature.shape) else gap


def common_normal(start: ActualFeature, end: ActualFeature, *, parallel: bool) -> tuple[Array, Array]:
    """The direction from one to the other (3, n), and their distance along it (n,) [mm].

    Args:
        start, end: the features in one frame.
        parallel: whether two axes lie along each other; the middle of `end` counts then.
    """
    apart = end.origin - start.origin
    match kind_of(start.feature.shape), kind_of(end.feature.shape):
        case "plane", _:
            return start.direction, dot(apart, start.direction)
        case _, "plane":
            return -end.direction, -dot(apart, end.direction)
        case "line", "line" if not parallel:
            normal = unit(cross(start.direction, end.direction))
            normal = normal * np.where(dot(normal, apart) < 0.0, -1.0, 1.0)
            return normal, dot(normal, apart)
        case "line", _:
            apart = apart - dot(apart, start.direction) * start.direction
        case _, "line":
            apart = apart - dot(apart, end.direction) * end.direction
    return unit(apart), np.asarray(np.sqrt(dot(apart, apart)))
