"""Variance of a measure by groups of features, by least squares on the trials."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import pairwise
from typing import Self

import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.arrays import Array
from tol3d.statistics.estimates.shapley import grouped_shapley

Places = NDArray[np.intp]

CONSTANT_RTOL = 1e-12  # of the mean, and of the largest feature; a column of a smaller sigma holds rounding errors only
RANK_RTOL = 1e-10  # of the largest eigenvalue of the correlations; columns closer than that say the same
MOST_SHARE = 1.0005  # a share of more prints as over 100 %
BY_CHANCE = 5.0  # over the number of trials; -z²/4n is the least share of an independent group that is z sigma off


Products = Callable[[Array], Array]


def plain_products(rows: Array) -> Array:
    """Sums over the trials of the products of all pairs of rows (rows, trials): (rows, rows).

    By numpy alone: a BLAS product's bits would depend on threads and shapes.
    """
    sums = np.empty((len(rows), len(rows)))
    add_products(sums, rows, range(len(rows)))
    return sums


def add_products(sums: Array, rows: Array, starts: Sequence[int]) -> None:
    """Write the sums of products of pairs of rows, each row with those from its start on.

    Of over 8192 trials the order of a pair's sum, and so its last bits, follow from its place among the rows: numpy
    sums in pieces that do not begin with the rows.
    """
    for i, (row, start) in enumerate(zip(rows, starts, strict=True)):
        sums[i, start:] = sums[start:, i] = np.einsum("j,kj->k", row, rows[start:])


@dataclass(frozen=True, eq=False)
class TargetSums:
    """Means and co-moments of several targets over the same trials, all of which have a value.

    Args:
        count: number of trials.
        means: (targets,).
        comoments: (targets, targets).
    """

    count: int
    means: Array
    comoments: Array

    def of(self, which: Sequence[int]) -> "TargetSums":
        """Sums of some of the targets, in their order."""
        return TargetSums(self.count, self.means[[*which]], self.comoments[np.ix_(which, which)])


@dataclass(frozen=True, eq=False)
class RegressorSums:
    """Count, means and co-moments of feature columns and of the target they explain, gathered block by block.

    A feature is a component of a contributor or a power of it; the target is a measure.

    Args:
        count: number of trials.
        means: (features + 1,), the target last.
        comoments: (features + 1, features + 1) sums over trials of (x_i - mean_i)(x_j - mean_j).
    """

    count: int
    means: Array
    comoments: Array

    @classmethod
    def of(cls, features: Array, target: Array) -> Self:
        """The sums of one block: features (trials, features), target (trials,).

        No NaN in either: the caller leaves failed trials out.
        """
        return cls.of_each(features.T, target[None])[0]

    @classmethod
    def of_each(cls, features: Array, targets: Array, products: Products = plain_products) -> tuple[Self, ...]:
        """The sums of one block for several targets (targets, trials) of the same features (features, trials).

        Args:
            features, targets: as described.
            products: function that sums the products of all pairs of rows (rows, trials) over the trials, (rows, rows).
        """
        every = np.arange(len(features))
        return cls.with_targets(features, targets, products, [every] * len(targets))[0]

    @classmethod
    def with_targets(
        cls, features: Array, targets: Array, products: Products, own: Sequence[Places]
    ) -> tuple[tuple[Self, ...], TargetSums]:
        """The same where each target has `own` of the features, and the sums of the targets among each other.

        They come of the same products.
        """
        count = targets.shape[1]
        if count == 0:
            none = TargetSums(0, np.zeros(len(targets)), np.zeros((len(targets), len(targets))))
            widths = [len(each) + 1 for each in own]
            return tuple(cls(0, np.zeros(width), np.zeros((width, width))) for width in widths), none
        # from the first value, so that a constant column has no spread at all, not a rounding error's;
        # a row each, for the order of a sum, and so its bits, follow the layout in memory
        rows = np.empty((len(features) + len(targets), count))
        rows[: len(features)], rows[len(features) :] = features, targets
        first = rows[:, 0].copy()
        rows -= first[:, None]
        means = np.mean(rows, axis=1)
        rows -= means[:, None]
        comoments = products(rows)
        means += first
        size = len(features)
        each = [np.append(columns, size + k) for k, columns in enumerate(own)]
        among = TargetSums(count, means[size:], comoments[size:, size:])
        return tuple(cls(count, means[which], comoments[np.ix_(which, which)]) for which in each), among

    def merge(self, other: Self) -> Self:
        """The sums of both blocks together; Pebay, SAND2008-6212, 2008 (covariances)."""
        if self.count == 0 or other.count == 0:
            return other if self.count == 0 else self
        count = self.count + other.count
        delta = other.means - self.means
        between = delta[:, None] * delta * (self.count * other.count / count)
        return type(self)(count, self.means + delta * (other.count / count), self.comoments + other.comoments + between)

    @property
    def target_mean(self) -> float:
        """Mean of the target."""
        return float(self.means[-1])

    @property
    def target_sigma(self) -> float:
        """Standard deviation of the target."""
        return math.sqrt(self.comoments[-1, -1] / self.count)


@dataclass(frozen=True)
class Shares:
    """Decomposition of a target's variance; shares and remainder add up to 1 unless the target is constant.

    Args:
        share: the fraction that each group explains.
        standard_error: of each share.
        unexplained: the fraction that no group explains.
        determined: the fraction that the groups explain, less what as many columns of mere noise would (Ezekiel).
    """

    share: Mapping[str, float]
    standard_error: Mapping[str, float]
    unexplained: float
    determined: float


def shares(sums: RegressorSums, groups: Mapping[str, slice], together: Sequence[Sequence[str]] = ()) -> Shares:
    """Split the target's variance among groups of feature columns.

    One least-squares fit on all features; the share of a group is cov(its part of the fit, y) /
    var(y). With independent groups this tends to the group's fraction of the variance; it may come
    out slightly negative by chance. Where some are more negative, or larger than 1, the groups are
    correlated in these trials, as those of builds that could be assembled are: they have relative
    weights instead, which are never negative and explain as much. What no feature follows
    (interactions, higher powers, noise of the engine) is unexplained. Constant columns have no share;
    of columns that say the same each takes its part. q columns of mere noise explain about q / n of
    the unexplained part.

    A constant target has nothing to share: all zeros. With no more rows than the fit has unknowns
    it says nothing: all NaN.

    Args:
        groups: for each name its feature columns; no column in two groups.
        together: names of groups that are correlated with each other; what they explain together is divided by their
            Shapley effects on their part of the fit, none of which is negative.
    """
    features = [column for group in groups.values() for column in range(len(sums.means) - 1)[group]]
    if sums.count <= len(features) + 1:
        return Shares(dict.fromkeys(groups, math.nan), dict.fromkeys(groups, math.nan), math.nan, math.nan)
    sigma = column_sigmas(sums)
    if sigma[-1] == 0:
        return Shares(dict.fromkeys(groups, 0.0), dict.fromkeys(groups, 0.0), 0.0, 1.0)
    used = [column for column in features if sigma[column] > 0]
    explained = _explained(sums, sigma, used)
    share = {name: float(np.sum(explained[group])) for name, group in groups.items()}
    for names in together:
        share |= _divided(sums, sigma, {name: groups[name] for name in names if name in groups}, share)
    if max(share.values(), default=0.0) > MOST_SHARE or min(share.values(), default=0.0) < -BY_CHANCE / sums.count:
        weights = _relative_weights(sums, sigma, used)
        share = {name: float(np.sum(weights[group])) for name, group in groups.items()}
    unexplained = max(1 - sum(share.values()), 0.0)
    errors = {name: _standard_error(value, unexplained, sums.count) for name, value in share.items()}
    determined = 1.0 - unexplained * (sums.count - 1) / (sums.count - 1 - len(used))
    return Shares(share, errors, unexplained, determined)


def column_sigmas(sums: RegressorSums) -> Array:
    """Standard deviation of each column, exactly 0 for one that holds rounding errors only; see feature_sigmas."""
    sigma: Array = np.sqrt(np.diagonal(sums.comoments) / max(sums.count, 1))
    target = sigma[-1:] * (sigma[-1:] > CONSTANT_RTOL * np.abs(sums.means[-1:]))
    return np.concatenate([feature_sigmas(sigma[:-1], sums.means[:-1]), target])


def feature_sigmas(sigma: Array, means: Array) -> Array:
    """Standard deviations of features, exactly 0 for one that holds rounding errors only.

    That is one that is constant, or far smaller than the others: a part that is none by theory.
    """
    return np.where(sigma > CONSTANT_RTOL * np.maximum(np.abs(means), max(sigma, default=0.0)), sigma, 0.0)


def _explained(sums: RegressorSums, sigma: Array, used: list[int]) -> Array:
    """The fraction of the target's variance that each feature explains in the joint fit on `used`, (features,).

    In standardised columns the fit solves R b = r, R the correlations among the features and r
    those with the target; column i explains b_i r_i. R is inverted on its eigenvectors of
    eigenvalue not zero, which gives the shortest b where columns depend on each other.
    """
    explained = np.zeros(len(sigma) - 1)
    if not used:
        return explained
    correlation = _correlations(sums, sigma, [*used, -1])
    r = correlation[:-1, -1]
    modes = factorised(correlation[:-1, :-1])
    along = np.sum(modes.vectors * r[:, None], axis=0) / modes.values
    explained[used] = np.sum(modes.vectors * along, axis=1) * r
    return explained


def _relative_weights(sums: RegressorSums, sigma: Array, used: list[int]) -> Array:
    """The fraction of the target's variance that each feature explains (features,), by relative weights.

    The target is regressed on uncorrelated columns that are closest to the features; what each of these explains
    goes to the features by the squares of their correlations with it. Never negative, and r squared in all.

    Source: Genizi, Decomposition of R² in multiple regression with correlated regressors, Statistica Sinica 3 (1993);
    Johnson, A heuristic method for estimating the relative weight of predictor variables in multiple regression,
    Multivariate Behavioral Research 35 (2000).
    """
    weights = np.zeros(len(sigma) - 1)
    correlation = _correlations(sums, sigma, [*used, -1])
    modes = factorised(correlation[:-1, :-1])
    roots = np.sqrt(modes.values)
    uncorrelated = modes.vectors @ ((modes.vectors.T @ correlation[:-1, -1]) / roots)
    weights[used] = ((modes.vectors * roots) @ modes.vectors.T) ** 2 @ uncorrelated**2
    return weights


def _correlations(sums: RegressorSums, sigma: Array, columns: list[int]) -> Array:
    """Correlations of columns that vary, of all features and the target, among each other."""
    scale = sigma[columns]
    return np.asarray(sums.comoments[np.ix_(columns, columns)] / sums.count / scale / scale[:, None])


def _divided(
    sums: RegressorSums, sigma: Array, groups: Mapping[str, slice], share: Mapping[str, float]
) -> Mapping[str, float]:
    """Shares of groups that are correlated with each other, as many as they have together."""
    columns = [column for group in groups.values() for column in range(len(sums.means) - 1)[group] if sigma[column] > 0]
    if len(groups) < 2 or not columns:
        return {}
    whole = [column for column in range(len(sums.means) - 1) if sigma[column] > 0]
    correlation = _correlations(sums, sigma, [*whole, -1])
    slopes = factorised(correlation[:-1, :-1]).inverse @ correlation[:-1, -1]
    places = [whole.index(column) for column in columns]
    ends = np.cumsum([0, *(sum(sigma[range(len(sigma) - 1)[group]] > 0) for group in groups.values())]).tolist()
    parts = [slice(start, end) for start, end in pairwise(ends)]
    effects = grouped_shapley(slopes[places], correlation[np.ix_(places, places)], parts)
    total, all_effects = sum(share[name] for name in groups), float(effects.sum())
    if not all_effects > 0.0:
        return {}
    return {name: total * float(own) / all_effects for name, own in zip(groups, effects, strict=True)}


@dataclass(frozen=True, eq=False)
class Modes:
    """A matrix of correlations on its eigenvectors, without those of eigenvalue zero.

    Args:
        values: (modes,).
        vectors: (rows, modes).
    """

    values: Array
    vectors: Array

    @cached_property
    def inverse(self) -> Array:
        """Pseudo-inverse of the matrix (rows, rows)."""
        return np.asarray((self.vectors / self.values) @ self.vectors.T)


def factorised(correlation: Array) -> Modes:
    """Modes of a matrix (rows, rows); measures of the same regressors on both methods have the same one."""
    return _modes(np.ascontiguousarray(correlation).tobytes(), len(correlation))


@lru_cache(maxsize=8)
def _modes(content: bytes, size: int) -> Modes:
    eigenvalues, eigenvectors = np.linalg.eigh(np.frombuffer(content).reshape(size, size))
    kept = eigenvalues > RANK_RTOL * max(eigenvalues, default=0.0)
    return Modes(eigenvalues[kept], eigenvectors[:, kept])


def _standard_error(share: float, unexplained: float, count: int) -> float:
    """sqrt((S (1 - S) + S U (3 - 4 S)) / n), S the share and U the unexplained fraction.

    First order in 1 / sqrt(n), for independent normal contributors that act linearly: with U = 0
    it is sqrt(S (1 - S) / n), with a single contributor (U = 1 - S) the 2 r (1 - r^2) / sqrt(n) of
    a squared correlation. Heavier tails make it larger. A share below 0 is noise of its own size.
    """
    share = min(abs(share), 1.0)
    return math.sqrt(max(share * (1 - share) + share * unexplained * (3 - 4 * share), 0.0) / count)
