"""A part that is mated to a base, for tests: what deviates, and where that puts its features, by hand."""

from collections.abc import Sequence

import numpy as np
from assembly.placing.built_by_numbers import Columns, assembly, feature, frame, part, posed
from numpy.typing import NDArray

from tol3d.assembly.model import Assembly, Axis, Feature, Fix, Mate, Plane, Point, Relation, Shape

Array = NDArray[np.float64]

NOMINAL = posed((0.1, -0.2, 0.15), (40.0, 30.0, 20.0))

Side = tuple[str, Shape, Array]
"""Name of a feature, its shape, and its frame in the world nominally."""

Both = tuple[Array, Array]
"""Origin and z of a feature."""


def mated(relations: Sequence[tuple[str, Side, Side]]) -> tuple[Assembly, Sequence[slice]]:
    """A part mated to a base, each feature where its frame says in the world nominally, all of them deviating."""
    columns = Columns()
    base, moving, asked, slices = list[Feature](), list[Feature](), list[Relation](), list[slice]()
    from_world = np.linalg.inv(NOMINAL)
    for kind, (own, own_shape, own_at), (target, shape, at) in relations:
        for side, name, its, place in ((moving, own, own_shape, from_world @ own_at), (base, target, shape, at)):
            contribution = columns(count=len(its.components))
            slices.append(contribution.columns)
            side.append(feature(name, its, place, [contribution]))
        asked.append(Relation(kind, own, target))  # type: ignore[arg-type]
    parts = [part("base", base), part("part", moving, pose=NOMINAL)]
    return assembly(columns, parts, [Fix("base", "base"), Mate("mate", "part", tuple(asked))]), slices


def plane(at: Array, deviation: Array, reach: tuple[float, float]) -> tuple[Array, Array]:
    """Origin and normal of a plane by offset and rises."""
    normal = np.array([-deviation[1] / reach[0], -deviation[2] / reach[1], 1.0])
    return at[:3, :3] @ (0, 0, deviation[0]) + at[:3, 3], at[:3, :3] @ normal / np.linalg.norm(normal)


def axis(at: Array, deviation: Array, length: float) -> tuple[Array, Array]:
    """Origin and direction of an axis by its ends."""
    start, end = np.array([*deviation[:2], -length / 2]), np.array([*deviation[2:], length / 2])
    along = at[:3, :3] @ (end - start)
    return at[:3, :3] @ (start + end) / 2 + at[:3, 3], along / np.linalg.norm(along)


X, Y, Z = np.eye(3)
FLOOR, WALL, STOP = frame((50, 40, 0)), frame((0, 40, 20), (1, 0, 0)), frame((50, 0, 20), (0, 1, 0))
UNDER, SIDE, END = (frame(each[:3, 3] + (3, 2, 1) * (1 - each[:3, 2]), -each[:3, 2]) for each in (FLOOR, WALL, STOP))
REACH = (50.0, 30.0)
FACE = Plane((100.0, 60.0))
PIN, HOLE = Axis(20.0, 8.0), Axis(20.0, 8.1, inner=True)


def features_seen(relations: Sequence[tuple[str, Side, Side]], row: Array, slices: Sequence[slice]) -> list[list[Both]]:
    """Moving feature in its part and target in the world, for each relation: origin and z of each."""
    found = []
    for k, (_, (_, own_shape, own_at), (_, shape, at)) in enumerate(relations):
        both = (own_shape, np.linalg.inv(NOMINAL) @ own_at), (shape, at)
        found.append([_seen(each, there, row[slices[2 * k + side]]) for side, (each, there) in enumerate(both)])
    return found


def _seen(shape: Shape, at: Array, deviation: Array) -> Both:
    if isinstance(shape, Point):
        return at[:3, :3] @ deviation + at[:3, 3], at[:3, 2]
    if isinstance(shape, Axis):
        return axis(at, deviation, shape.length)
    assert isinstance(shape, Plane)
    return plane(at, deviation, shape.reach)
