"""Sobol' indices of inputs by pick and freeze: pairs of builds that have all in common but one input.

An input is all standard normals of a contributor, or of several that are correlated. Of n pairs of builds A and B each
input takes n more: A with that input of B. By Jansen's formulas the first index is 1 less the mean of (B - mixed)²,
halved, and the total index the mean of (A - mixed)², halved, each as a share of the mean of (A - B)², halved. All
three have the same positions, so that a position has no part in any of them: they are the variances at a position,
averaged.

Builds without a value are left out in pairs: a row counts where all three of them have one.

Sources: Saltelli et al., Variance based sensitivity analysis of model output, Comput. Phys. Commun. 181 (2010);
Jansen, Analysis of variance designs for model output, Comput. Phys. Commun. 117 (1999).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

from tol3d.analyses.response import Response
from tol3d.numerics.arrays import Array
from tol3d.statistics.samplers import Sobol, Stream
from tol3d.study.system.dependent import reads_of
from tol3d.study.system.normals import LEAST, MOST

MOST_EVEN: Final = 4096
"""Dimensions up to which points are Sobol's; beyond them they are random."""
RESAMPLES: Final = 200
"""Resamples of the bootstrap."""
NORMAL_95: Final = 1.959964
POSITION: Final = "position"
"""The input that positions are, where they are one."""


@dataclass(frozen=True, eq=False)
class Builds:
    """Builds (n,) as standard normals, with their positions.

    Args:
        normals: (n, dimension).
        positions: of the system's streams, (n,) each.
        deviations: of the normals (n, components).
    """

    normals: Array
    positions: Mapping[str, Array]
    deviations: Array


@dataclass(frozen=True)
class Input:
    """Input: contributors varied together.

    Args:
        names: of contributors; none where it is the position.
    """

    names: tuple[str, ...]


def inputs_of(response: Response, *, position: bool = False) -> tuple[Input, ...]:
    """Contributors that act on some of the measures, correlated ones together; last the position, if asked for."""
    acting = acting_names(response)
    together = {name: block.names for block in response.copula.blocks for name in block.names}
    groups = dict.fromkeys(together.get(contributor.name, (contributor.name,)) for contributor in response.contributors)
    found = [Input(group) for group in groups if acting.intersection(group)]
    return (*found, Input(())) if position else tuple(found)


def acting_names(response: Response) -> frozenset[str]:
    """Contributors that act on some of the measures, and those that they read."""
    known = {contributor.name: contributor for contributor in response.contributors}
    names = {own.name for measure in response.measures for own in response.acting(measure)}
    while added := {name for own in names for name in reads_of(known[own])} - names:
        names |= added
    return frozenset(names)


@dataclass(frozen=True, eq=False)
class Pairs:
    """Pairs of builds A and B, from Sobol' points or random ones.

    Args:
        response: whose normals they are of.
        count: of pairs; a power of two.
        seed: of the points.
        as_input: whether B has positions of its own.
    """

    response: Response
    count: int
    seed: int
    as_input: bool = False

    @cached_property
    def _uniforms(self) -> Array:
        """(dimensions, count): positions of A, of B if these are its own, normals of A, of B."""
        streams = len(self.response.simulation.system.streams) * (2 if self.as_input else 1)
        size = streams + 2 * self.response.dimension
        if size > MOST_EVEN:
            return np.asarray(np.random.default_rng(self.seed).random((size, self.count)))
        sampler = Sobol(self.seed, self.count, size)
        return np.array([sampler.uniforms(Stream("pair", str(k), k), 0, self.count) for k in range(size)])

    @cached_property
    def first(self) -> Builds:
        """A."""
        return self._built(0)

    @cached_property
    def second(self) -> Builds:
        """B."""
        return self._built(1)

    def _built(self, which: int) -> Builds:
        system, size = self.response.simulation.system, self.response.dimension
        streams = len(system.streams)
        uniforms = np.clip(self._uniforms, LEAST, MOST)
        start = which * streams if self.as_input else 0
        positions = system.positions(dict(zip(system.streams, uniforms[start : start + streams], strict=True)))
        start = (2 if self.as_input else 1) * streams + which * size
        normals = np.ascontiguousarray(ndtri(uniforms[start : start + size]).T).reshape(self.count, size)
        return Builds(normals, positions, self.response.deviations(normals))

    def mixed(self, own: Input) -> Builds:
        """A with an input of B."""
        a, b, response = self.first, self.second, self.response
        if not own.names:
            return Builds(a.normals, b.positions, a.deviations)
        normals = a.normals.copy()
        for name in own.names:
            normals[:, response.normals[name]] = b.normals[:, response.normals[name]]
        if any(name in self._read for name in own.names):
            return Builds(normals, a.positions, response.deviations(normals))
        deviations = a.deviations.copy()
        for name in own.names:
            deviations[:, response.slices[name]] = b.deviations[:, response.slices[name]]
        return Builds(normals, a.positions, deviations)

    @cached_property
    def _read(self) -> frozenset[str]:
        """Contributors that read others or are read: their deviations are not of their own normals alone."""
        readers = {
            contributor.name: reads_of(contributor)
            for contributor in self.response.contributors
            if reads_of(contributor)
        }
        return frozenset(readers).union(*readers.values())


@dataclass(frozen=True, eq=False)
class Indices:
    """Sobol' indices of inputs (inputs, measures), NaN where nothing varies, with their standard errors.

    Args:
        first, first_errors: shares of an input alone.
        total, total_errors: of it with all that it interacts with.
        sums, sum_errors: of first indices, then of total ones (2, measures).
        variance: (measures,) of the measure at a position, averaged, in its unit squared.
    """

    first: Array
    first_errors: Array
    total: Array
    total_errors: Array
    sums: Array
    sum_errors: Array
    variance: Array


