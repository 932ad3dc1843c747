"""Shapley effects: shares of a variance among contributors that are correlated, or that act together.

Contributors come to be known one after the other, in a random order; a contributor's effect is by how much the variance
that is explained grows when it comes, averaged over orders. The effects are not negative and add up to the whole
variance, also where contributors are correlated. Of Gaussian copulas the conditional laws are known: in a given order
the normals of a block are its Cholesky factor, in that order, times independent ones, so that builds can be walked from
one to another by one independent normal after the other. n such walks of k contributors take n (k + 1) evaluations.

Sources: Song, Nelson, Staum, Shapley effects for global sensitivity analysis, SIAM/ASA J. Uncertain. Quantif. 4 (2016);
Goda, A simple algorithm for global sensitivity analysis with Shapley effects, Reliab. Eng. Syst. Saf. 213 (2021).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from tol3d.analyses.pick_freeze import Pairs, asked, errors_of, resampled
from tol3d.numerics.arrays import Array
from tol3d.study.system.copula import Block

ORDERS: Final = 64
"""Random orders of contributors, each with its reverse."""


@dataclass(frozen=True, eq=False)
class ShapleyEffects:
    """Shares of the variance of values, and of failing, (names, measures), with standard errors.

    Args:
        names: of the contributors.
        values, value_errors: NaN where nothing varies.
        failures, failure_errors: likewise.
    """

    names: tuple[str, ...]
    values: Array
    value_errors: Array
    failures: Array
    failure_errors: Array


def shapley_effects(pairs: Pairs, names: Sequence[str]) -> ShapleyEffects:
    """Effects of contributors, by walks from B to A at the positions of A."""
    response = pairs.response
    orders = list(_orders(len(names), min(ORDERS, pairs.count), pairs.seed))
    rows = np.array_split(np.arange(pairs.count), len(orders))
    columns = [np.arange(own.start, own.stop) for own in (response.normals[name] for name in names)]
    walkers = pairs.second.normals.copy()
    turned = [
        (
            np.array([response.normals[name].start for name in block.names]),
            [_turn(block, _known(names, order, block)) for order in orders],
        )
        for block in response.copula.blocks
    ]
    outcomes = []
    for step in range(len(names) + 1):
        if step:
            for order, mine in zip(orders, rows, strict=True):
                here = np.ix_(mine, columns[order[step - 1]])
                walkers[here] = pairs.first.normals[here]
        normals = walkers.copy()
        for places, turns in turned:
            for turn, mine in zip(turns, rows, strict=True):
                here = np.ix_(mine, places)
                normals[here] = walkers[here] @ turn.T
        outcomes.append(asked(response, response.deviations(normals), pairs.first.positions))
    weights = resampled(pairs.count, pairs.seed)
    ranks = np.array([np.argsort(order) for order in orders]).reshape(len(orders), len(names))
    owners = np.repeat(ranks, [len(row) for row in rows], axis=0)
    values = _shares(np.array([outcome.values for outcome in outcomes]), owners, weights)
    failures = _shares(np.array([outcome.fails for outcome in outcomes]), owners, weights)
    return ShapleyEffects(tuple(names), values[:, 0], errors_of(values), failures[:, 0], errors_of(failures))


def _orders(count: int, orders: int, seed: int) -> Iterator[Sequence[int]]:
    generator = np.random.default_rng([seed, count])
    for _ in range(max(orders // 2, 1)):
        order = generator.permutation(count).tolist()
        yield order
        yield order[::-1]


def _known(names: Sequence[str], order: Sequence[int], block: Block) -> Sequence[str]:
    """Those of a block in the order in which they come to be known."""
    return [names[k] for k in order if names[k] in block.names]


def _turn(block: Block, known: Sequence[str]) -> Array:
    """Turns independent normals of a block, where its names come to be known in an order, to those of the copula."""
    order = [block.names.index(name) for name in known]
    in_order = np.linalg.cholesky(block.correlation[np.ix_(order, order)])
    mixing = np.zeros_like(in_order)
    mixing[np.ix_(order, order)] = in_order
    return np.asarray(np.linalg.solve(block.factor, mixing))


def _shares(walked: Array, owners: Array, weights: Array) -> Array:
    """Shares (names, RESAMPLES + 1, measures) of values along walks (steps + 1, n, measures).

    Args:
        walked: from B to A.
        owners: at which step each name comes (n, names).
        weights: of the rows (RESAMPLES + 1, n).
    """
    whole = np.isfinite(walked).all(axis=0)
    walked = np.where(whole, walked, 0.0)
    before, after, end = walked[:-1], walked[1:], walked[-1]
    growth = (after - before) * (end - (before + after) / 2)  # their sum is (A - B)² / 2
    variance = weights @ growth.sum(axis=0)
    rows = np.arange(walked.shape[1])
    found = np.array([weights @ growth[owners[:, k], rows] for k in range(owners.shape[1])])
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(variance > 0.0, found.reshape(-1, *variance.shape) / variance, np.nan)
