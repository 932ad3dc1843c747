"""The rows that measures' variances are regressed on: a few of each contributor that acts."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.arrays import Array
from tol3d.statistics.clusters import Clusters, Picked
from tol3d.system.contributor import Contributor
from tol3d.system.copula import INDEPENDENT, Copula
from tol3d.system.dependent import reads_of
from tol3d.system.itself import Itself
from tol3d.system.measure import Measure
from tol3d.system.regressors import regressor_count
from tol3d.system.system import Columns, System, Theory

Places = NDArray[np.intp]

MOST_REGRESSED = 128
"""Contributors of a measure that are regressed on together: the products of all pairs of their regressors go with
their square, and with more of them shares of the variance sink below the errors of any number of trials. Of more
contributors each cluster that depends on nothing else is regressed on by itself."""


@dataclass(frozen=True, eq=False)
class Regressed:
    """Regressors of one measure.

    Args:
        names: of the contributors that act on it.
        ends: (contributors + 1,), where the regressors of each begin and end.
        rows: its regressors among those of its set.
        picked: division of very many contributors; None if all are regressed on together.
    """

    names: tuple[str, ...]
    ends: Places
    rows: Places
    picked: Picked | None

    @property
    def parts(self) -> list[slice]:
        """The regressors of each contributor."""
        return [slice(start, end) for start, end in pairwise(self.ends.tolist())]

    @cached_property
    def groups(self) -> Mapping[str, slice]:
        """The same by name."""
        return dict(zip(self.names, self.parts, strict=True))


@dataclass(frozen=True, eq=False)
class RegressorSet:
    """Measures that see contributors alike, and their contributors.

    Args:
        measures: which.
        contributors: all that act on any of them, in the system's order.
        clusters: division of the contributors.
        apart: whether each cluster is regressed on by itself, or all that act on a measure together.
        acting: names of those that act on each measure.
        known: earlier answers, by measure.
    """

    measures: tuple[Measure, ...]
    contributors: tuple[Contributor, ...]
    clusters: Clusters
    apart: bool
    acting: Mapping[str, tuple[str, ...]]
    known: dict[str, Regressed] = field(default_factory=dict)

    def of(self, measure: Measure) -> Regressed:
        """Regressors of one of its measures."""
        if measure.name not in self.known:
            self.known[measure.name] = self._of(self.acting[measure.name])
        return self.known[measure.name]

    def _of(self, names: tuple[str, ...]) -> Regressed:
        picked = self.clusters.part(np.array([self._places[name] for name in names], dtype=np.intp))
        return Regressed(names, picked.clusters.starts, picked.rows, picked if self.apart else None)

    @cached_property
    def _places(self) -> Mapping[str, int]:
        return {own.name: place for place, own in enumerate(self.contributors)}

    def __len__(self) -> int:
        """Number of rows."""
        return self.clusters.features

    def rows(self, system: Theory, columns: Columns) -> Array:
        """The regressors of a block, a row each, (regressors, trials), over each contributor's sigma."""
        rows = np.empty((len(self), len(next(iter(columns.values())))))
        ends = self.clusters.starts.tolist()
        views = {own.name: rows[slice(*at)] for own, at in zip(self.contributors, pairwise(ends), strict=True)}
        system.regress(self.measures[0], self.contributors, columns, views)
        return rows


def regressor_sets(system: System, copula: Copula = INDEPENDENT) -> tuple[RegressorSet, ...]:
    """Sets of all measures of one value a trial; each has the products of its regressors worked out once."""
    return _sets_of(Itself(system), copula)


def regressor_set(system: System, measure: Measure) -> RegressorSet:
    """The set that a measure is in."""
    return next(own for own in regressor_sets(system) if measure.name in own.acting)


def regressor_groups(system: System, measure: Measure) -> Mapping[str, slice]:
    """Regressors of a measure that belong to each contributor that acts on it."""
    return regressor_set(system, measure).of(measure).groups


def regressors(system: System, measure: Measure, columns: Columns) -> Array:
    """Regressors of a block for one measure, a row each, (regressors, trials), over each contributor's sigma."""
    own = regressor_set(system, measure)
    return own.rows(system, columns)[own.of(measure).rows]


@lru_cache(maxsize=16)
def _sets_of(system: Itself, copula: Copula) -> tuple[RegressorSet, ...]:
    return tuple(_sets(system.thing, copula))


def _sets(system: System, copula: Copula) -> Iterator[RegressorSet]:
    scalars = [measure for measure in system.measures if measure.take != "curve"]
    acting = {measure.name: tuple(own.name for own in system.acting(measure)) for measure in scalars}
    alike: dict[Any, list[Measure]] = {}
    for measure in scalars:
        alike.setdefault(system.regressor_key(measure), []).append(measure)
    for measures in alike.values():
        few = [own for own in measures if len(acting[own.name]) <= MOST_REGRESSED]
        for within in _within_the_largest(few, acting):
            yield _set(system, within, acting, copula, apart=False)
        if many := [own for own in measures if len(acting[own.name]) > MOST_REGRESSED]:
            yield _set(system, many, acting, copula, apart=True)


def _within_the_largest(
    measures: Sequence[Measure], acting: Mapping[str, tuple[str, ...]]
) -> Iterable[Sequence[Measure]]:
    """Measures with those whose contributors all act on another one, too, which has the most."""
    found: list[tuple[frozenset[str], list[Measure]]] = []
    for measure in sorted(measures, key=lambda own: -len(acting[own.name])):  # a stable sort
        names = frozenset(acting[measure.name])
        larger = next((own for held, own in found if names <= held), None)
        if larger is None:
            found.append((names, [measure]))
        else:
            larger.append(measure)
    return [own for _, own in found]


def _set(
    system: System,
    measures: Sequence[Measure],
    acting: Mapping[str, tuple[str, ...]],
    copula: Copula,
    *,
    apart: bool,
) -> RegressorSet:
    names = {name for own in measures for name in acting[own.name]}
    contributors = tuple(own for own in system.contributors if own.name in names)
    groups = _dependent(system.contributors, copula)
    clusters = Clusters(
        np.array([regressor_count(own) for own in contributors], dtype=np.intp),
        np.array([groups[own.name] for own in contributors], dtype=np.intp),
    )
    return RegressorSet(
        tuple(measures), contributors, clusters, apart, {own.name: acting[own.name] for own in measures}
    )


def _dependent(contributors: Sequence[Contributor], copula: Copula) -> Mapping[str, int]:
    """A number for each contributor; those of the same one read each other, or what the same one reads.

    Or they are correlated.
    """
    groups = {own.name: place for place, own in enumerate(contributors)}
    links = [(own.name, *reads_of(own)) for own in contributors] + [own.names for own in copula.blocks]
    for names in links:
        joined = {groups[name] for name in names}
        if len(joined) > 1:
            groups = {name: min(joined) if group in joined else group for name, group in groups.items()}
    return groups
