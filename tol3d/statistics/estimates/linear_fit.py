"""Least-squares fits of a target on feature columns, with the errors of the effect of each part of the features."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.arrays import Array
from tol3d.statistics.estimates.independent_sums import ClusterFit, IndependentSums
from tol3d.statistics.estimates.variance_shares import RegressorSums, column_sigmas, factorised

Places = NDArray[np.intp]

LEAST_FREEDOM = 30  # rows beyond the fit's unknowns; Student's 5 sigma there is as rare as a normal's 4.2


@dataclass(frozen=True, eq=False)
class PartFit:
    """Fit of parts of as many features each, such as contributors of two regressors.

    Args:
        parts: (parts,), their places among all.
        columns: (parts, features of a part).
        coefficients: (parts, features), in the unit of the target per unit of the feature.
        covariance: (parts, features, features) of the coefficients, for errors that do not depend on the features.
        spread: (parts, features, features), covariance of the features themselves.
    """

    parts: Places
    columns: Places
    coefficients: Array
    covariance: Array
    spread: Array

    @property
    def effects(self) -> Array:
        """Standard deviation of each part's own part of the fit [unit of the target]."""
        return _rooted(np.einsum("pi,pij,pj->p", self.coefficients, self.spread, self.coefficients))

    @property
    def chances(self) -> Array:
        """The same for the part of chance in it: for coefficients that are off by their errors."""
        return _rooted(np.einsum("pij,pji->p", self.covariance, self.spread))

    @property
    def spreads(self) -> Array:
        """Root of the sum of the features' variances."""
        return _rooted(np.trace(self.spread, axis1=1, axis2=2))

    @property
    def standard_errors(self) -> Array:
        """Number of standard errors of the coefficients from 0: the root of Wald's statistic; inf without error."""
        inverse = np.linalg.pinv(self.covariance, hermitian=True)
        found = _rooted(np.einsum("pi,pij,pj->p", self.coefficients, inverse, self.coefficients))
        found[~self.covariance.any(axis=(1, 2))] = math.inf
        found[~self.coefficients.any(axis=1)] = 0.0
        return found


@dataclass(frozen=True, eq=False)
class LinearFit:
    """Coefficients of y = b0 + b x by least squares; features that say the same share theirs, constant ones have 0.

    Args:
        count: rows.
        fits: of all parts, those of as many features together.
        residual: its standard deviation [unit of y].
    """

    count: int
    fits: tuple[PartFit, ...]
    residual: float

    @classmethod
    def of(cls, sums: RegressorSums | IndependentSums, parts: Sequence[slice]) -> Self | None:
        """The fit of the sums' target; None if there are too few rows to distinguish coefficients from chance."""
        return cls._of_all(sums, parts) if isinstance(sums, RegressorSums) else cls._of_clusters(sums)

    @classmethod
    def _of_all(cls, sums: RegressorSums, parts: Sequence[slice]) -> Self | None:
        """All features at once."""
        width, sigma = len(sums.means) - 1, column_sigmas(sums)
        used = np.flatnonzero(sigma[:-1] > 0.0)
        freedom = sums.count - len(used) - 1
        if freedom < LEAST_FREEDOM:
            return None
        scale = sigma[used]
        correlation = sums.comoments[np.ix_(used, used)] / sums.count / scale / scale[:, None]
        inverse = factorised(correlation).inverse / scale / scale[:, None] / sums.count
        coefficients, covariance = np.zeros(width), np.zeros((width, width))
        coefficients[used] = inverse @ sums.comoments[used, -1]
        left = max(float(sums.comoments[-1, -1] - coefficients @ sums.comoments[:-1, -1]), 0.0)
        covariance[np.ix_(used, used)] = inverse * left / freedom
        spread = sums.comoments[:-1, :-1] / sums.count
        fits = []
        for size in dict.fromkeys(part.stop - part.start for part in parts):
            which = np.array([k for k, own in enumerate(parts) if own.stop - own.start == size], dtype=np.intp)
            columns = np.array([parts[k].start for k in which], dtype=np.intp)[:, None] + np.arange(size)
            block = columns[:, :, None], columns[:, None, :]
            fits.append(PartFit(which, columns, coefficients[columns], covariance[block], spread[block]))
        return cls(sums.count, tuple(fits), math.sqrt(left / freedom))

    @classmethod
    def _of_clusters(cls, sums: IndependentSums) -> Self | None:
        """Each cluster by itself; the effects of others are in the errors of its coefficients."""
        widest = max((pattern.columns.shape[1] for pattern in sums.clusters.patterns), default=0)
        if sums.count - widest - 1 < LEAST_FREEDOM:
            return None
        found = list(sums.fits())
        explained = sum((_beyond_chance(own, sums) for own in found), 0.0)
        parts = [own for fit in found for own in _parts_of(fit)]
        left = max(1.0 - explained, 0.0) * sums.square
        return cls(sums.count, tuple(parts), math.sqrt(left / (sums.count - 1)))

    @property
    def parts(self) -> int:
        """Number of parts."""
        return sum(len(fit.parts) for fit in self.fits)

    @property
    def effects(self) -> Array:
        """See PartFit, (parts,)."""
        return self._of_each([fit.effects for fit in self.fits])

    @property
    def chances(self) -> Array:
        """See PartFit, (parts,)."""
        return self._of_each([fit.chances for fit in self.fits])

    @property
    def spreads(self) -> Array:
        """See PartFit, (parts,)."""
        return self._of_each([fit.spreads for fit in self.fits])

    @property
    def standard_errors(self) -> Array:
        """See PartFit, (parts,)."""
        return self._of_each([fit.standard_errors for fit in self.fits])

    def reaches(self, features: Array) -> Array:
        """Size of one row (features,) of the features in each part, in units of `spreads`; 0 without any."""
        sizes = self._of_each([np.hypot.reduce(features[fit.columns], axis=1) for fit in self.fits])
        spreads = self.spreads
        return np.divide(sizes, spreads, out=np.zeros(len(sizes)), where=spreads > 0.0)

    def variances(self, part: int) -> Array:
        """Variances of the features (features of a part,) of one part."""
        fit, place = next((own, k) for own in self.fits for k in np.flatnonzero(own.parts == part))
        return np.diagonal(fit.spread[place])

    def less(self, other: "LinearFit") -> "LinearFit":
        """The fit of the difference of both targets, if they were fitted on trials of their own: errors add up."""
        fits = tuple(
            replace(
                mine, coefficients=mine.coefficients - its.coefficients, covariance=mine.covariance + its.covariance
            )
            for mine, its in zip(self.fits, other.fits, strict=True)
        )
        return replace(self, fits=fits)

    def _of_each(self, found: Sequence[Array]) -> Array:
        values = np.zeros(self.parts)
        for fit, own in zip(self.fits, found, strict=True):
            values[fit.parts] = own
        return values


def _beyond_chance(fit: ClusterFit, sums: IndependentSums) -> float:
    """The part of the target's variance that clusters explain, less what chance adds to it."""
    square = fit.explained.sum(axis=1) / (sums.square or 1.0)
    return float(np.sum(square - (1.0 - square) * fit.unknowns / (sums.count - 1 - fit.unknowns)))


def _parts_of(fit: ClusterFit) -> list[PartFit]:
    return [
        PartFit(
            which,
            fit.pattern.columns[:, own],
            fit.coefficients[:, own],
            fit.covariance[:, own, own],
            fit.spread[:, own, own],
        )
        for which, own in fit.pattern.within()
    ]


def _rooted(values: Array) -> Array:
    return np.asarray(np.sqrt(np.maximum(values, 0.0)))
