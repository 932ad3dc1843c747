"""The rows that a measure's variance is regressed on: a few of each contributor that acts on it."""

from collections.abc import Mapping
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tol3d.system.contributor import Contributor
from tol3d.system.measure import Measure
from tol3d.system.regressors import regressor_count
from tol3d.system.system import Columns, System

Array = NDArray[np.float64]

MOST_REGRESSED = 128
"""Contributors of a measure that are regressed on: the sums of products of all pairs of their regressors go with their
square, and with more of them shares of the variance sink below the errors of any number of trials."""


def regressed(system: System, measure: Measure) -> tuple[Contributor, ...]:
    """The contributors whose shares are known: all that act on a measure, or the largest MOST_REGRESSED of them.

    What counts there is the variance by the stack-up; where it has no closed form, the scene's order.
    """
    contributors = tuple(system.acting(measure))
    return contributors if len(contributors) <= MOST_REGRESSED else _largest(_Itself(system), _Itself(measure))


class _Itself:
    """A thing as a key: itself, not its like."""

    def __init__(self, thing: Any) -> None:
        self.thing = thing

    def __hash__(self) -> int:
        return id(self.thing)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Itself) and other.thing is self.thing


@lru_cache(maxsize=64)
def _largest(system: _Itself, measure: _Itself) -> tuple[Contributor, ...]:
    """The largest contributors of a measure, in the scene's order; each block asks for them anew."""
    contributors = system.thing.acting(measure.thing)
    form = system.thing.reference_form(measure.thing)
    variance = {share.name: share.variance for share in form.shares} if form else {}
    largest = sorted(contributors, key=lambda contributor: -variance.get(contributor.name, 0.0))[:MOST_REGRESSED]
    names = {contributor.name for contributor in largest}
    return tuple(contributor for contributor in contributors if contributor.name in names)


def regressor_groups(system: System, measure: Measure) -> Mapping[str, slice]:
    """Which regressors of a measure belong to each contributor that is regressed on."""
    return _groups(regressed(system, measure))


def _groups(contributors: tuple[Contributor, ...]) -> dict[str, slice]:
    groups: dict[str, slice] = {}
    start = 0
    for contributor in contributors:
        end = start + regressor_count(contributor)
        groups[contributor.name] = slice(start, end)
        start = end
    return groups


def regressors(system: System, measure: Measure, columns: Columns) -> Array:
    """Regressors of a block for one measure, a row each, (regressors, trials), over each contributor's sigma."""
    contributors = regressed(system, measure)
    groups = _groups(contributors)
    trials = len(next(iter(columns.values())))
    rows = np.empty((max((group.stop for group in groups.values()), default=0), trials))
    system.regress(measure, contributors, columns, {name: rows[group] for name, group in groups.items()})
    return rows
