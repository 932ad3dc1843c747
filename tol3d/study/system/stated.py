"""Trials that were not drawn: stated deviations, every contributor at its mean, no deviation at all."""

from collections.abc import Mapping, Sequence
from functools import lru_cache
from typing import Final, Protocol

import numpy as np

from tol3d.numerics.arrays import Array
from tol3d.numerics.kept import Itself
from tol3d.study.system.contributor import Contributor
from tol3d.study.system.measure import Measure
from tol3d.study.system.positions import Positions
from tol3d.study.system.trials import Trials

NO_UNIT: Final = "1"
"""Unit of columns that are shares of the room left by other deviations."""


class Toleranced(Protocol):
    """Object with contributors."""

    @property
    def contributors(self) -> Sequence[Contributor]:
        """See System."""
        ...


class Varying(Toleranced, Protocol):
    """A system, or a model of one: the basis of its trials."""

    @property
    def streams(self) -> Sequence[tuple[str, str]]:
        """See System."""
        ...

    def positions(self, uniforms: Mapping[tuple[str, str], Array]) -> Mapping[str, Array]:
        """See System."""
        ...

    def turns_at_random(self, contributor: Contributor, positions: Positions) -> bool:
        """See System."""
        ...


def component_slices(system: Toleranced) -> Mapping[str, slice]:
    """Columns of the deviations that belong to each contributor, by its name."""
    return _slices(Itself(system.contributors))


@lru_cache(maxsize=16)
def _slices(contributors: Itself) -> Mapping[str, slice]:
    slices, start = {}, 0
    for contributor in contributors.thing:
        width = len(contributor.draw.components)
        slices[contributor.name] = slice(start, start + width)
        start += width
    return slices


def component_count(system: Toleranced) -> int:
    """Columns of the deviations."""
    return sum(len(contributor.draw.components) for contributor in system.contributors)


def magnified(system: Toleranced, trials: Trials, factor: float) -> Trials:
    """Trials with scaled deviations; shares of a room, which have no unit, stay as they are."""
    factors = np.full(component_count(system), factor)
    slices = component_slices(system)
    for contributor in system.contributors:
        if contributor.unit == NO_UNIT:
            factors[slices[contributor.name]] = 1.0
    return trials.scaled(factors)


def stated(system: Varying, deviations: Array) -> Trials:
    """Trials of the deviations (trials, components) that are stated, at rest."""
    uniforms = {key: np.zeros(len(deviations)) for key in system.streams}
    return Trials(deviations, system.positions(uniforms))


def mean_deviations(system: Varying, positions: Positions) -> Array:
    """Every contributor at its mean over some positions, shape (1, components).

    A random direction averages to zero, and so does one that turns with its part at random positions.
    """
    row = np.zeros((1, component_count(system)))
    for contributor, columns in zip(system.contributors, component_slices(system).values(), strict=True):
        row[:, columns] = contributor.draw.mean(turning=system.turns_at_random(contributor, positions))
    return row


def mean_build(system: Varying, measure: Measure) -> Trials:
    """One trial with every contributor at its mean over the positions of a measure, at rest."""
    return stated(system, mean_deviations(system, measure.positions))


def nominal_build(system: Varying) -> Trials:
    """One trial without deviations, at rest."""
    return stated(system, np.zeros((1, component_count(system))))
