"""Mixture for importance sampling at a position: plain builds, and some about design points.

Sources: Harbitz 1986 (beyond a distance); Breitung 1984 (the spread of failures along curved directions).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.special import gammaincc, gammainccinv, logsumexp, ndtr, ndtri

from tol3d.analyses.design_points import DesignPoint
from tol3d.analyses.limit_state import LimitState
from tol3d.analyses.second_order import curvatures
from tol3d.numerics.arrays import Array

PLAIN: Final = 0.05
"""Share of the draws that are not about any design point: no build that fails is left out."""
PLAIN_IF_COMMON: Final = 0.5
AROUND: Final = 0.1
"""Share of the draws at random beyond the distance of the nearest design point: it bounds all weights there."""
WIDEST: Final = 6.0
"""Variance along directions in which the limit bends towards the origin."""
LEAST_CURVED: Final = 0.02
"""Excess of a variance over 1 that is followed."""
COMMON: Final = 1e-3
"""Probability from which on half of the draws are plain."""


@dataclass(frozen=True, eq=False)
class Shape:
    """Normals about a design point as the limit curves there.

    Args:
        centre: of them (dimension,), on the ray of the design point.
        axes: directions (n, dimension), orthonormal and across the ray.
        variances: along these (n,); 1 elsewhere.
    """

    centre: Array
    axes: Array
    variances: Array

    @classmethod
    def plain(cls, point: DesignPoint) -> "Shape":
        """Shape without curvatures."""
        return cls(point.normals, np.zeros((0, len(point.normals))), np.zeros(0))

    @classmethod
    def curved(cls, state: LimitState, point: DesignPoint) -> "Shape":
        """That which failures have there to second order: variances 1/(1 + β κ), and their mean of the way."""
        if not point.smooth or not point.gradient.any():
            return cls.plain(point)
        values, axes = curvatures(state, point)
        values = -values if point.beyond else values
        variances = 1.0 / np.clip(1.0 + point.distance * values, 1.0 / WIDEST, 1.0)
        kept = variances - 1.0 > LEAST_CURVED
        along = point.distance + float((values * variances)[kept].sum()) / 2
        along = max(0.3 * point.distance, along)
        return cls(along * point.sensitivities, axes[kept], variances[kept])

    def drawn(self, z: Array) -> Array:
        """Draws of standard normals (n, dimension)."""
        stretched: Array = ((z @ self.axes.T) * (np.sqrt(self.variances) - 1.0)) @ self.axes
        return z + stretched + self.centre

    def log_ratio(self, z: Array) -> Array:
        """Logarithm of their density by that of plain draws (n,)."""
        across = z @ self.axes.T
        curved = 0.5 * (across**2 @ (1.0 - 1.0 / self.variances) - np.log(self.variances).sum())
        return np.asarray(z @ self.centre - 0.5 * float(self.centre @ self.centre) + curved)


@dataclass(frozen=True, eq=False)
class Mixture:
    """Mixture of draws at a position.

    Args:
        shapes: of draws about each point.
        normals: unit directions of planes (points, dimension).
        ends: where draws beyond a plane begin (points,).
        plain, around: shares of plain draws, and of those in any direction beyond a radius.
        shares: of each point (points,), half of them about it, half beyond its plane.
        acting: the normals among which that radius is taken.
        radius: it.
    """

    shapes: Sequence[Shape]
    normals: Array
    ends: Array
    plain: float
    around: float
    shares: Array
    acting: NDArray[np.int64]
    radius: float

    @classmethod
    def about(cls, points: Sequence[DesignPoint], state: LimitState, shapes: Sequence[Shape] | None) -> "Mixture":
        """About design points; plain alone without any."""
        if not points:
            none = np.zeros((0, state.dimension))
            return cls((), none, np.zeros(0), 1.0, 0.0, np.zeros(0), state.acting, 0.0)
        distances = np.array([point.distance for point in points])
        plain = PLAIN_IF_COMMON if ndtr(-distances).sum() > COMMON else PLAIN
        likely = np.exp(-0.5 * (distances**2 - distances[0] ** 2))
        likely = np.maximum(likely / likely.sum(), 0.1 / len(points))
        ends = distances - 1.0 / np.maximum(distances, 1.0)
        return cls(
            shapes or [Shape.plain(point) for point in points],
            np.array([point.sensitivities for point in points]),
            ends,
            plain,
            AROUND,
            (1 - plain - AROUND) * likely / likely.sum(),
            state.acting,
            float(ends[0]),
        )

    @property
    def _shares(self) -> Array:
        return np.concatenate([[self.plain, self.around], self.shares / 2, self.shares / 2])

    @property
    def outer(self) -> float:
        """Share of plain draws beyond the radius."""
        return float(gammaincc(max(len(self.acting), 1) / 2, self.radius**2 / 2))

    def drawn(self, count: int, generator: np.random.Generator) -> Array:
        """So many draws (count, dimension)."""
        z = generator.standard_normal((count, self.normals.shape[1]))
        shares, points = self._shares, len(self.shares)
        of = generator.choice(len(shares), size=count, p=shares / shares.sum()) - 2
        far = np.flatnonzero(of == -1)
        if far.size:
            lengths = np.sqrt(2 * gammainccinv(len(self.acting) / 2, generator.random(far.size) * self.outer))
            own = z[np.ix_(far, self.acting)]
            z[np.ix_(far, self.acting)] = own * (lengths / np.linalg.norm(own, axis=1))[:, None]
        for k, shape in enumerate(self.shapes):
            z[of == k] = shape.drawn(z[of == k])
        past = of >= points
        normals, ends = self.normals[of[past] - points], self.ends[of[past] - points]
        lengths = -ndtri(generator.random(len(ends)) * ndtr(-ends))
        z[past] += (lengths - (z[past] * normals).sum(axis=1))[:, None] * normals
        return z

    def log_ratio(self, z: Array) -> tuple[Array, Array]:
        """Logarithm of its density by that of plain draws (n,), and of the part that is not about design points."""
        # φ(z - c) / φ(z) = exp(z·c - c²/2); beyond a plane 1 / Φ(-end), elsewhere 0
        about = np.array([shape.log_ratio(z) for shape in self.shapes]).reshape(len(self.shapes), len(z)).T
        far = (z[:, self.acting] ** 2).sum(axis=1) >= self.radius**2
        with np.errstate(divide="ignore"):
            past = np.log(z @ self.normals.T >= self.ends) - np.log(ndtr(-self.ends))
            outer = np.log(far) - math.log(self.outer)
            parts = np.column_stack([np.zeros(len(z)), outer, about, past]) + np.log(self._shares)
        return np.asarray(logsumexp(parts, axis=1)), np.asarray(logsumexp(parts[:, :2], axis=1))
