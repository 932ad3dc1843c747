"""Closed surfaces that represent features stated by numbers: slabs, rods, rings, octahedra."""

from collections.abc import Iterator, Mapping, Sequence
from functools import singledispatch
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.model import Assembly, Axis, Cone, Feature, RoundPlane, Slot
from tol3d.assembly.model.feature import Facts, Flat
from tol3d.assembly.model.measures import Measured
from tol3d.numerics.arrays import Array

Surface = tuple[Array, NDArray[np.int64]]

SIDES = 48
"""Sides of a round surface."""
ANGLES: Final = 2 * np.pi * np.arange(SIDES) / SIDES
WALL = 0.35
"""Thickness of marks across the surface of solids over that of other symbols."""


@singledispatch
def symbol(shape: Facts, thickness: float) -> Surface:
    """Symbol of a feature, in its frame: vertices (n, 3) [mm], triangles (m, 3).

    Args:
        shape: a plane is a slab below it, a tab a block, a slot its two walls,
            an axis a rod of its diameter, a hole a ring, a cone a piece or a wall of it, a point an octahedron,
            a sphere a ball, a socket the zone of a shell between 45 degrees of latitude.
        thickness: of shapes that have none of their own [mm].
    """
    if shape.diameter is not None:
        return zone(shape.diameter / 2, shape.diameter / 2 + thickness) if shape.inner else ball(shape.diameter / 2)
    corners = thickness * np.concatenate([np.eye(3), -np.eye(3)])
    faces = [(a, b, c) for a in (0, 3) for b in (1, 4) for c in (2, 5)]
    return corners, np.array([_outward(corners, face) for face in faces])


@symbol.register
def _(shape: Flat, thickness: float) -> Surface:
    return prism(shape.edge(ANGLES)[:, :2], -thickness, 0.0)


@symbol.register
def _(shape: Slot, thickness: float) -> Surface:
    outline, half = shape.ends[:, :2], shape.width / 2
    if not shape.inner:
        return prism(outline, -half, half)
    return together([prism(outline, half, half + thickness), prism(outline, -half - thickness, -half)])


@symbol.register
def _(shape: Axis, thickness: float) -> Surface:
    half = shape.length / 2
    radius = thickness / 4 if shape.diameter is None else shape.diameter / 2
    return ring(radius, radius + thickness, -half, half) if shape.inner else prism(circle(radius), -half, half)


@symbol.register
def _(shape: Cone, thickness: float) -> Surface:
    start, end = shape.diameters
    return frustum(start / 2, end / 2, shape.length, thickness if shape.inner else 0.0)


@singledispatch
def mark(shape: Facts, thickness: float) -> Surface:
    """Mark of a feature on the solid of its part, in its frame: thin, astride of the surface.

    Args:
        shape: a plane is a frame along its edges or a ring, a slot or a tab such frames on both walls, a hole a tube, a
            pin a little thicker than it is, a ball its equator; others as by `symbol`.
        thickness: of a symbol [mm].
    """
    if shape.diameter is None or shape.inner:  # a sphere need not be a face: a pitch sphere, for instance
        return symbol(shape, thickness)
    half = WALL * thickness / 2
    return ring(shape.diameter / 2 - half, shape.diameter / 2 + half, -half, half)


@mark.register
def _(shape: Flat, thickness: float) -> Surface:
    half, wall = WALL * thickness / 2, (shape.nominal_size or 0.0) / 2
    heights = dict.fromkeys((-wall, wall))  # one of a face
    return together([edges(shape.reach, thickness, height - half, height + half) for height in heights])


@mark.register
def _(shape: RoundPlane, thickness: float) -> Surface:
    half = WALL * thickness / 2
    return ring(max(shape.radius - thickness, shape.radius / 2), shape.radius, -half, half)


@mark.register
def _(shape: Axis, thickness: float) -> Surface:
    if shape.diameter is None:
        return symbol(shape, thickness)
    half, radius, end = WALL * thickness / 2, shape.diameter / 2, shape.length / 2
    if not shape.inner:
        return prism(circle(radius + half), -end, end)
    return ring(max(radius - half, radius / 2), radius + half, -end, end)


@mark.register
def _(shape: Cone, thickness: float) -> Surface:
    half, (start, end) = WALL * thickness / 2, shape.diameters
    return frustum(start / 2 - half, end / 2 - half, shape.length, 2 * half)


