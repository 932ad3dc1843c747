"""The rows that measures' variances are regressed on: a few of each contributor that acts."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tol3d.statistics.clusters import Clusters, Picked
from tol3d.system.contributor import Contributor
from tol3d.system.dependent import reads_of
from tol3d.system.itself import Itself
from tol3d.system.measure import Measure
from tol3d.system.regressors import regressor_count
from tol3d.system.system import Columns, System

Array = NDArray[np.float64]
Places = NDArray[np.intp]

MOST_REGRESSED = 128
"""Contributors of a measure that are regressed on together: the products of all pairs of their regressors go with
their square, and with more of them shares of the variance sink below the errors of any number of trials. Of more
contributors each cluster that depends on nothing else is regressed on by itself."""


@dataclass(frozen=True, eq=False)
class Regressed:
    """What one measure is regressed on.

    Args:
        names: of the contributors that act on it.
        groups: which of its own regressors belong to each.
        rows: its regressors among those of its set.
        picked: of very many contributors how they are cut; None where all are regressed on together.
    """

    names: tuple[str, ...]
    groups: Mapping[str, slice]
    rows: Places
    picked: Picked | None

    @property
    def parts(self) -> list[slice]:
        """The regressors of each contributor."""
        return [*self.groups.values()]


@dataclass(frozen=True, eq=False)
class RegressorSet:
    """Measures that see contributors alike, and contributors of which each measure has some.

    Args:
        measures: which.
        contributors: all that act on any of them, in the system's order.
        clusters: how very many of them are cut; None where all that act on a measure are regressed on together.
        known: what was asked for, by measure.
    """

    measures: tuple[Measure, ...]
    contributors: tuple[Contributor, ...]
    clusters: Clusters | None
    acting: Mapping[str, tuple[str, ...]]
    known: dict[str, Regressed] = field(default_factory=dict)

    @cached_property
    def groups(self) -> Mapping[str, slice]:
        """Which rows belong to each contributor."""
        return _groups(self.contributors)

    def of(self, measure: Measure) -> Regressed:
        """What one of its measures is regressed on."""
        if measure.name not in self.known:
            self.known[measure.name] = self._of(self.acting[measure.name])
        return self.known[measure.name]

    def _of(self, names: tuple[str, ...]) -> Regressed:
        sizes = [self.groups[name].stop - self.groups[name].start for name in names]
        ends = np.cumsum(sizes).tolist()
        groups = {name: slice(end - size, end) for name, size, end in zip(names, sizes, ends, strict=True)}
        if self.clusters is None:
            every, none = np.arange(len(self)), np.zeros(0, dtype=np.intp)
            rows = np.concatenate([none, *(every[self.groups[name]] for name in names)])
            return Regressed(names, groups, rows, None)
        places = {own.name: place for place, own in enumerate(self.contributors)}
        picked = self.clusters.part([places[name] for name in names])
        return Regressed(names, groups, picked.rows, picked)

    def __len__(self) -> int:
        """How many rows there are."""
        return max((own.stop for own in self.groups.values()), default=0)

    def rows(self, system: System, columns: Columns) -> Array:
        """The regressors of a block, a row each, (regressors, trials), over each contributor's sigma."""
        rows = np.empty((len(self), len(next(iter(columns.values())))))
        views = {name: rows[group] for name, group in self.groups.items()}
        system.regress(self.measures[0], self.contributors, columns, views)
        return rows


def regressor_sets(system: System) -> tuple[RegressorSet, ...]:
    """Sets of all measures of one value a trial; each has the products of its regressors worked out once."""
    return _sets_of(Itself(system))


def regressor_set(system: System, measure: Measure) -> RegressorSet:
    """The set that a measure is in."""
    return next(own for own in regressor_sets(system) if measure.name in own.acting)


def regressor_groups(system: System, measure: Measure) -> Mapping[str, slice]:
    """Which regressors of a measure belong to each contributor that acts on it."""
    return regressor_set(system, measure).of(measure).groups


def regressors(system: System, measure: Measure, columns: Columns) -> Array:
    """Regressors of a block for one measure, a row each, (regressors, trials), over each contributor's sigma."""
    own = regressor_set(system, measure)
    return own.rows(system, columns)[own.of(measure).rows]


@lru_cache(maxsize=16)
def _sets_of(system: Itself) -> tuple[RegressorSet, ...]:
    return tuple(_sets(system.thing))


def _sets(system: System) -> Iterator[RegressorSet]:
    scalars = [measure for measure in system.measures if measure.take != "curve"]
    acting = {measure.name: tuple(own.name for own in system.acting(measure)) for measure in scalars}
    alike: dict[Any, list[Measure]] = {}
    for measure in scalars:
        alike.setdefault(system.regressor_key(measure), []).append(measure)
    for measures in alike.values():
        few = [own for own in measures if len(acting[own.name]) <= MOST_REGRESSED]
        for within in _within_the_largest(few, acting):
            yield _set(system, within, acting, together=True)
        if many := [own for own in measures if len(acting[own.name]) > MOST_REGRESSED]:
            yield _set(system, many, acting, together=False)


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
    system: System, measures: Sequence[Measure], acting: Mapping[str, tuple[str, ...]], *, together: bool
) -> RegressorSet:
    names = {name for own in measures for name in acting[own.name]}
    contributors = tuple(own for own in system.contributors if own.name in names)
    clusters = None
    if not together:
        groups = _dependent(system.contributors)
        places: dict[int, list[int]] = {}
        for place, own in enumerate(contributors):
            places.setdefault(groups[own.name], []).append(place)
        sizes = tuple(regressor_count(own) for own in contributors)
        clusters = Clusters(sizes, tuple(tuple(own) for own in places.values()))
    return RegressorSet(tuple(measures), contributors, clusters, {own.name: acting[own.name] for own in measures})


def _dependent(contributors: Sequence[Contributor]) -> Mapping[str, int]:
    """A number for each contributor; those of the same one read each other, or what the same one reads."""
    groups = {own.name: place for place, own in enumerate(contributors)}
    for own in contributors:
        joined = {groups[own.name], *(groups[name] for name in reads_of(own))}
        if len(joined) > 1:
            groups = {name: min(joined) if group in joined else group for name, group in groups.items()}
    return groups


def _groups(contributors: Sequence[Contributor]) -> dict[str, slice]:
    groups: dict[str, slice] = {}
    start = 0
    for contributor in contributors:
        end = start + regressor_count(contributor)
        groups[contributor.name] = slice(start, end)
        start = end
    return groups
