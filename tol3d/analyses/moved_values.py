"""Estimate of the measures of kept builds by other tolerances, from slopes alone: at once, while a tolerance is moved.

Each build's value is v + (d' - d)·slope with its own deviations d and d', so that nothing moves where nothing changes
and no law is assumed. Slopes at the mean build do where a measure is nearly linear. For a length, a value at a turning
position or the largest over poses they are of no use, and a slope fitted to all builds is of none either, for it
averages to nothing (of a hexapod's place it leaves as much of a change as is there). A check tells, and then slopes are
taken at each of the kept builds.
"""

import warnings
from dataclasses import dataclass, field
from typing import Final

import numpy as np

from tol3d.analyses.response import Response
from tol3d.errors import InputError
from tol3d.numerics.arrays import Array
from tol3d.study.trials.draws import KeptDraws

CHECKED: Final = 200
"""Builds of the check."""
OFF: Final = 0.05
"""Error of an estimate, in sigmas of the measure, from which slopes at the mean build are no longer used."""


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
        known: slopes by contributor, as they were asked for.
    """

    response: Response
    kept: KeptDraws
    values: Array
    known: dict[str, Slopes] = field(default_factory=dict)

    def of(self, redrawn: KeptDraws) -> Array:
        """Estimated values (builds, measures), in the measures' units, NaN where a kept build has none.

        Args:
            redrawn: the kept builds by other tolerances.

        Raises:
            InputError: other builds than those that are kept.
        """
        if redrawn.columns.shape != self.kept.columns.shape:
            raise InputError(f"expected {len(self.values)} redrawn builds, got others")
        found = self.values.copy()
        for name, own in self.response.slices.items():
            moved = redrawn.columns[own] - self.kept.columns[own]
            if moved.any():
                found += _changes(self.slopes(name).values, moved.T)
        return found

    def slopes(self, name: str) -> Slopes:
        """Slopes by a contributor, evaluated when they are first asked for.

        Raises:
            InputError: no such contributor.
        """
        if name not in self.known:
            at_mean = self._checked(name, self.response.gradient(self.response.mean, names=[name]))
            self.known[name] = at_mean if (at_mean.error <= OFF).all() else self._at_each_build(name)
        return self.known[name]

    def _at_each_build(self, name: str) -> Slopes:
        return self._checked(name, self.response.gradient(self.kept.deviations, self.kept.positions, [name]))

    def _checked(self, name: str, slopes: Array) -> Slopes:
        """Slopes with the error of estimates for the first builds."""
        rows, own = slice(CHECKED), self.response.slices[name]
        builds = self.kept.deviations[rows].copy()
        moves = (self.response.mean[own] - builds[:, own]) / 2
        builds[:, own] += moves
        found = self.response.values(builds, {key: each[rows] for key, each in self.kept.positions.items()}).values
        estimated = self.values[rows] + _changes(slopes[rows], moves)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)  # nothing can be assembled
            error = np.sqrt(np.nanmean((estimated - found) ** 2, axis=0))
            sigmas = np.nanstd(self.values, axis=0)
        in_sigmas = np.where(error > 0.0, np.inf, error)  # of a measure that nothing moves
        return Slopes(slopes, np.divide(error, sigmas, out=in_sigmas, where=sigmas > 0.0))


def _changes(slopes: Array, moves: Array) -> Array:
    """Changes of measures (n, measures) by slopes (1 or n, measures, components) and moves (n, components)."""
    return np.asarray(np.einsum("nmc,nc->nm", slopes, moves))