def reach_of(shape: Facts) -> Array:
    """Half sizes (3,) of the box about a feature, along the axes of its frame [mm]."""
    return np.asarray(np.abs(symbol(shape, 0.0)[0]).max(axis=0))


def edges(reach: tuple[float, float], width: float, low: float, high: float) -> Surface:
    """Four bars along the inside of a rectangle's edges, from one height to another [mm]."""
    a, b = reach
    wide, deep = min(width, a / 2), min(width, b / 2)
    bars = (
        (-a, a, b - deep, b),
        (-a, a, -b, deep - b),
        (a - wide, a, deep - b, b - deep),
        (-a, wide - a, deep - b, b - deep),
    )
    outlines = [np.array([(left, near), (right, near), (right, far), (left, far)]) for left, right, near, far in bars]
    return together([prism(outline, low, high) for outline in outlines])


def together(surfaces: Sequence[Surface]) -> Surface:
    """Several closed surfaces as one."""
    starts = np.cumsum([0, *(len(vertices) for vertices, _ in surfaces)])
    return (
        np.concatenate([vertices for vertices, _ in surfaces]),
        np.concatenate([triangles + start for (_, triangles), start in zip(surfaces, starts, strict=False)]),
    )


def circle(radius: float) -> Array:
    """A circle's corners (SIDES, 2), counter-clockwise [mm]."""
    return radius * np.stack([np.cos(ANGLES), np.sin(ANGLES)], axis=-1)


def prism(outline: Array, low: float, high: float) -> Surface:
    """A closed prism over a convex outline (n, 2), counter-clockwise, from one height to another [mm]."""
    n = len(outline)
    vertices = np.concatenate([np.column_stack([outline, np.full(n, z)]) for z in (low, high)])
    here = np.arange(n)
    there = (here + 1) % n
    walls = np.concatenate(
        [
            np.stack([here, there, there + n], axis=-1),
            np.stack([here, there + n, here + n], axis=-1),
        ]
    )
    fan = np.stack([np.zeros(n - 2, dtype=np.int64), here[1:-1], here[2:]], axis=-1)
    return vertices, np.concatenate([walls, fan[:, ::-1], fan + n])


def ring(inner: float, outer: float, low: float, high: float) -> Surface:
    """A closed tube from one height to another [mm]."""
    return turned(((outer, low), (outer, high), (inner, high), (inner, low)))


def frustum(start: float, end: float, length: float, wall: float) -> Surface:
    """A closed piece of a cone of radii at both its ends, about its middle, or a wall outside it [mm]."""
    low, high = max(start, 0.0), max(end, 0.0)
    inside = ((high, length / 2), (low, -length / 2)) if wall else ((0.0, length / 2), (0.0, -length / 2))
    return turned(((low + wall, -length / 2), (high + wall, length / 2), *inside))


