"""Ends of contributors together: where each lies when a linear measure is least, and when it is largest.

Contributors that read others are moved along with what they read: of a size that widens a zone, the worst size is
looked for, which may be one of its limits or lie between them.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Final, Protocol

import numpy as np

from tol3d.numerics.arrays import Array
from tol3d.statistics.distributions import DeviationLaw
from tol3d.study.system.dependent import Dependent, Named, in_draw_order, reads_of
from tol3d.study.system.region import region_of

PLACES: Final = 65
"""Number of places that are read at first: the effect is smooth but for a few bends."""
ZOOMS: Final = 14
"""Each to the two spans beside the best place, a quarter of the spans before: 5e-10 of all in the end."""
SWEEPS: Final = 3
"""Through several contributors that are read."""
ANY: Final = 1e-300
"""In place of a slope of 0, so that what has none is at opposite ends too."""


class Ended(Named, Protocol):
    """The part of a contributor on which its ends depend."""

    @property
    def distribution(self) -> DeviationLaw:
        """See Contributor."""
        ...


def ends_alone(contributor: Ended, slopes: Array, *, turning: bool) -> Array:
    """The ends (2, components) of a contributor that lower and that raise a quantity with these slopes.

    Features that are drawn each for itself are all at their own worst ends. Not a number where a slope is none.
    """
    if np.isnan(slopes).any():
        return np.full((2, len(slopes)), np.nan)
    along = np.where(slopes == 0.0, ANY, slopes)
    return region_of(contributor.draw, turning=turning).furthest(np.stack([-along, along]))


def ends_together(
    contributors: Sequence[Ended], slopes: Mapping[str, Array], turning: Mapping[str, bool]
) -> Mapping[str, Array]:
    """The ends (2, components) of each contributor that lower and that raise a linear measure most, all together.

    A contributor that reads one which reads another in turn takes the end that this one has by its own slopes.

    Args:
        contributors: all of a system.
        slopes: of the measure (components,), by contributor.
        turning: which contributors turn through all angles from trial to trial.
    """
    found = {
        contributor.name: ends_alone(contributor, slopes[contributor.name], turning=turning[contributor.name])
        for contributor in contributors
    }
    read = {name for contributor in contributors for name in reads_of(contributor)}
    if not read:
        return found
    group = [own for own in in_draw_order(contributors) if own.name in read or reads_of(own)]
    if any(np.isnan(slopes[own.name]).any() for own in group):
        return found | {own.name: np.full((2, len(slopes[own.name])), np.nan) for own in group}
    sides = [_Side(group, {name: sign * own for name, own in slopes.items()}, found) for sign in (-1.0, 1.0)]
    worst = [side.furthest for side in sides]
    return found | {own.name: np.stack([side[own.name] for side in worst]) for own in group}


@dataclass(frozen=True)
class _Side:
    """A measure that is to be as large as can be, of contributors that read or are read, in the order of drawing."""

    group: Sequence[Ended]
    slopes: Mapping[str, Array]
    alone: Mapping[str, Array]
    known: dict[tuple[str, bytes], Array] = field(default_factory=dict)
    """Furthest points of those that read others, by the bits of what they read: most stay from place to place."""

    @cached_property
    def furthest(self) -> Mapping[str, Array]:
        """Components (components,) of each."""
        free = [own for own in self.group if not isinstance(own.draw, Dependent)]
        at = {own.name: self._own_end(own) for own in free}
        searched = [own for own in free if len(own.draw.components) == 1]
        for _ in range(SWEEPS if len(searched) > 1 else 1):
            for own in searched:
                at[own.name] = np.array([self._best(own, at)])
        return self._moved_along(at)

    def _own_end(self, own: Ended) -> Array:
        ends, slopes = self.alone[own.name], self.slopes[own.name]
        return np.asarray(ends[int(np.argmax(ends @ slopes))])

    def _best(self, own: Ended, at: Mapping[str, Array]) -> float:
        low, high, count = own.distribution.low, own.distribution.high, PLACES
        for _ in range(ZOOMS):
            places = np.linspace(low, high, count)
            best = int(np.argmax([self._value({**at, own.name: np.array([place])}) for place in places]))
            low, high, count = places[max(best - 1, 0)], places[min(best + 1, count - 1)], 9
        return float(places[best])

    def _value(self, at: Mapping[str, Array]) -> float:
        return sum(float(self.slopes[name] @ own) for name, own in self._moved_along(at).items())

    def _moved_along(self, at: Mapping[str, Array]) -> Mapping[str, Array]:
        """All of the group, those that read at their furthest for what they read."""
        found = dict(at)
        for own in self.group:
            if isinstance(own.draw, Dependent):
                key = own.name, b"".join(found[name].tobytes() for name in own.draw.reads)
                if key not in self.known:
                    given = {name: found[name][:, None] for name in own.draw.reads}
                    self.known[key] = own.draw.furthest_given(given, self.slopes[own.name])
                found[own.name] = self.known[key]
        return found
