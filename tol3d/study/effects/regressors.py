"""The rows that measures' variances are regressed on: a few of each contributor that acts."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.arrays import Array
from tol3d.numerics.kept import Itself
from tol3d.statistics.estimates.clusters import Clusters, Picked
from tol3d.study.effects.acting_contributors import acting, looked_at
from tol3d.study.system.contributor import Contributor
from tol3d.study.system.copula import Copula
from tol3d.study.system.dependent import reads_of
from tol3d.study.system.measure import Measure
from tol3d.study.system.regressors import regress_squares, regressor_count
from tol3d.study.system.system import Columns, Theory
from tol3d.study.trials.simulation import Simulation

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
        seen: names of those that act without a slope, the same of all measures.
        known: earlier answers, by measure.
    """

    measures: tuple[Measure, ...]
    contributors: tuple[Contributor, ...]
    clusters: Clusters
    apart: bool
    acting: Mapping[str, tuple[str, ...]]
    seen: frozenset[str] = frozenset()
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
        sloping = [own for own in self.contributors if own.name not in self.seen]
        system.regress(self.measures[0], sloping, columns, views)
        for contributor in self.contributors:
            if contributor.name in self.seen:
                regress_squares(views[contributor.name], contributor, columns)
        return rows


def regressor_sets(simulation: Simulation) -> tuple[RegressorSet, ...]:
    """Sets of all measures of one value a trial; each has the products of its regressors worked out once."""
    return _sets_of(Itself(simulation))


def regressor_set(simulation: Simulation, measure: Measure) -> RegressorSet:
    """The set that a measure is in."""
    return next(own for own in regressor_sets(simulation) if measure.name in own.acting)


def regressor_groups(simulation: Simulation, measure: Measure) -> Mapping[str, slice]:
    """Regressors of a measure that belong to each contributor that acts on it."""
    return regressor_set(simulation, measure).of(measure).groups


def regressors(simulation: Simulation, measure: Measure, columns: Columns) -> Array:
    """Regressors of a block for one measure, a row each, (regressors, trials), over each contributor's sigma."""
    own = regressor_set(simulation, measure)
    return own.rows(simulation.system, columns)[own.of(measure).rows]


@lru_cache(maxsize=16)
def _sets_of(simulation: Itself) -> tuple[RegressorSet, ...]:
    return tuple(_sets(simulation.thing))


def _sets(simulation: Simulation) -> Iterator[RegressorSet]:
    system = simulation.system
    scalars = [measure for measure in system.measures if measure.take != "curve"]
    names = {measure.name: tuple(own.name for own in acting(simulation, measure)) for measure in scalars}
    alike: dict[Any, list[Measure]] = {}
    for measure in scalars:
        key = system.regressor_key(measure), looked_at(simulation, measure).names
        alike.setdefault(key, []).append(measure)
    for measures in alike.values():
        few = [own for own in measures if len(names[own.name]) <= MOST_REGRESSED]
        for within in _within_the_largest(few, names):
            yield _set(simulation, within, names, apart=False)
        if many := [own for own in measures if len(names[own.name]) > MOST_REGRESSED]:
            yield _set(simulation, many, names, apart=True)


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
    simulation: Simulation, measures: Sequence[Measure], acting: Mapping[str, tuple[str, ...]], *, apart: bool
) -> RegressorSet:
    system = simulation.system
    names = {name for measure in measures for name in acting[measure.name]}
    contributors = tuple(contributor for contributor in system.contributors if contributor.name in names)
    groups = _dependent(system.contributors, simulation.copula)
    clusters = Clusters(
        np.array([regressor_count(contributor) for contributor in contributors], dtype=np.intp),
        np.array([groups[contributor.name] for contributor in contributors], dtype=np.intp),
    )
    return RegressorSet(
        tuple(measures),
        contributors,
        clusters,
        apart,
        {measure.name: acting[measure.name] for measure in measures},
        looked_at(simulation, measures[0]).names,
    )


def _dependent(contributors: Sequence[Contributor], copula: Copula) -> Mapping[str, int]:
    """A number for each contributor; those of the same one read each other, or what the same one reads.

    Or they are correlated.
    """
    groups = {own.name: place for place, own in enumerate(contributors)}
    links = [(contributor.name, *reads_of(contributor)) for contributor in contributors] + [
        block.names for block in copula.blocks
    ]
    for names in links:
        joined = {groups[name] for name in names}
        if len(joined) > 1:
            groups = {name: min(joined) if group in joined else group for name, group in groups.items()}
    return groups
