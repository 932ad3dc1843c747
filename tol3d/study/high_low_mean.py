"""High-low-mean shares: one contributor at its ends, the others at their means, as 3DCS ranks contributors.

They stand beside shares of the variance because published tables mix the two senses. A length in a random
direction acts along the direction in which it changes the measure most.

All ends of all contributors are built in one batch for all measures. Which way a draw acts follows from values that it
asks for: what it asks is noted, answered with that of all others, and handed to it when it is asked again.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from tol3d.study.evaluation import Values, batches, of_alike
from tol3d.system.contributor import Contributor
from tol3d.system.measure import Measure
from tol3d.system.stated import component_slices, mean_deviations
from tol3d.system.system import System

Array = NDArray[np.float64]

Percents = Mapping[str, float | None]


def high_low_mean_percents(system: System, measures: Sequence[Measure], values: Values) -> Mapping[str, Percents]:
    """Shares [%] of contributors: the square of each one's range (largest less smallest of three states) in their sum.

    Args:
        system, measures: what is built, and what is read of it: one number of each.
        values: measures of deviations; nan where a build does not seat.

    Returns:
        By measure percents by the contributor's name; None where a build does not seat, 0 where nothing moves it.
    """
    return of_alike(system, measures, lambda alike, turning: _percents_of(system, alike, turning, values))


def _percents_of(
    system: System, measures: Sequence[Measure], turning: Mapping[str, bool], values: Values
) -> dict[str, Percents]:
    """Shares of measures that share the mean build and what turns at random."""
    mean = mean_deviations(system, measures[0].positions)
    middle = {name: float(own[0]) for name, own in values(mean, measures).items()}
    seated = [measure for measure in measures if not math.isnan(middle[measure.name])]
    ranges: dict[str, dict[str, float]] = {measure.name: {} for measure in seated}
    slices = component_slices(system)
    rows = [_rows(own, len(seated)) for own in system.contributors]
    for contributors in batches(system.contributors, rows, mean.shape[1]):
        asked = [_Alone(own, slices[own.name], turning[own.name], mean) for own in contributors]
        for own in asked:
            own.ask(measure.name for measure in seated)
        while any(own.waiting for own in asked):
            _answer(asked, seated, values)
        for own in asked:
            for measure in seated:
                if (states := own.of(measure.name)) is not None:
                    found = [middle[measure.name], *states]
                    ranges[measure.name][own.contributor.name] = float(np.max(found) - np.min(found))
    names = [contributor.name for contributor in system.contributors]
    return {own.name: _percents(names, ranges.get(own.name, {})) for own in measures}


def _rows(contributor: Contributor, measures: int) -> int:
    """The number of builds a contributor asks for, about."""
    count = len(contributor.draw.components)
    return 2 * count if count == 1 else 2 * (count + measures)


class _NotKnownError(Exception):
    """Values are not known yet; they are noted."""


@dataclass
class _Alone:
    """A contributor that leaves its mean, all others at theirs.

    Args:
        contributor: which.
        columns: its deviations.
        turning: whether its direction turns from trial to trial.
        mean: deviations of all (1, components).
        ends: by measure, where it ends; None where that cannot be known.
        waiting: components that are asked for, with the measures that ask, by their bytes.
        known: by those bytes, values of measures of several builds with the place of this one among them.
    """

    contributor: Contributor
    columns: slice
    turning: bool
    mean: Array
    ends: dict[str, Array | None] = field(default_factory=dict)
    waiting: dict[bytes, tuple[Array, list[str]]] = field(default_factory=dict)
    known: dict[bytes, list[tuple[Mapping[str, Array], int]]] = field(default_factory=dict)

    def ask(self, names: Iterable[str]) -> None:
        """Ask for the states of measures, as far as is known where its ends are."""
        left = list(names)
        for place, name in enumerate(left):
            read = _Reading(self, name)
            try:
                ends = self.contributor.draw.ends(read, turning=self.turning)
            except _NotKnownError:
                continue
            self._ended(name, ends)
            if not read.asked:  # nor do its ends for any other measure
                for other in left[place + 1 :]:
                    self._ended(other, ends)
                return

    def _ended(self, name: str, ends: Array) -> None:
        self.ends[name] = ends if np.isfinite(ends).all() else None  # which way it acts is not known
        if self.ends[name] is not None:
            self._want(ends, name)

    def _want(self, rows: Array, name: str) -> None:
        for row in rows:
            if self._value(key := row.tobytes(), name) is None:
                self.waiting.setdefault(key, (row, []))[1].append(name)

    def _value(self, key: bytes, name: str) -> float | None:
        return next((float(found[name][k]) for found, k in self.known.get(key, ()) if name in found), None)

    def read(self, rows: Array, name: str) -> Array:
        """Values of a measure (rows,) of components (rows, components)."""
        found = [self._value(row.tobytes(), name) for row in rows]
        if None in found:
            self._want(rows, name)
            raise _NotKnownError
        return np.array(found, dtype=np.float64)

    def of(self, name: str) -> Array | None:
        """Values at both ends, None where these are not known."""
        ends = self.ends.get(name)
        return None if ends is None else self.read(ends, name)


@dataclass
class _Reading:
    """A measure as a draw reads it; notes whether it did."""

    alone: _Alone
    name: str
    asked: bool = False

    def __call__(self, rows: Array) -> Array:
        self.asked = True
        return self.alone.read(np.asarray(rows, dtype=np.float64), self.name)


_Wanted = tuple[_Alone, bytes, Array]


def _answer(asked: Sequence[_Alone], measures: Sequence[Measure], values: Values) -> None:
    """Build what contributors wait for, together what the same measures ask, and let those go on that read it."""
    groups: dict[tuple[str, ...], list[_Wanted]] = {}
    for own in asked:
        for key, (row, names) in own.waiting.items():
            groups.setdefault(tuple(dict.fromkeys(names)), []).append((own, key, row))
        own.waiting = {}
    if len(groups) > len(measures):  # ends lie elsewhere for each measure
        groups = {
            (own.name,): [each for names, wanted in groups.items() if own.name in names for each in wanted]
            for own in measures
        }
    known = {measure.name: measure for measure in measures}
    for asking, wanted in groups.items():
        rows = np.repeat(asked[0].mean, len(wanted), axis=0)
        for k, (own, _, row) in enumerate(wanted):
            rows[k, own.columns] = row
        found = values(rows, [known[name] for name in asking])
        for k, (own, key, _) in enumerate(wanted):
            own.known.setdefault(key, []).append((found, k))
    for own in asked:
        own.ask(name for name in known if name not in own.ends)


def _percents(names: Sequence[str], ranges: Mapping[str, float]) -> Percents:
    if len(ranges) < len(names):  # a build beside the mean does not seat
        return dict.fromkeys(names, None)
    total = sum(own**2 for own in ranges.values())
    if math.isnan(total):
        return dict.fromkeys(names, None)
    return {name: 100 * own**2 / total if total > 0.0 else 0.0 for name, own in ranges.items()}
