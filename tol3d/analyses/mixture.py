"""Mixture for importance sampling at a position: plain draws, and draws about design points.

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
"""Share of plain draws, so that no failing build is left out."""
PLAIN_IF_COMMON: Final = 0.5
"""The same where failures are COMMON."""
AROUND: Final = 0.1
"""Share of the draws in any direction beyond the distance of the nearest design point: it bounds all weights there."""
WIDEST: Final = 6.0
"""Largest variance along directions in which the limit bends towards the origin."""
LEAST_CURVED: Final = 0.02
"""Excess of a variance over 1 from which on it is followed."""
NEAREST_CENTRE: Final = 0.3
"""Least distance of a curved shape's centre, as a fraction of that of its design point."""
LEAST_SHARE: Final = 0.1
"""Least likelihood of a design point, as a fraction of an equal share."""
COMMON: Final = 1e-3
"""Probability by first order from which on half of the draws are plain."""


@dataclass(frozen=True, eq=False)
class Shape:
    """Normal distribution about a design point, as the limit curves there.

    Args:
        centre: its mean (dimension,), on the ray of the design point.
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
        """Shape of the failures to second order: variances 1/(1 + β κ) across the ray, and their mean along it.

        Only directions in which the limit bends towards the origin (κ < 0) are followed.
        """
        if not point.smooth or not point.gradient.any():
            return cls.plain(point)
        values, axes = curvatures(state, point)
        values = -values if point.beyond else values
        variances = 1.0 / np.clip(1.0 + point.distance * values, 1.0 / WIDEST, 1.0)
        kept = variances - 1.0 > LEAST_CURVED
        along = point.distance + float((values * variances)[kept].sum()) / 2
        along = max(NEAREST_CENTRE * point.distance, along)
        return cls(along * point.sensitivities, axes[kept], variances[kept])

    def drawn(self, z: Array) -> Array:
        """Draws of this distribution from standard normals z (n, dimension)."""
        stretched: Array = ((z @ self.axes.T) * (np.sqrt(self.variances) - 1.0)) @ self.axes
        return z + stretched + self.centre

    def log_ratio(self, z: Array) -> Array:
        """Logarithm of its density over that of plain draws, at z (n, dimension): (n,)."""
        across = z @ self.axes.T
        curved = 0.5 * (across**2 @ (1.0 - 1.0 / self.variances) - np.log(self.variances).sum())
        return np.asarray(z @ self.centre - 0.5 * float(self.centre @ self.centre) + curved)


@dataclass(frozen=True, eq=False)
class Mixture:
    """Mixture of draws at a position.

    Args:
        shapes: distribution about each design point.
        normals: unit directions of the planes through them (points, dimension).
        ends: distance from which on draws beyond a plane lie (points,).
        plain, around: shares of plain draws, and of those in any direction beyond the radius.
        shares: of each point (points,), half of them about it, half beyond its plane.
        acting: indices of the normals that act, whose norm the radius is.
        radius: distance from which on draws in any direction lie.
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
        """Mixture about design points, the nearest first; plain draws alone without any."""
        if not points:
            none = np.zeros((0, state.dimension))
            return cls((), none, np.zeros(0), 1.0, 0.0, np.zeros(0), state.acting, 0.0)
        distances = np.array([point.distance for point in points])
        plain = PLAIN_IF_COMMON if ndtr(-distances).sum() > COMMON else PLAIN
        likely = np.exp(-0.5 * (distances**2 - distances[0] ** 2))
        likely = np.maximum(likely / likely.sum(), LEAST_SHARE / len(points))
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
        """Draws of the mixture (count, dimension)."""
        z = generator.standard_normal((count, self.normals.shape[1]))
        shares, points = self._shares, len(self.shares)
        component = generator.choice(len(shares), size=count, p=shares / shares.sum()) - 2  # -2 plain, -1 around
        far = np.flatnonzero(component == -1)
        if far.size:
            lengths = np.sqrt(2 * gammainccinv(len(self.acting) / 2, generator.random(far.size) * self.outer))
            directions = z[np.ix_(far, self.acting)]
            z[np.ix_(far, self.acting)] = directions * (lengths / np.linalg.norm(directions, axis=1))[:, None]
        for k, shape in enumerate(self.shapes):
            z[component == k] = shape.drawn(z[component == k])
        past = component >= points
        normals, ends = self.normals[component[past] - points], self.ends[component[past] - points]
        lengths = -ndtri(generator.random(len(ends)) * ndtr(-ends))
        z[past] += (lengths - (z[past] * normals).sum(axis=1))[:, None] * normals
        return z

    def log_ratio(self, z: Array) -> tuple[Array, Array]:
        """Logarithm of its density over that of plain draws (n,), and that of its plain and around components alone."""
        # φ(z - c) / φ(z) = exp(z·c - c²/2); beyond a plane 1 / Φ(-end), elsewhere 0
        about = np.array([shape.log_ratio(z) for shape in self.shapes]).reshape(len(self.shapes), len(z)).T
        far = (z[:, self.acting] ** 2).sum(axis=1) >= self.radius**2
        with np.errstate(divide="ignore"):
            past = np.log(z @ self.normals.T >= self.ends) - np.log(ndtr(-self.ends))
            outer = np.log(far) - math.log(self.outer)
            parts = np.column_stack([np.zeros(len(z)), outer, about, past]) + np.log(self._shares)
        return np.asarray(logsumexp(parts, axis=1)), np.asarray(logsumexp(parts[:, :2], axis=1))
