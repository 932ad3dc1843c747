"""Contributors of very many that a target's variance comes from: by the covariance of each with it.

Products of all pairs of features go with the square of their number. Where contributors are independent those between
them are chance, and are left out: each cluster of contributors is regressed on by itself.
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
        """Products of pairs of rows (rows, trials): (pairs,)."""
        ...


@dataclass(frozen=True, eq=False)
class IndependentSums:
    """Count, means and co-moments of features with their target, and with each other within clusters.

    Args:
        clusters: how the features are cut.
        count: number of trials.
        means: (features + 1,), the target last.
        within: (pairs,), of the pairs of `clusters`.
        across: (features,), of each feature with the target.
        square: of the target.
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
            features: (features, trials), no nan.
            targets: (targets, trials), no nan.
            clusters: of all features.
            picked: those that each target has.
            products: function that sums them.
        """
        count = features.shape[1]
        if count == 0:
            return tuple(cls._none(own.clusters) for own in picked)
        rows, means = _centred(features)
        aims, target_means = _centred(targets)
        across = products.cross_products(rows, aims)
        within = products.pair_products(rows, *clusters.pairs)
        squares = np.einsum("ij,ij->i", aims, aims)
        return tuple(
            cls(
                own.clusters,
                count,
                np.append(means[own.rows], target_means[k]),
                within[own.pairs],
                across[own.rows, k],
                float(squares[k]),
            )
            for k, own in enumerate(picked)
        )

    @classmethod
    def _none(cls, clusters: Clusters) -> Self:
        """Sums over no trial."""
        size = clusters.features
        return cls(clusters, 0, np.zeros(size + 1), np.zeros(len(clusters.pairs[0])), np.zeros(size), 0.0)

    def merge(self, other: Self) -> Self:
        """The sums of both blocks together; Pebay, SAND2008-6212, 2008 (covariances)."""
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
        """Standard deviation of the target."""
        return math.sqrt(self.square / self.count)

    @property
    def is_constant(self) -> bool:
        """True if the target does not vary, but for rounding."""
        return self.square == 0.0 or self.target_sigma <= CONSTANT_RTOL * abs(self.target_mean)

    def fits(self) -> Iterator["ClusterFit"]:
        """The least-squares fit of the target on each cluster alone, those of a pattern together."""
        sigma = np.sqrt(np.maximum(self._squares, 0.0) / self.count)
        scale = feature_sigmas(sigma, self.means[:-1])
        for pattern in self.clusters.patterns:
            yield self._fit(pattern, scale[pattern.columns])

    @property
    def _squares(self) -> Array:
        squares = np.zeros(self.clusters.features)
        for pattern in self.clusters.patterns:
            squares[pattern.columns] = np.diagonal(self.within[pattern.pairs], axis1=1, axis2=2)
        return squares

    def _fit(self, pattern: Pattern, scale: Array) -> "ClusterFit":
        per = np.divide(1.0, scale, out=np.zeros_like(scale), where=scale > 0.0)
        both = per[:, :, None] * per[:, None, :]
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
        pattern: which clusters.
        coefficients: (clusters, features of a cluster), unit of the target per unit of the feature.
        covariance: of the coefficients (clusters, features, features).
        spread: covariance of the features.
        explained: (clusters, features), co-moments of the target with the part that each feature explains.
        unknowns: (clusters,), their number in the fit.
    """

    pattern: Pattern
    coefficients: Array
    covariance: Array
    spread: Array
    explained: Array
    unknowns: NDArray[np.intp]


def independent_shares(sums: IndependentSums) -> tuple[Array, Array, float]:
    """The share of the target's variance that each part explains, its standard error, and the unexplained share.

    A cluster's share is r^2 of its own fit less what chance adds to it, (1 - r^2) q / (n - 1 - q) of q unknowns
    (Ezekiel's adjustment), so that no bias adds up over very many parts; by chance it may lie below 0. The error is
    that of a squared correlation, 2 r (1 - r^2) / sqrt(n), of a part of the cluster so much of it; of one by chance
    alone, its own size.

    Returns:
        Both (parts,), fractions; all 0 of a constant target, nan with no more trials than a cluster has unknowns.
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
        whole = 2.0 * np.sqrt(square) * (1.0 - square) / math.sqrt(sums.count)
        whole = np.where(fit.unknowns > 0, np.hypot(whole, chance), 0.0)
        for which, columns in fit.pattern.within():
            part = fit.explained[:, columns].sum(axis=1) / sums.square
            of_all = np.divide(part, square, out=np.full(len(part), 1.0), where=square > 0.0)
            share[which] = part - chance * of_all
            error[which] = whole * np.maximum(np.abs(of_all), 1.0 / len(fit.pattern.sizes))
    return share, error, max(1.0 - float(share.sum()), 0.0)


def _centred(rows: Array) -> tuple[Array, Array]:
    """Rows about their means, and the means; from the first value, so that a constant row has no spread at all."""
    first = rows[:, 0].copy()
    shifted = rows - first[:, None]
    means = np.mean(shifted, axis=1)
    shifted -= means[:, None]
    return shifted, means + first
