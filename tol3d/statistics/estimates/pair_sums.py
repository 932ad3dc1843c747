"""Pearson's correlations of several columns, gathered block by block; trials may lack the values of some columns."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
import scipy
from numpy.typing import NDArray

from tol3d.numerics.arrays import Array
from tol3d.statistics.estimates.limits import CONFIDENCE
from tol3d.statistics.estimates.variance_shares import CONSTANT_RTOL, Products, TargetSums, add_products, plain_products

Counts = NDArray[np.int64]

LOST_RTOL = 1e-6  # of the squares about a column's own mean; less is left with fewer than ten digits
FISHER_FREEDOM = 3  # trials that Fisher's transformation takes


@dataclass(frozen=True, eq=False)
class PairSums:
    """Counts, means and co-moments of all pairs of columns, each over the trials that have both of its values.

    Args:
        counts: (columns, columns), number of those trials.
        means: (columns, columns), [i, j] that of column i over them; 0 if there are none.
        squares: (columns, columns), [i, j] the sum over them of (x_i - means[i, j])^2.
        comoments: (columns, columns), the sum over them of (x_i - means[i, j])(x_j - means[j, i]).
    """

    counts: Counts
    means: Array
    squares: Array
    comoments: Array

    @classmethod
    def of(
        cls, columns: Sequence[Array], products: Products = plain_products, known: Sequence[TargetSums] = ()
    ) -> Self:
        """The sums of one block.

        Args:
            columns: each (trials,), NaN where a trial has no value.
            products: function that sums the products of all pairs of rows (rows, trials) over the trials, (rows, rows).
            known: sums of the first columns, of the next ones ..., of all of them, by the same products; without any
                they are worked out. No trial lacks a value then.
        """
        if known:
            return cls._of_known(columns, products, known)
        failing = [np.isnan(column) for column in columns if np.isnan(np.min(column, initial=0.0))]
        if not failing:
            return cls._of_whole(np.stack(columns), products)
        some_lack = np.logical_or.reduce(failing)
        whole, rest = np.flatnonzero(~some_lack), np.flatnonzero(some_lack)
        others = np.stack([column[rest] for column in columns])
        others = others[:, ~np.isnan(others).all(axis=0)]
        found = cls._of_whole(np.stack([column[whole] for column in columns]), products)
        return found.merge(cls._of_pairs(others, products)) if others.size else found

    @classmethod
    def _of_known(cls, columns: Sequence[Array], products: Products, known: Sequence[TargetSums]) -> Self:
        """Sums over trials that have all values, where the sums within groups of columns are known."""
        if len(known) == 1:
            return cls._of_sums(known[0])
        if products is not plain_products:  # compiled ones are quicker than what could be left out
            return cls._of_whole(np.stack(columns), products)

        def between_groups(rows: Array) -> Array:
            sums = np.empty((len(rows), len(rows)))
            ends = np.cumsum([len(own.means) for own in known]).tolist()
            for own, end in zip(known, ends, strict=True):
                sums[end - len(own.means) : end, end - len(own.means) : end] = own.comoments
            add_products(sums, rows, [end for own, end in zip(known, ends, strict=True) for _ in own.means])
            return sums

        return cls._of_whole(np.stack(columns), between_groups)

    @classmethod
    def _of_sums(cls, target_sums: TargetSums) -> Self:
        size, squares = len(target_sums.means), np.diagonal(target_sums.comoments)
        counts = np.full((size, size), target_sums.count, dtype=np.int64)
        return cls(
            counts, np.tile(target_sums.means[:, None], size), np.tile(squares[:, None], size), target_sums.comoments
        )

    @classmethod
    def _of_whole(cls, rows: Array, products: Products) -> Self:
        """Sums over trials that have all values; the rows (columns, trials) are centred in place."""
        size, count = rows.shape
        if count == 0:
            return cls(np.zeros((size, size), dtype=np.int64), *(np.zeros((size, size)) for _ in range(3)))
        # from the first value, so that a constant column has no spread at all, not a rounding error's
        first = rows[:, 0].copy()
        rows -= first[:, None]
        means = np.mean(rows, axis=1)
        rows -= means[:, None]
        comoments = products(rows)
        means += first
        return cls._of_sums(TargetSums(count, means, comoments))

    @classmethod
    def _of_pairs(cls, rows: Array, products: Products) -> Self:
        """Sums over trials (columns, trials) that lack some values: about each column's mean, shifted for each pair.

        Where next to nothing is left by the shift, because a pair's trials lie close together and far from the mean of
        the column, the pair is summed by itself.
        """
        size, known = len(rows), ~np.isnan(rows)
        first = np.where(known.any(axis=1), rows[np.arange(size), known.argmax(axis=1)], 0.0)
        shifted = np.where(known, rows - first[:, None], 0.0)
        own = np.sum(shifted, axis=1) / np.maximum(np.count_nonzero(known, axis=1), 1)
        centred = np.where(known, shifted - own[:, None], 0.0)
        sums = products(np.concatenate([centred, centred * centred, known]))
        columns, squared, ones = (slice(k * size, (k + 1) * size) for k in range(3))
        counts = np.rint(sums[ones, ones]).astype(np.int64)
        totals, about_own = sums[columns, ones], sums[squared, ones]
        several, divisor = counts > 1, np.maximum(counts, 1)
        means = np.where(counts > 0, (first + own)[:, None] + totals / divisor, 0.0)
        squares = np.where(several, np.maximum(about_own - totals * totals / divisor, 0.0), 0.0)
        comoments = np.where(several, sums[columns, columns] - totals * totals.T / divisor, 0.0)
        np.fill_diagonal(squares, np.diagonal(comoments))  # the same sums, to the last bit too
        lost = several & (squares < LOST_RTOL * about_own)
        for i, j in np.argwhere(np.triu(lost | lost.T)).tolist():
            pair = cls._of_whole(rows[[i, j]][:, known[i] & known[j]], plain_products)
            means[i, j], means[j, i] = pair.means[:, 0]
            squares[i, j], squares[j, i] = pair.squares[:, 0]
            comoments[i, j] = comoments[j, i] = pair.comoments[0, 1]
        return cls(counts, means, squares, comoments)

    def of_columns(self, which: Sequence[int]) -> Self:
        """The sums of some of the columns, in their order."""
        own = np.ix_(which, which)
        return type(self)(self.counts[own], self.means[own], self.squares[own], self.comoments[own])

    def merge(self, other: Self) -> Self:
        """The sums of both blocks together; Pebay, SAND2008-6212, 2008 (covariances)."""
        counts = self.counts + other.counts
        weight = other.counts / np.maximum(counts, 1)
        delta = other.means - self.means
        between = self.counts * weight
        return type(self)(
            counts,
            self.means + delta * weight,
            self.squares + other.squares + delta * delta * between,
            self.comoments + other.comoments + delta * delta.T * between,
        )

    @property
    def correlations(self) -> Array:
        """Pearson's r (columns, columns); NaN where a pair has one trial or none, or one of its columns is constant."""
        sigma = np.sqrt(self.squares / np.maximum(self.counts, 1))
        varies = (sigma > CONSTANT_RTOL * np.abs(self.means)) & (self.counts > 1)
        unknown = np.full(self.means.shape, np.nan)
        spread = np.sqrt(self.squares * self.squares.T)
        r = np.divide(self.comoments, spread, out=unknown, where=varies & varies.T)
        return np.asarray(np.clip(r, -1.0, 1.0))

    def interval(self, confidence: float = CONFIDENCE) -> tuple[Array, Array]:
        """Bounds (columns, columns) that hold each true correlation with this confidence; NaN for three trials or less.

        artanh r is near a normal of standard error 1 / sqrt(n - 3) (Fisher 1921). For independent trials, and columns
        that are near normal: heavy tails make it too short.
        """
        half = fisher_half_width(self.counts, confidence)
        with np.errstate(divide="ignore"):
            middle = np.arctanh(self.correlations)
        return np.tanh(middle - half), np.tanh(middle + half)


def fisher_half_width(counts: Counts, confidence: float = CONFIDENCE) -> Array:
    """Half the interval of artanh r of some trials; NaN for three or less. Its tanh is the noise of r about 0."""
    freedom = np.where(counts > FISHER_FREEDOM, counts - float(FISHER_FREEDOM), np.nan)
    return np.asarray(float(scipy.special.ndtri((1 + confidence) / 2)) / np.sqrt(freedom))