@dataclass(frozen=True, eq=False)
class PickFreeze:
    """Results of pairs of builds for their inputs.

    Args:
        inputs: the inputs.
        values: indices of the measures.
        failures: indices of a build out of limits, or not assembled.
        seated: of A and B (2n, measures).
        failing: likewise.
        rows: (measures,) pairs of which both have a value.
        mean: (measures,) of A and B.
    """

    inputs: tuple[Input, ...]
    values: Indices
    failures: Indices
    seated: NDArray[np.bool_]
    failing: NDArray[np.bool_]
    rows: NDArray[np.int64]
    mean: Array


def pick_freeze(pairs: Pairs, inputs: Sequence[Input]) -> PickFreeze:
    """Ask a response of pairs of builds; n (inputs + 2) evaluations."""
    response = pairs.response
    first, second = (asked(response, own.deviations, own.positions) for own in (pairs.first, pairs.second))
    weights = resampled(pairs.count, pairs.seed)
    values, failures = _Gathered(first.values, second.values, weights), _Gathered(first.fails, second.fails, weights)
    for own in inputs:
        builds = pairs.mixed(own)
        mixed = asked(response, builds.deviations, builds.positions)
        values.add(mixed.values)
        failures.add(mixed.fails)
    both = np.isfinite(first.values) & np.isfinite(second.values)
    every = np.concatenate([first.values, second.values])
    valid = np.isfinite(every)
    with np.errstate(invalid="ignore"):
        mean = np.where(valid, every, 0.0).sum(axis=0) / valid.sum(axis=0)
    failing = np.concatenate([first.fails, second.fails]) > 0.0
    return PickFreeze(tuple(inputs), values.indices, failures.indices, valid, failing, both.sum(axis=0), mean)


def resampled(count: int, seed: int) -> Array:
    """Counts of each row (RESAMPLES + 1, count): once each, then as bootstraps draw them."""
    generator = np.random.default_rng([seed, count])
    drawn = [np.bincount(generator.integers(count, size=count), minlength=count) for _ in range(RESAMPLES)]
    return np.array([np.ones(count), *drawn], dtype=np.float64)


@dataclass(frozen=True, eq=False)
class Outcome:
    """Values (n, measures), NaN where a build cannot be assembled, and 1.0 where it fails."""

    values: Array
    fails: Array


def asked(response: Response, deviations: Array, positions: Mapping[str, Array]) -> Outcome:
    """Outcome of builds."""
    found = response.values(deviations, positions)
    values = np.where(found.seated, found.values, np.nan)
    return Outcome(values, beyond(response, values).astype(np.float64))


def beyond(response: Response, values: Array) -> NDArray[np.bool_]:
    """Flags of values (n, measures) that are beyond a limit of their measures, or are none."""
    fails = ~np.isfinite(values)
    for k, own in enumerate(response.measures):
        with np.errstate(invalid="ignore"):
            if own.lower_limit is not None:
                fails[:, k] |= values[:, k] < own.lower_limit * own.per_internal
            if own.upper_limit is not None:
                fails[:, k] |= values[:, k] > own.upper_limit * own.per_internal
    return fails


class _Gathered:
    """Sums over rows of what makes indices, input by input, of all rows and of bootstraps."""

    def __init__(self, first: Array, second: Array, weights: Array) -> None:
        self.first, self.second, self.weights = first, second, weights
        self.found: list[tuple[Array, Array]] = []
        self.variance = self._mean(0.5 * (second - first) ** 2)[0]

    def _mean(self, terms: Array) -> Array:
        """Weighted means (RESAMPLES + 1, measures) of terms (n, measures), without nan."""
        valid = np.isfinite(terms)
        if valid.all():
            return np.asarray(self.weights @ terms / len(terms))
        with np.errstate(invalid="ignore"):
            return np.asarray(self.weights @ np.where(valid, terms, 0.0) / (self.weights @ valid))

    def add(self, mixed: Array) -> None:
        """Take an input's builds."""
        step = mixed - self.first
        across = self._mean(np.where(np.isfinite(step), 0.5 * (self.second - self.first) ** 2, np.nan))
        # ((B - A)² - (B - mixed)²) / 2, without the difference of squares
        first = self._mean(step * (self.second - (self.first + mixed) / 2))
        total = self._mean(np.where(np.isfinite(self.second), 0.5 * step * step, np.nan))
        with np.errstate(invalid="ignore", divide="ignore"):
            varies = across > 0.0
            self.found.append((np.where(varies, first / across, np.nan), np.where(varies, total / across, np.nan)))

    @property
    def indices(self) -> Indices:
        """Indices of all inputs that were added."""
        shape = (len(self.found), len(self.weights), self.first.shape[1])
        first = np.array([own for own, _ in self.found]).reshape(shape)
        total = np.array([own for _, own in self.found]).reshape(shape)
        sums = np.array([first.sum(axis=0), total.sum(axis=0)])
        return Indices(
            first[:, 0], errors_of(first), total[:, 0], errors_of(total), sums[:, 0], errors_of(sums), self.variance
        )


def errors_of(resampled: Array) -> Array:
    """Standard errors (k, measures) of what was resampled (k, RESAMPLES + 1, measures), NaN where it is not known."""
    many = resampled[:, 1:]
    known = np.isfinite(many)
    count = np.maximum(known.sum(axis=1), 1)
    mean = np.where(known, many, 0.0).sum(axis=1) / count
    square = np.where(known, (many - mean[:, None]) ** 2, 0.0).sum(axis=1) / count
    return np.where(np.isfinite(resampled[:, 0]), np.sqrt(square), np.nan)
