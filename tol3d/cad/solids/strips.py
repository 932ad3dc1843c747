"""Measuring strips: profile points and normals sampled from the named flank faces of a gear's solid.

The strip of one flank, pulled into its tooth, and where its points lay before.

Measuring strips of any swept shape: points and normals sampled from its named faces, which are ruled along z.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tol3d.cad.solids.built_shape import SweptShape
from tol3d.cad.solids.cache import cached
from tol3d.cad.solids.lazy import cad
from tol3d.gears import LEFT, RIGHT, Flank, Gear
from tol3d.numerics.arrays import Array

Triangles = NDArray[np.int64]
Span = tuple[float, float]

WHOLE_FACE: Span = (0.0, 1.0)


@dataclass(frozen=True, eq=False)
class FlankStrips:
    """Both flanks of tooth 0 in the gear's frame, as strips between two polylines: the flanks are ruled.

    Args:
        parameter: (steps + 1,) where along the profile [rad], from where the involute begins to the tip: roll
            of a spur gear, in-plane angle of a bevel gear, uniform in its power 1.5. The sagitta of
            every step is the same then: a spur gear's is r_b t dt^2 / 8.
        inner, outer: of each flank, (steps + 1, 3) points [mm] at the lower and upper end of the face in z.
        normals: of each flank, (steps + 1, 3) unit vectors out of the tooth, from the face's derivatives; the
            same along each generator.
        chord_error: largest distance [mm] between face and polyline; the polyline lies inside the tooth.
        flank_error: largest distance [mm] of a point from the involute's at the same parameter.
    """

    parameter: Array
    inner: Mapping[Flank, Array]
    outer: Mapping[Flank, Array]
    normals: Mapping[Flank, Array]
    chord_error: float
    flank_error: float


def measuring_strips(gear: Gear, steps: int) -> FlankStrips:
    """Strips of a gear with that many steps a flank; from the cache, or from its solid, built for it."""
    arrays = cached("strips", gear, {"steps": steps}, lambda: cad().sample_flanks(gear, steps))

    def of_flanks(name: str) -> dict[Flank, Array]:
        return {flank: arrays[name][index].astype(np.float64) for index, flank in enumerate((RIGHT, LEFT))}

    return FlankStrips(
        parameter=arrays["parameter"].astype(np.float64),
        inner=of_flanks("inner"),
        outer=of_flanks("outer"),
        normals=of_flanks("normals"),
        chord_error=float(arrays["chord_error"]),
        flank_error=float(arrays["flank_error"]),
    )


def strip_mesh(
    strips: FlankStrips, flank: Flank, slack: float, scale: float = 1.0, span: Span = WHOLE_FACE
) -> tuple[Array, Triangles]:
    """The strip of one flank as triangles: two a step, none across the face, which is ruled.

    The flank is scaled first (thermal growth about the gear's origin) and then pulled into the tooth
    by `slack` [mm] along its normals, so that the slack is the same at any scale. The pulled
    polyline's own chord error is smaller than the strips', for its radius of curvature is. Within
    slack/r_b of roll 0 a flank that begins at the base circle folds over itself; contact never gets there.

    Args:
        strips, flank: which.
        slack: [mm].
        scale: growth of the gear.
        span: from where to where on the face, 0 its lower and 1 its upper end.

    Returns:
        vertices (2 (steps + 1), 3) [mm], first those at the lower end; triangles (2 steps, 3), turned outwards.
    """
    inner, outer, normals = strips.inner[flank], strips.outer[flank], strips.normals[flank]
    count = len(normals)
    vertices = np.concatenate([((1 - at) * inner + at * outer) * scale - slack * normals for at in span])
    low = np.arange(count - 1)
    near, far = (low, low + 1) if flank == RIGHT else (low + 1, low)
    first = np.stack([near, far, far + count], axis=-1)
    second = np.stack([near, far + count, near + count], axis=-1)
    return vertices, np.concatenate([first, second])


AT_END = 1e-5  # of the slack; FCL's nearest point is an edge to its rounding, or else lies off it by any length


@dataclass(frozen=True, eq=False)
class PulledStrip:
    """The strip of one flank as strip_mesh makes it; arguments as there."""

    strips: FlankStrips
    flank: Flank
    slack: float
    span: Span = WHOLE_FACE

    def mesh(self, scale: float) -> tuple[Array, Triangles]:
        """Vertices [mm] and triangles of a gear that has grown by `scale`."""
        return strip_mesh(self.strips, self.flank, self.slack, scale, self.span)

    def put_back(self, scale: Array, triangle: Triangles, point: Array) -> Array:
        """Vectors that put points of the strip back onto the flank: (n, 3) [mm], out of the tooth.

        A vertex was pulled along its normal, points between vertices by an interpolation.

        Args:
            scale: (n,), growth of the gear.
            triangle: (n,), on which each point lies.
            point: (n, 3) [mm].
        """
        normals = self.strips.normals[self.flank]
        _, triangles = self.mesh(1.0)
        end, step = np.divmod(triangles[triangle], len(normals))
        corners = self._points(np.array(self.span)[end], step) * scale[:, None, None] - self.slack * normals[step]
        one, other, here = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0], point - corners[:, 0]
        normal = np.cross(one, other)
        area = (normal * normal).sum(axis=-1)
        second = (np.cross(here, other) * normal).sum(axis=-1) / area
        third = (np.cross(one, here) * normal).sum(axis=-1) / area
        weights = np.stack([1 - second - third, second, third], axis=-1)
        return np.asarray(self.slack * (weights[..., None] * normals[step]).sum(axis=1))

    def at_end(self, scale: Array, point: Array) -> NDArray[np.bool_]:
        """True for points (n, 3) [mm] of the strip on an edge that ends its profile, (n,); arguments as above."""
        found = np.zeros(len(point), dtype=bool)
        for end in (0, -1):
            inner, outer = self.strips.inner[self.flank][end], self.strips.outer[self.flank][end]
            along = (outer - inner) / np.sqrt(((outer - inner) ** 2).sum())
            apart = point - (scale[:, None] * inner - self.slack * self.strips.normals[self.flank][end])
            across = apart - (apart * along).sum(axis=-1, keepdims=True) * along
            found |= (across * across).sum(axis=-1) < (AT_END * self.slack) ** 2
        return found

    def curvature(self, scale: Array, triangle: Triangles) -> Array:
        """Curvature of the flank along its profile at triangles, in mid-span: (n,) [1/mm]; negative for a ring."""
        normals = self.strips.normals[self.flank]
        step = triangle % (len(normals) - 1)
        middle = np.full(step.shape, sum(self.span) / 2)
        chord = self._points(middle, step + 1) - self._points(middle, step)
        turned = normals[step + 1] - normals[step]
        bent = np.sqrt((turned * turned).sum(axis=-1) / (chord * chord).sum(axis=-1)) / scale
        return np.asarray(np.copysign(bent, (turned * chord).sum(axis=-1)))

    def _points(self, at: Array, step: Triangles) -> Array:
        """Points of the flank at some shares of the face's width, not grown."""
        inner, outer = self.strips.inner[self.flank][step], self.strips.outer[self.flank][step]
        return np.asarray((1 - at)[..., None] * inner + at[..., None] * outer)


StripTriangles = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class FaceStrip:
    """One face in the frame of its part, as a strip between two polylines.

    Args:
        parameter: (steps + 1,) of the face, its u; steps leave the face by about the same distance.
        points: (steps + 1, 2) [mm].
        normals: (steps + 1, 2) unit vectors out of the part.
        width: from z = -width/2 to +width/2 [mm].
        chord_error: largest distance [mm] between face and polyline, which lies inside the part where the face is
            convex and outside where it is concave.
    """

    parameter: Array
    points: Array
    normals: Array
    width: float
    chord_error: float

    def mesh(self, slack: float) -> tuple[Array, StripTriangles]:
        """The strip as triangles, pulled into the part by `slack` [mm] along its normals: two a step.

        Returns:
            vertices (2 (steps + 1), 3) [mm], first those at the lower end; triangles (2 steps, 3), turned outwards.
        """
        pulled = self.points - slack * self.normals
        ends = (np.full((len(pulled), 1), end) for end in (-self.width / 2, self.width / 2))
        vertices = np.concatenate([np.hstack([pulled, end]) for end in ends])
        count, low = len(pulled), np.arange(len(pulled) - 1)
        along = pulled[1] - pulled[0]
        outwards_right = along[1] * self.normals[0, 0] - along[0] * self.normals[0, 1] > 0  # counter-clockwise outline
        near, far = (low, low + 1) if outwards_right else (low + 1, low)
        first = np.stack([near, far, far + count], axis=-1)
        second = np.stack([near, far + count, near + count], axis=-1)
        return vertices, np.concatenate([first, second])


def face_strips(shape: SweptShape, faces: Sequence[str], steps: int) -> tuple[FaceStrip, ...]:
    """Strips of faces of a shape with that many steps each; from the cache, or from its solid, built for it.

    The chord error is the largest of all of them.
    """
    settings = {"steps": float(steps)} | {face: float(number) for number, face in enumerate(faces)}
    arrays = cached("faces", shape, settings, lambda: cad().sample_faces(shape, faces, steps))
    parameter, points, normals = (arrays[name].astype(np.float64) for name in ("parameter", "points", "normals"))
    error = float(arrays["chord_error"])
    return tuple(FaceStrip(parameter[k], points[k], normals[k], shape.width, error) for k in range(len(faces)))
