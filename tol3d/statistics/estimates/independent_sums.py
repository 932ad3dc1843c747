"""Variance shares of very many independent contributors, by the covariance of each with the target.

The products of all pairs of features grow with the square of their number. Between independent contributors they are
chance, and are left out: the target is regressed on each cluster of contributors alone.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Protocol, Self

import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.arrays import Array
from tol3d.statistics.estimates.clusters import Clusters, Pattern, Picked
from tol3d.statistics.estimates.variance_shares import CONSTANT_RTOL, RANK_RTOL, feature_sigmas


class Products(Protocol):
    """Sums of products over trials."""

    def cross_products(self, features: Array, targets: Array) -> Array:
        """Cross products of each feature (features, trials) and each target (targets, trials): (features, targets)."""
        ...

    def pair_products(self, rows: Array, first: NDArray[np.intp], second: NDArray[np.intp]) -> Array:
        """Sums of products of pairs of rows (rows, trials): (pairs,)."""
        ...


@dataclass(frozen=True, eq=False)
class IndependentSums:
    """Count, means and co-moments of features with their target, and with each other within clusters.

    Co-moments are sums of products of deviations from the means.

    Args:
        clusters: of the features.
        count: number of trials.
        means: (features + 1,), the target last.
        within: (pairs,), co-moments of the pairs of `clusters`.
        across: (features,), co-moment of each feature with the target.
        square: co-moment of the target with itself.
    """

    clusters: Clusters
    count: int
    means: Array
    within: Array
    across: Array
    square: float

    @classmethod
    def of_each(
        cls,
        features: Array,
        targets: Array,
        clusters: Clusters,
        picked: Sequence[Picked],
        products: Products,
    ) -> tuple[Self, ...]:
        """The sums of one block for several targets.

        Args:
            features: (features, trials), without NaN.
            targets: (targets, trials), without NaN.
            clusters: of all features.
            picked: clusters and features of each target.
            products: functions that sum products over trials.
        """
        count = features.shape[1]
        if count == 0:
            return tuple(cls._none(part.clusters) for part in picked)
        rows, means = _centred(features)
        target_rows, target_means = _centred(targets)
        across = products.cross_products(rows, target_rows)
        within = products.pair_products(rows, *clusters.pairs)
        squares = np.einsum("ij,ij->i", target_rows, target_rows)
        return tuple(
            cls(
                part.clusters,
                count,
                np.append(means[part.rows], target_means[k]),
                within[part.pairs],
                across[part.rows, k],
                float(squares[k]),
            )
            for k, part in enumerate(picked)
        )

    @classmethod
    def _none(cls, clusters: Clusters) -> Self:
        """Sums over no trials."""
        size = clusters.features
        return cls(clusters, 0, np.zeros(size + 1), np.zeros(len(clusters.pairs[0])), np.zeros(size), 0.0)

    def merge(self, other: Self) -> Self:
        """The sums of two blocks together. Source: Pebay, SAND2008-6212, 2008 (covariances)."""
        if self.count == 0 or other.count == 0:
            return other if self.count == 0 else self
        count = self.count + other.count
        delta = other.means - self.means
        between = self.count * other.count / count
        first, second = self.clusters.pairs
        return type(self)(
            self.clusters,
            count,
            self.means + delta * (other.count / count),
            self.within + other.within + delta[first] * delta[second] * between,
            self.across + other.across + delta[:-1] * (delta[-1] * between),
            self.square + other.square + float(delta[-1]) ** 2 * between,
        )

    @property
    def target_mean(self) -> float:
        """Mean of the target."""
        return float(self.means[-1])

    @property
    def target_sigma(self) -> float:
        """Standard deviation of the target, with the number of trials as divisor."""
        return math.sqrt(self.square / self.count)

    @property
    def is_constant(self) -> bool:
        """True if the target varies by rounding alone."""
        return self.square == 0.0 or self.target_sigma <= CONSTANT_RTOL * abs(self.target_mean)

    def fits(self) -> Iterator["ClusterFit"]:
        """Least-squares fits of the target on each cluster alone, one result per pattern of clusters."""
        sigma = np.sqrt(np.maximum(self._squares, 0.0) / self.count)
        scale = feature_sigmas(sigma, self.means[:-1])
        for pattern in self.clusters.patterns:
            yield self._fit(pattern, scale[pattern.columns])

    @property
    def _squares(self) -> Array:
        """Co-moment of each feature with itself (features,)."""
        squares = np.zeros(self.clusters.features)
        for pattern in self.clusters.patterns:
            squares[pattern.columns] = np.diagonal(self.within[pattern.pairs], axis1=1, axis2=2)
        return squares

    def _fit(self, pattern: Pattern, scale: Array) -> "ClusterFit":
        """Fits on the clusters of a pattern; `scale` (clusters, features) of features, 0 of those that are constant."""
        per_scale = np.divide(1.0, scale, out=np.zeros_like(scale), where=scale > 0.0)
        both = per_scale[:, :, None] * per_scale[:, None, :]
        comoments, across = self.within[pattern.pairs], self.across[pattern.columns]
        values, vectors = np.linalg.eigh(comoments * both / self.count)
        kept = values > RANK_RTOL * np.maximum(values[:, -1:], 0.0)
        inverse = np.divide(1.0, values, out=np.zeros_like(values), where=kept)
        inverses = np.einsum("gik,gk,gjk->gij", vectors, inverse, vectors) * both / self.count
        coefficients = np.einsum("gij,gj->gi", inverses, across)
        unknowns = np.count_nonzero(kept, axis=1)
        left = np.maximum(self.square - np.einsum("gi,gi->g", coefficients, across), 0.0)
        freedom = np.maximum(self.count - 1 - unknowns, 1)
        return ClusterFit(
            pattern,
            coefficients,
            inverses * (left / freedom)[:, None, None],
            comoments / self.count,
            coefficients * across,
            unknowns,
        )


@dataclass(frozen=True, eq=False)
class ClusterFit:
    """Least-squares fits of a target on clusters of one pattern, each alone.

    Args:
        pattern: of the clusters.
        coefficients: (clusters, features of a cluster), unit of the target per unit of the feature.
        covariance: of the coefficients (clusters, features, features).
        spread: covariance of the features (clusters, features, features).
        explained: (clusters, features), co-moment of the target with coefficient times feature.
        unknowns: (clusters,), number of independent features in the fit.
    """

    pattern: Pattern
    coefficients: Array
    covariance: Array
    spread: Array
    explained: Array
    unknowns: NDArray[np.intp]


def independent_shares(sums: IndependentSums) -> tuple[Array, Array, float]:
    """Fraction of the target's variance explained by each part, its standard error, and the unexplained fraction.

    A cluster's share is r^2 of its own fit less the part expected by chance, (1 - r^2) q / (n - 1 - q) for q unknowns
    (Ezekiel's adjustment), so that no bias adds up over very many parts; it may be below 0 by chance. Its error is that
    of a squared correlation, 2 r (1 - r^2) / sqrt(n), combined with the part by chance; a part of a cluster has its
    proportion of both.

    Returns:
        Shares and errors (parts,) and the unexplained fraction; all 0 for a constant target, NaN unless the trials
        exceed the features of the largest cluster by two.
    """
    parts = len(sums.clusters.sizes)
    share, error = np.zeros(parts), np.zeros(parts)
    widest = max((pattern.columns.shape[1] for pattern in sums.clusters.patterns), default=0)
    if sums.count <= widest + 1:
        return np.full(parts, np.nan), np.full(parts, np.nan), math.nan
    if sums.is_constant:
        return share, error, 0.0
    for fit in sums.fits():
        square = np.clip(fit.explained.sum(axis=1) / sums.square, 0.0, 1.0)
        chance = (1.0 - square) * fit.unknowns / (sums.count - 1 - fit.unknowns)
        sampling = 2.0 * np.sqrt(square) * (1.0 - square) / math.sqrt(sums.count)
        cluster_error = np.where(fit.unknowns > 0, np.hypot(sampling, chance), 0.0)
        for which, columns in fit.pattern.within():
            part = fit.explained[:, columns].sum(axis=1) / sums.square
            proportion = np.divide(part, square, out=np.full(len(part), 1.0), where=square > 0.0)
            share[which] = part - chance * proportion
            error[which] = cluster_error * np.maximum(np.abs(proportion), 1.0 / len(fit.pattern.sizes))
    return share, error, max(1.0 - float(share.sum()), 0.0)


def _centred(rows: Array) -> tuple[Array, Array]:
    """Rows about their means, and the means; from the first value, so that constant rows have no spread at all."""
    first = rows[:, 0].copy()
    shifted = rows - first[:, None]
    means = np.mean(shifted, axis=1)
    shifted -= means[:, None]
    return shifted, means + first
