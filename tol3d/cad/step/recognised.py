"""Planes, cylinders, cones, spheres and tori that splines are in truth, by points of the face and their normals.

Open CASCADE's own recogniser throws on splines that are closed. The axis of a round surface is the line that all its
normals meet (H. Pottmann and T. Randrup, "Rotational and helical surface approximation for reverse engineering",
Computing 60, 1998); its numbers are then those of least squares.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

from tol3d.numerics.arrays import Array

EXACT: Final = 1e-6
"""mm; deviation of a spline that is the surface but for rounding."""
DEVIATION: Final = 1e-4
"""mm; largest deviation of a spline from the surface that it is taken for: a tenth of a micrometre."""
FLATTEST: Final = 1e4
"""Largest radius in sizes of the face: of a rounder one nothing is known from such a piece."""
STEPS: Final = 6
"""Of Gauss-Newton; it starts within the error of the normals and converges quadratically."""
STEP: Final = 1e-7
"""Of the difference quotient, in sizes of the face."""

Kind = Literal["plane", "cylinder", "cone", "sphere", "torus"]


@dataclass(frozen=True)
class Recognised:
    """The surface that a spline is.

    Args:
        kind: of it.
        at: a point of a plane, the centre of a sphere or torus, a point of the axis of others (3,) [mm].
        axis: the normal of a plane, the axis of others (3,).
        radius: of a round one [mm]; of a cone at `at`, of a torus of its circle; 0 of a plane.
        half_angle: of a cone, positive if it widens along the axis [rad].
        minor_radius: of a torus's tube [mm].
        deviation: largest distance of the points from it [mm].
    """

    kind: Kind
    at: Array
    axis: Array
    radius: float = 0.0
    half_angle: float = 0.0
    minor_radius: float = 0.0
    deviation: float = 0.0


def recognised(points: Array, normals: Array) -> Recognised | None:
    """The simplest surface on which points lie, within EXACT or else within DEVIATION; None if there is none.

    Args:
        points: of the face (n, 3) [mm].
        normals: there (n, 3), of length 1.
    """
    middle = points.mean(axis=0)
    size = float(np.abs(points - middle).max())
    if size < DEVIATION or len(points) < 6:
        return None
    found = [surface for fit in FITS for surface in fit((points - middle) / size, normals)]
    for allowed in (EXACT, DEVIATION):
        for own in found:
            if own.deviation * size <= allowed:
                return Recognised(
                    own.kind, middle + size * own.at, own.axis, size * own.radius, own.half_angle,
                    size * own.minor_radius, size * own.deviation,
                )  # fmt: skip
    return None


def turned(points: Array, at: Array, axis: Array, x: Array) -> tuple[float, float]:
    """Angles about an axis, from x on, between which a grid of points of a face (n, m, 3) lies [rad]."""
    off = points - at
    angles = np.arctan2(off @ np.cross(axis, x), off @ x)
    spans = []
    for along in (0, 1):
        rows = np.moveaxis(np.unwrap(angles, axis=along), along, 1)
        widest = rows[int(np.argmax(np.ptp(rows, axis=1)))]
        spans.append((float(widest.min()), float(widest.max())))
    low, high = max(spans, key=lambda span: span[1] - span[0])
    return low, min(high, low + 2.0 * math.pi)


# the fits, about the middle of the points and in sizes of the face --------------------------------------


def _plane(points: Array, normals: Array) -> Iterator[Recognised]:
    axis = np.linalg.svd(points - points.mean(axis=0))[2][2]
    at = points.mean(axis=0)
    yield Recognised("plane", at, axis, deviation=float(np.abs((points - at) @ axis).max()))


def _sphere(points: Array, normals: Array) -> Iterator[Recognised]:
    """Of |p|² = 2 c·p + r² - |c|², which is linear in c and the rest."""
    terms = np.column_stack([2.0 * points, np.ones(len(points))])
    centre = np.linalg.lstsq(terms, (points * points).sum(axis=1), rcond=None)[0][:3]
    radii = np.linalg.norm(points - centre, axis=1)
    radius = float(radii.mean())
    if radius < FLATTEST:
        ends = np.array([0.0, 0.0, 1.0])
        yield Recognised("sphere", centre, ends, radius, deviation=float(np.abs(radii - radius).max()))


def _cylinder(points: Array, normals: Array) -> Iterator[Recognised]:
    """Its normals are square to its axis."""
    axis = np.linalg.svd(normals)[2][2]
    x, y = _across(axis)
    flat = np.column_stack([points @ x, points @ y])
    terms = np.column_stack([2.0 * flat, np.ones(len(flat))])
    a, b, _ = np.linalg.lstsq(terms, (flat * flat).sum(axis=1), rcond=None)[0]
    radius = float(np.hypot(flat[:, 0] - a, flat[:, 1] - b).mean())

    def off(numbers: Array) -> Array:
        at, way = _line(axis, numbers)
        return np.asarray(_radii(points, at, way)[0] - numbers[4])

    if radius < FLATTEST:
        best = _least(off, np.array([a, b, 0.0, 0.0, radius]))
        at, way = _line(axis, best)
        yield Recognised("cylinder", at, way, float(best[4]), deviation=float(np.abs(off(best)).max()))


def _cone(points: Array, normals: Array) -> Iterator[Recognised]:
    """Its normals have one angle to its axis, and meet it."""
    axis = np.linalg.svd(normals - normals.mean(axis=0))[2][2]
    x, y = _across(axis)
    # q + t n meets the axis: (q - c) · (axis × n) = 0, linear in the two coordinates of c
    square = np.cross(axis, normals)
    terms = np.column_stack([square @ x, square @ y])
    a, b = np.linalg.lstsq(terms, (points * square).sum(axis=1), rcond=None)[0]
    radii, heights = _radii(points, a * x + b * y, axis)
    radius, slope = np.linalg.lstsq(np.column_stack([np.ones(len(radii)), heights]), radii, rcond=None)[0]

    def off(numbers: Array) -> Array:
        at, way = _line(axis, numbers)
        own, along = _radii(points, at, way)
        return np.asarray((own - numbers[4] - numbers[5] * along) / math.hypot(1.0, float(numbers[5])))

    best = _least(off, np.array([a, b, 0.0, 0.0, radius, slope]))
    at, way = _line(axis, best)
    half = math.atan(float(best[5]))
    if best[4] > 0.0 and best[4] < FLATTEST:
        way, half = (way, half) if half > 0.0 else (0.0 - way, -half)
        yield Recognised("cone", at, way, float(best[4]), half, deviation=float(np.abs(off(best)).max()))


def _torus(points: Array, normals: Array) -> Iterator[Recognised]:
    """Normals n at p meet a line of direction c and moment m if m·n + c·(p × n) = 0: the least c, then its m."""
    moments = np.cross(points, normals)
    moment_from_axis = -np.linalg.pinv(normals) @ moments
    axis = np.linalg.svd(moments + normals @ moment_from_axis)[2][2]
    at = np.cross(axis, moment_from_axis @ axis)
    radii, heights = _radii(points, at, axis)
    terms = np.column_stack([2.0 * radii, 2.0 * heights, np.ones(len(radii))])
    large, height, rest = np.linalg.lstsq(terms, radii**2 + heights**2, rcond=None)[0]
    x, y = _across(axis)
    start = [float(at @ x), float(at @ y), 0.0, 0.0, large, math.sqrt(max(rest + large**2 + height**2, 0.0)), height]

    def off(numbers: Array) -> Array:
        own, along = _radii(points, *_line(axis, numbers))
        return np.asarray(np.hypot(own - numbers[4], along - numbers[6]) - numbers[5])

    best = _least(off, np.array(start))
    if 0.0 < best[4] < FLATTEST and 0.0 < best[5] < FLATTEST:
        at, way = _line(axis, best)
        sizes = float(best[4]), 0.0, float(best[5])
        yield Recognised("torus", at + best[6] * way, way, *sizes, deviation=float(np.abs(off(best)).max()))


Fit = Callable[[Array, Array], Iterator[Recognised]]
FITS: Final[Sequence[Fit]] = (_plane, _cylinder, _cone, _sphere, _torus)
"""The simplest first."""


def _line(axis: Array, numbers: Array) -> tuple[Array, Array]:
    """Point (3,) and direction (3,) of a line near an axis, by two shifts across it and two slopes."""
    x, y = _across(axis)
    way = axis + numbers[2] * x + numbers[3] * y
    return numbers[0] * x + numbers[1] * y, way / np.linalg.norm(way)


def _radii(points: Array, at: Array, axis: Array) -> tuple[Array, Array]:
    """Distances of points (n, 3) from a line, and heights along it."""
    off = points - at
    heights = off @ axis
    return np.linalg.norm(off - np.outer(heights, axis), axis=1), heights


def _across(axis: Array) -> tuple[Array, Array]:
    """Two directions (3,) that are square to one and to each other."""
    start = np.eye(3)[int(np.argmin(np.abs(axis)))]
    x = np.cross(axis, start)
    x = x / np.linalg.norm(x)
    return x, np.cross(axis, x)


def _least(off: Callable[[Array], Array], numbers: Array) -> Array:
    """Numbers that make the distances least in squares: Gauss-Newton, ended where a step does not lower them."""
    best, size = numbers, float(np.linalg.norm(off(numbers)))
    for _ in range(STEPS):
        here = off(best)
        rates = np.column_stack([(off(best + STEP * own) - here) / STEP for own in np.eye(len(best))])
        tried = best - np.linalg.lstsq(rates, here, rcond=None)[0]
        own = float(np.linalg.norm(off(tried)))
        if not own < size:
            return best
        best, size = tried, own
    return best
