"""The strip of one flank, pulled into its tooth, and where its points lay before."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tol3d.gears import Flank
from tol3d.numerics.arrays import Array
from tol3d.solids.flank_strips import WHOLE_FACE, FlankStrips, Span, Triangles, strip_mesh

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
