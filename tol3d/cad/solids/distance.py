"""Distances between surfaces by the Flexible Collision Library. The only module that imports it.

Its distance is never negative: 0 where two bodies overlap, without a depth. Its objects do not pickle: make them in
the worker.
"""

from typing import NamedTuple, TypeAlias

import fcl
import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.arrays import Array

Integers = NDArray[np.int64]

Surface: TypeAlias = fcl.CollisionObject
"""A surface or body with a pose of its own, from its frame to the world."""


class Nearest(NamedTuple):
    """Nearest points of two surfaces.

    Args:
        distance: [mm], 0 where they overlap.
        points: on the first and on the second, each (3,) [mm], in the world.
        triangles: indices in their meshes, -1 for a body without one.
    """

    distance: float
    points: tuple[Array, Array]
    triangles: tuple[int, int]


def mesh_surface(vertices: Array, triangles: Integers) -> Surface:
    """A mesh of vertices (n, 3) [mm] and triangles (m, 3), in a hierarchy of bounding volumes."""
    hierarchy = fcl.BVHModel()
    hierarchy.beginModel(len(vertices), len(triangles))
    hierarchy.addSubModel(vertices, triangles)
    hierarchy.endModel()
    return fcl.CollisionObject(hierarchy, fcl.Transform())


def sphere(radius: float) -> Surface:
    """A ball [mm] about its frame's origin."""
    return fcl.CollisionObject(fcl.Sphere(radius), fcl.Transform())


def cylinder(radius: float, length: float) -> Surface:
    """A solid cylinder [mm], such as a pin, its axis z, its middle at its frame's origin."""
    return fcl.CollisionObject(fcl.Cylinder(radius, length), fcl.Transform())


def put(surface: Surface, rotation: Array, translation: Array) -> None:
    """Give a surface a pose: world_from_surface, rotation (3, 3) and translation (3,) [mm]."""
    surface.setTransform(fcl.Transform(rotation, translation))


class NearestPoints:
    """Finds where two surfaces are nearest to each other; made once for many queries."""

    def __init__(self) -> None:
        self._request = fcl.DistanceRequest(enable_nearest_points=True)

    def of(self, first: Surface, second: Surface) -> Nearest:
        """Nearest points of two surfaces in their poses."""
        result = fcl.DistanceResult()
        distance = fcl.distance(first, second, self._request, result)
        return Nearest(distance, result.nearest_points, (result.b1, result.b2))


def overlapping(first: Surface, second: Surface) -> bool:
    """True if two surfaces meet in their poses; one wholly inside the other does not meet it."""
    return bool(fcl.collide(first, second, fcl.CollisionRequest(), fcl.CollisionResult()))
