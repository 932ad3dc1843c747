"""Estimate of the measures of kept builds by other tolerances, from slopes alone: at once, while a tolerance is moved.

Each build's value is v + (d' - d)·slope with its own deviations d and d', so that nothing moves where nothing changes
and no law is assumed. Slopes at the mean build do where a measure is nearly linear. For a length, a value at a turning
position or the largest over poses they are of no use, and a slope fitted to all builds is of none either, for it
averages to nothing (of a hexapod's place it leaves as much of a change as is there). A check tells, and then slopes are
taken at each of the kept builds.
"""

import math
import time
import warnings
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Final

import numpy as np

from tol3d.analyses.response import Response
from tol3d.errors import InputError
from tol3d.numerics.arrays import Array
from tol3d.study.execution.pace import FIRST_PIECE, Pace
from tol3d.study.trials.draws import KeptDraws

CHECKED: Final = 200
"""Builds of the check."""
OFF: Final = 0.05
"""Error of an estimate, in sigmas of the measure, from which slopes at the mean build are no longer used."""


@dataclass(frozen=True)
class Step:
    """Builds of a part of the work that are done, of so many."""

    part: str
    done: int
    of: int


@dataclass(frozen=True, eq=False)
class Slopes:
    """Slopes of measures by the components of a contributor.

    Args:
        values: at the mean build (1, measures, components), or at each of the kept builds (builds, measures,
            components), in the measures' units a mm, rad or K.
        error: root mean square of an estimate's error (measures,) in sigmas of the measures, where all deviations of
            the contributor are halved about their means; NaN where nothing could be assembled.
    """

    values: Array
    error: Array

    @classmethod
    def checked(cls, slopes: Array, values: Array, moves: Array, halved: Array) -> "Slopes":
        """Slopes with the error of estimates of the first builds.

        Args:
            slopes: as of `values`.
            values: of the kept builds (builds, measures).
            moves: of the contributor's deviations of the first of them (checked, components) [mm, rad, K].
            halved: their values after it (checked, measures).
        """
        first = slice(len(halved))
        estimated = values[first] + _changes(slopes[first], moves)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)  # nothing can be assembled
            error = np.sqrt(np.nanmean((estimated - halved) ** 2, axis=0))
            sigmas = np.nanstd(values, axis=0)
        in_sigmas = np.where(error > 0.0, np.inf, error)  # of a measure that nothing moves
        return cls(slopes, np.divide(error, sigmas, out=in_sigmas, where=sigmas > 0.0))

    @property
    def will_do(self) -> bool:
        """True if estimates are near enough."""
        return bool((self.error <= OFF).all())

    @property
    def at_each_build(self) -> bool:
        """True if they are taken at each of the kept builds."""
        return len(self.values) > 1


@dataclass(frozen=True, eq=False)
class MovedValues:
    """Measures of kept builds, to be estimated by other tolerances of the same system.

    Args:
        response: of the measures that are looked at.
        kept: builds that it draws.
        values: its values of them (builds, measures).
        longest: time that slopes by a contributor at each build may take [s]; where it is not enough, those at the mean
            build are all there is.
        known: slopes by contributor, as they were asked for.
        under_way: by contributor, slopes that are being made.
    """

    response: Response
    kept: KeptDraws
    values: Array
    longest: float = math.inf
    known: dict[str, Slopes] = field(default_factory=dict)
    under_way: dict[str, Iterator[Step]] = field(default_factory=dict)

    def of(self, redrawn: KeptDraws) -> Array:
        """Estimated values (builds, measures), in the measures' units, NaN where a kept build has none.

        Args:
            redrawn: the kept builds by other tolerances.

        Raises:
            InputError: other builds than those that are kept.
        """
        found = self.values.copy()
        for name in self.moved(redrawn):
            own = self.response.slices[name]
            found += _changes(self.slopes(name).values, (redrawn.columns[own] - self.kept.columns[own]).T)
        return found

    def moved(self, redrawn: KeptDraws) -> tuple[str, ...]:
        """Contributors whose deviations are others in some build.

        Raises:
            InputError: other builds than those that are kept.
        """
        if redrawn.columns.shape != self.kept.columns.shape:
            raise InputError(f"expected {len(self.values)} redrawn builds, got others")
        differs = (redrawn.columns != self.kept.columns).any(axis=1)
        return tuple(name for name, own in self.response.slices.items() if differs[own].any())

    def slopes(self, name: str) -> Slopes:
        """Slopes by a contributor, evaluated when they are first asked for.

        Raises:
            InputError: no such contributor.
        """
        for _ in self.steps(name):
            pass
        return self.known[name]

    def steps(self, name: str) -> Iterator[Step]:
        """Pieces in which slopes by a contributor are evaluated, none where they are known.

        Between two of them the caller stops; the next who asks goes on from there.

        Raises:
            InputError: no such contributor.
        """
        if name in self.known:
            return iter(())
        self.response.drawn_by(name)
        return self.under_way.setdefault(name, self._steps(name))

    def _steps(self, name: str) -> Iterator[Step]:
        rows, own = slice(CHECKED), self.response.slices[name]
        builds = self.kept.deviations[rows].copy()
        moves = (self.response.mean[own] - builds[:, own]) / 2
        builds[:, own] += moves
        halved = np.empty((len(builds), self.values.shape[1]))
        at_mean, begun, took = self.response.gradient(self.response.mean, names=[name]), time.perf_counter(), 0.0
        for some, found in self.response.pieces(builds, {key: each[rows] for key, each in self.kept.positions.items()}):
            halved[some] = found.values
            took += time.perf_counter() - begun
            yield Step("check of slopes", some.stop, len(builds))
            begun = time.perf_counter()
        slopes = Slopes.checked(at_mean, self.values, moves, halved)
        each_takes = took / len(builds) * 2 * moves.shape[1]
        if not slopes.will_do and each_takes * len(self.values) <= self.longest:
            each = np.empty((len(self.values), *at_mean.shape[1:]))
            pace, first = Pace(max(FIRST_PIECE // (2 * moves.shape[1]), 1)), 0
            while first < len(each):
                some, begun = slice(first, min(first + pace.count, len(each))), time.perf_counter()
                places = {key: position[some] for key, position in self.kept.positions.items()}
                each[some] = self.response.gradient(self.kept.deviations[some], places, [name])
                pace.took(some.stop - first, time.perf_counter() - begun)
                first = some.stop
                yield Step("slopes", first, len(each))
            slopes = Slopes.checked(each, self.values, moves, halved)
        self.known[name] = slopes
        self.under_way.pop(name, None)


def _changes(slopes: Array, moves: Array) -> Array:
    """Changes of measures (n, measures) by slopes (1 or n, measures, components) and moves (n, components)."""
    return np.asarray(np.einsum("nmc,nc->nm", slopes, moves))