def zone(inner: float, outer: float) -> Surface:
    """A closed piece of a spherical shell about z, between 45 degrees of latitude [mm]."""
    latitudes = np.pi / 4 * np.linspace(-1.0, 1.0, SIDES // 4 + 1)
    arc = np.stack([np.cos(latitudes), np.sin(latitudes)], axis=-1)
    return turned([*(outer * arc), *(inner * arc[::-1])])


def ball(radius: float) -> Surface:
    """A closed ball [mm]."""
    latitudes = np.pi * (np.arange(1, SIDES // 2) / (SIDES // 2) - 0.5)
    vertices, triangles = turned(radius * np.stack([np.cos(latitudes), np.sin(latitudes)], axis=-1), closed=False)
    here, last = np.arange(SIDES), len(vertices)
    there, top = (here + 1) % SIDES, last - SIDES
    poles = np.array([(0.0, 0.0, -radius), (0.0, 0.0, radius)])
    low = np.stack([there, here, np.full(SIDES, last)], axis=-1)
    high = np.stack([here + top, there + top, np.full(SIDES, last + 1)], axis=-1)
    return np.concatenate([vertices, poles]), np.concatenate([triangles, low, high])


def turned(profile: Sequence[Sequence[float]] | Array, *, closed: bool = True) -> Surface:
    """A profile of radii and heights (n, 2), counter-clockwise seen with z up, turned about z [mm]."""
    vertices = np.concatenate([np.column_stack([circle(radius), np.full(SIDES, z)]) for radius, z in profile])
    here = np.arange(SIDES)
    there = (here + 1) % SIDES
    bands = []
    for k in range(len(profile) if closed else len(profile) - 1):
        own, following = k * SIDES, (k + 1) % len(profile) * SIDES
        bands.append(np.stack([here + own, there + own, there + following], axis=-1))
        bands.append(np.stack([here + own, there + following, here + following], axis=-1))
    return vertices, np.concatenate(bands)


def rod(start: Array, end: Array, radius: float) -> Surface:
    """A closed rod from one point (3,) to another [mm]."""
    along = end - start
    length = float(np.linalg.norm(along))
    z = along / length
    x = np.cross(z, np.eye(3)[int(np.argmin(np.abs(z)))])
    x /= np.linalg.norm(x)
    vertices, triangles = prism(circle(radius), 0.0, length)
    return start + vertices @ np.stack([x, np.cross(z, x), z]), triangles


def _outward(corners: Array, face: tuple[int, int, int]) -> tuple[int, int, int]:
    """A triangle of a solid about the origin, turned so that it looks outward."""
    a, b, c = (corners[k] for k in face)
    return face if float(np.cross(b - a, c - a) @ a) > 0.0 else (face[0], face[2], face[1])


MOST_NAMED: Final = 16
"""Features that a picture names."""
MOST_LISTED: Final = 4
"""Features that a note lists of those that it does not name."""
PLACES: Final = ("1st datum", "2nd datum", "3rd datum")


def labels(assembly: Assembly) -> Mapping[str, str]:
    """Labels of features that pictures name, by feature; datums with their place in the frame."""
    places = _datum_places(assembly)
    named = _by_importance(assembly)[:MOST_NAMED]
    return {name: f"{name}, {places[name]}" if name in places else name for name in named}


def unnamed(assembly: Assembly) -> tuple[str, ...]:
    """A note of the features that pictures do not name, if there are any."""
    others = _by_importance(assembly)[MOST_NAMED:]
    if not others:
        return ()
    more = f" and {len(others) - MOST_LISTED} more" if others[MOST_LISTED:] else ""
    words = f"{', '.join(others[:MOST_LISTED])}{more}"
    return (f"named are {MOST_NAMED} features, those that measures read and datums before others; not {words}",)


def _by_importance(assembly: Assembly) -> list[str]:
    """Named features: what measures read, datums, what deviates, all others; each in the scene's order."""
    ranks = {name: 3 for name, own in assembly.features.items() if own.is_named}
    ranks |= {name: 2 for name in ranks if assembly.features[name].moved_by}
    ranks |= {name: 1 for name in _datum_places(assembly) if name in ranks}
    ranks |= {name: 0 for measure in assembly.measures.values() for name in _read(measure) if name in ranks}
    return sorted(ranks, key=lambda name: ranks[name])


def _read(measured: Measured) -> Iterator[str]:
    yield from measured.features
    if measured.minus is not None:
        yield from _read(measured.minus)


def _datum_places(assembly: Assembly) -> Mapping[str, str]:
    """The place of each datum in its frames; "datum" where these differ."""
    found: dict[str, str] = {}
    for frame in assembly.datum_frames.values():
        for place, datum in zip(PLACES, frame.datums, strict=False):
            for name in datum.features:
                found[name] = place if found.get(name, place) == place else "datum"
    return found


Framed = Sequence[tuple[Feature, Array]]
"""Features, and their frames (4, 4)."""


def joined_symbols(features: Framed, thickness: float) -> Surface:
    """Symbols of several features, and rods from their middle to each."""
    places = np.array([frame[:3, 3] for _, frame in features])
    middle = places.mean(axis=0)
    rods = [rod(middle, place, thickness / 6) for place in places if np.linalg.norm(place - middle) > thickness]
    return together([*rods, *(_moved(symbol(own.shape, thickness), frame) for own, frame in features)])


def marks_on_solid(features: Framed, thickness: float) -> Surface:
    """Marks of several features on the solid of their part."""
    return together([_moved(mark(own.shape, thickness), frame) for own, frame in features])


def symbol_counts(features: Framed, thickness: float) -> Mapping[str, int]:
    """Triangles of each feature in `joined_symbols`, where they come last."""
    return {own.name: len(symbol(own.shape, thickness)[1]) for own, _ in features}


def mark_counts(features: Framed, thickness: float) -> Mapping[str, int]:
    """Triangles of each feature in `marks_on_solid`."""
    return {own.name: len(mark(own.shape, thickness)[1]) for own, _ in features}


def _moved(surface: Surface, frame: Array) -> Surface:
    vertices, triangles = surface
    return vertices @ frame[:3, :3].T + frame[:3, 3], triangles
