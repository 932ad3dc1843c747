"""High-low-mean shares: one contributor at its ends, the others at their means, as 3DCS ranks contributors.

They stand beside shares of the variance because published tables mix the two senses. A length in a random
direction acts along the direction in which it changes the measure most; where the measure changes alike to both sides,
as the size of a vector does, the range is the root of the sum of squares over directions across each other.

All ends of all contributors are built in one batch for all measures. Which way a draw acts may follow from values that
it asks for: what it asks is noted, answered with that of all others, and handed to it when it is asked again. Where it
lies elsewhere for each measure builds go with contributors times measures: beyond MOST_ENDS of them, or where the run
affords fewer, those that move a measure most have theirs built (MOST_EXACT at most), the others have what they do to
first order. Where the run does not afford what is asked before, nothing is built.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Final

import numpy as np

from tol3d.numerics.arrays import Array
from tol3d.study.system.dependent import Named
from tol3d.study.system.measure import Measure
from tol3d.study.system.stated import component_slices, mean_deviations
from tol3d.study.system.system import System
from tol3d.study.trials.budget import ALONE, PLACING
from tol3d.study.trials.evaluation import Values, batches, measures_alike

Ranges = Mapping[str, float | None]
Percents = Mapping[str, float | None]

MOST_ENDS: Final = 2**14
"""Builds at ends of contributors that act another way on each measure."""
MOST_EXACT: Final = 15
"""Contributors of a measure whose ends are built where all would be more than that."""
TOGETHER: Final = 4096
"""Builds for all measures at once at most; else each measure has those made that it asks for."""
CALL: Final = 20_000
"""Contacts that take as long as what a method does for any number of builds."""

ROUNDING: Final = 1e-9
"""Part by which contacts that are enough may seem too few."""

Cost = Callable[[Sequence[Measure]], int]
"""Contacts per build that measures ask for; see System.cost."""


def high_low_mean_ranges(
    system: System, measures: Sequence[Measure], values: Values, contacts: float = math.inf
) -> Mapping[str, Ranges]:
    """Ranges of measures over each contributor: largest less smallest of three states.

    Args:
        system, measures: to build and to read: one number of each.
        values: measures of deviations; nan where a build cannot be assembled.
        contacts: those that builds may take, see budget.py.

    Returns:
        By measure ranges by the contributor's name, in its unit; None where a build cannot be assembled, or where
        builds would take more contacts.
    """
    found: dict[str, Ranges] = {}
    for turning, alike, own in _apportioned(system, measures, contacts):
        found |= _named_ranges(system, alike, turning, values, own)
    return found


def high_low_mean_percents(ranges: Ranges) -> Percents:
    """Shares [%] of contributors: the square of each one's range in their sum; 0 where nothing moves the measure."""
    squares = {name: None if own is None else own**2 for name, own in ranges.items()}
    total = sum(square for square in squares.values() if square is not None)
    return {name: None if own is None else 100 * own / total if total > 0.0 else 0.0 for name, own in squares.items()}


@dataclass(frozen=True)
class Extent:
    """Builds for measures that share a mean build.

    Args:
        asking: contributors that lie elsewhere at their ends for each measure.
        exact: those of them whose ends are built, the ones that move a measure most; None where nothing is built.
        contacts: what all takes that is built.
    """

    asking: int
    exact: int | None
    contacts: float


def extents(system: System, measures: Sequence[Measure], contacts: float = math.inf) -> Sequence[Extent]:
    """Builds for measures, one entry for all that share a mean build; see `high_low_mean_ranges`."""
    found = []
    for turning, alike, own in _apportioned(system, measures, contacts):
        alone = _alone(system, turning, mean_deviations(system, alike[0].positions))
        found.append(_extent(alone, alike, system.cost, own))
    return found


def _apportioned(
    system: System, measures: Sequence[Measure], contacts: float
) -> Iterator[tuple[Mapping[str, bool], Sequence[Measure], float]]:
    """Measures that share a mean build, what turns there, and contacts for them in proportion to what they want."""
    groups, part = measures_alike(system, measures), math.inf
    wanted = [math.inf] * len(groups)
    if math.isfinite(contacts):
        wanted = [extent.contacts for extent in extents(system, measures)]
        part = (1.0 + ROUNDING) * contacts / max(sum(wanted), 1.0)
    for (turning, alike), own in zip(groups, wanted, strict=True):
        yield turning, alike, own * part


def _extent(alone: Sequence["_Alone"], measures: Sequence[Measure], cost: Cost, contacts: float) -> Extent:
    """Ends of all, as far as there are no more than MOST_ENDS of them; else of as many as contacts let it."""
    asking = [own for own in alone if own.plain_ends is None]
    read = 2 * (len(alone) - len(asking) + sum(len(own.contributor.draw.components) for own in asking))
    reading = ALONE * read * (PLACING + cost(measures))
    ends = ALONE * 2 * sum(PLACING + cost((measure,)) for measure in measures)  # of a contributor
    all_exact = len(asking) <= MOST_EXACT or 2 * len(asking) * len(measures) <= MOST_ENDS
    wanted = len(asking) if all_exact else MOST_EXACT
    if reading > contacts:
        return Extent(len(asking), None, 0.0)
    exact = wanted if reading + wanted * ends <= contacts else min(int((contacts - reading) / ends), MOST_EXACT)
    return Extent(len(asking), exact, reading + exact * ends)


def _alone(system: System, turning: Mapping[str, bool], mean: Array) -> list["_Alone"]:
    slices = component_slices(system)
    return [
        _Alone(contributor, slices[contributor.name], turning[contributor.name], mean)
        for contributor in system.contributors
    ]


def _named_ranges(
    system: System, measures: Sequence[Measure], turning: Mapping[str, bool], values: Values, contacts: float
) -> dict[str, Ranges]:
    """Ranges of measures that share the mean build and the directions that turn at random."""
    mean = mean_deviations(system, measures[0].positions)
    found = _ranges_of(_alone(system, turning, mean), mean, measures, values, system.cost, contacts)
    names = [contributor.name for contributor in system.contributors]
    unknown: Ranges = dict.fromkeys(names)  # where a build beside the mean cannot be assembled
    return {
        measure.name: dict(zip(names, its.tolist(), strict=True))
        if (its := found.get(measure.name)) is not None and not np.isnan(its).any()
        else unknown
        for measure in measures
    }


def ranges(
    contributors: Sequence[Named],
    slices: Mapping[str, slice],
    mean: Array,
    measures: Sequence[Measure],
    values: Values,
    cost: Cost,
) -> Mapping[str, Array]:
    """Range of measures over each contributor by itself: largest less smallest of both ends and the mean build.

    Args:
        contributors: of some system; none of their directions turns.
        slices: their components.
        mean: deviations of the mean build (1, components).
        measures: one number of each.
        values: see `high_low_mean_ranges`.
        cost: of measures.

    Returns:
        By measure (contributors,) in its unit, nan where a build fails; no entry where the mean build fails.
    """
    alone = [_Alone(contributor, slices[contributor.name], turning=False, mean=mean) for contributor in contributors]
    return _ranges_of(alone, mean, measures, values, cost)


def _ranges_of(
    alone: Sequence["_Alone"],
    mean: Array,
    measures: Sequence[Measure],
    values: Values,
    cost: Cost,
    contacts: float = math.inf,
) -> Mapping[str, Array]:
    """The range of each contributor (contributors,) by the measures whose mean build seats."""
    exact = _extent(alone, measures, cost, contacts).exact
    if exact is None:
        return {}
    middle = {name: float(own[0]) for name, own in values(mean, measures).items()}
    seated = [measure for measure in measures if not math.isnan(middle[measure.name])]
    found = _Ranges({own.contributor.name: place for place, own in enumerate(alone)}, seated, middle, values, cost)
    asking = [own for own in alone if own.plain_ends is None]
    if seated:
        found.build([(own, ends) for own in alone if (ends := own.plain_ends) is not None], mean)
    all_exact = exact == len(asking)
    rows = [2 * (len(own.contributor.draw.components) + len(seated) * all_exact) for own in asking]
    by_name = {own.contributor.name: own for own in asking}
    for contributors in batches([own.contributor for own in asking], rows, mean.shape[1]):
        found.ask([by_name[contributor.name] for contributor in contributors], all_exact=all_exact)
    if not all_exact:
        found.build_the_largest(asking, exact)
    return found.by_measure


@dataclass(frozen=True)
class _Ranges:
    """Range of each measure over each contributor.

    Args:
        places: of the contributors.
        seated: the measures whose mean build seats.
        middle: values of the measures there.
        values: measures of deviations.
        cost: of measures.
        by_measure: the range of each contributor (contributors,), nan where it is not known.
    """

    places: Mapping[str, int]
    seated: Sequence[Measure]
    middle: Mapping[str, float]
    values: Values
    cost: Cost
    by_measure: dict[str, Array] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.by_measure.update({own.name: np.full(len(self.places), np.nan) for own in self.seated})

    def build(self, plain: Sequence[tuple["_Alone", Array]], mean: Array) -> None:
        """Find those of contributors whose ends are the same for all measures."""
        known = {own.contributor.name: (own, ends) for own, ends in plain}
        for batch in batches([own.contributor for own, _ in plain], [2] * len(plain), mean.shape[1]):
            rows = np.repeat(mean, 2 * len(batch), axis=0)
            for k, contributor in enumerate(batch):
                own, ends = known[contributor.name]
                rows[2 * k : 2 * k + 2, own.columns] = ends
            at = [self.places[contributor.name] for contributor in batch]
            for name, found in self.values(rows, self.seated).items():
                middle = np.full((len(batch), 1), self.middle[name])
                self.by_measure[name][at] = np.ptp(np.concatenate([found.reshape(-1, 2), middle], axis=1), axis=1)

    def ask(self, asking: Sequence["_Alone"], *, all_exact: bool) -> None:
        """Find ranges of contributors whose ends follow from their effect on a measure; to first order if not exact."""
        for own in asking:
            own.builds_ends = all_exact
            own.ask(measure.name for measure in self.seated)
        self._answer(asking)
        for own in asking:
            if all_exact:
                for measure in self.seated:
                    self._take(own, measure.name)
                continue
            for name, found in own.first_order(
                {measure.name: self.middle[measure.name] for measure in self.seated}
            ).items():
                self.by_measure[name][self.places[own.contributor.name]] = found

    def build_the_largest(self, asking: Sequence["_Alone"], count: int) -> None:
        """Find the ranges of the contributors that move a measure most, in place of their first-order effects."""
        chosen = []
        for measure in self.seated:
            sizes = self.by_measure[measure.name][[self.places[own.contributor.name] for own in asking]]
            largest = [k for k in np.argsort(-sizes, kind="stable").tolist() if not math.isnan(sizes[k])]
            for own in (asking[k] for k in largest[:count]):
                own.want_ends(measure.name)
                chosen.append((own, measure.name))
        self._answer(asking)
        for own, name in chosen:
            self._take(own, name)

    def _answer(self, asking: Sequence["_Alone"]) -> None:
        while any(own.waiting for own in asking):
            _answer(asking, self.seated, self.values, self.cost)

    def _take(self, own: "_Alone", name: str) -> None:
        """Take the range between ends that were built."""
        if (states := own.of(name)) is not None:
            self.by_measure[name][self.places[own.contributor.name]] = _range(self.middle[name], states)


def _range(middle: float, states: Array) -> float:
    """Largest less smallest of three states, over pairs of ends (2 pairs,)."""
    return math.hypot(*(float(np.ptp([middle, *pair])) for pair in states.reshape(-1, 2)))


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
        known_together: the same of several builds that were asked together, by the bytes of all, with all their places.
        builds_ends: whether ends are built as soon as they are known.
        read_at: by measure, components (rows, components) and values (rows,) that were read of it last.
    """

    contributor: Named
    columns: slice
    turning: bool
    mean: Array
    ends: dict[str, Array | None] = field(default_factory=dict)
    waiting: dict[bytes, tuple[Array, list[str]]] = field(default_factory=dict)
    known: dict[bytes, list[tuple[Mapping[str, Array], int]]] = field(default_factory=dict)
    known_together: dict[bytes, list[tuple[Mapping[str, Array], list[int]]]] = field(default_factory=dict)
    builds_ends: bool = True
    read_at: dict[str, tuple[Array, Array]] = field(default_factory=dict)

    @cached_property
    def plain_ends(self) -> Array | None:
        """Its ends (2, components) where they are the same for all measures; None if they depend on its effect."""
        try:
            ends = self.contributor.draw.ends(_refuse_to_read, turning=self.turning)
        except _NotKnownError:
            return None
        return ends if np.isfinite(ends).all() else None

    def ask(self, names: Iterable[str]) -> None:
        """Ask for the states of measures, as far as is known where its ends are."""
        for name in names:
            try:
                ends = self.contributor.draw.ends(_Reading(self, name), turning=self.turning)
            except _NotKnownError:
                continue
            self.ends[name] = ends if np.isfinite(ends).all() else None  # which way it acts is not known
            if self.builds_ends:
                self.want_ends(name)

    def want_ends(self, name: str) -> None:
        """Ask for the values of a measure at its ends."""
        if (ends := self.ends.get(name)) is not None:
            self._want(ends, name)

    def first_order(self, middles: Mapping[str, float]) -> dict[str, float]:
        """Ranges of measures, from readings about the mean build; nan where its ends are not known.

        A sum of the effects of each component to either side: a tilt that the highest point follows acts alike to both.

        Args:
            middles: by measure, its value of the mean build.
        """
        found = dict.fromkeys(middles, math.nan)
        alike: dict[bytes, list[str]] = {}
        for name in middles:
            if self.ends.get(name) is not None:
                alike.setdefault(self.read_at[name][0].tobytes(), []).append(name)
        for names in alike.values():
            effects = np.stack([self.read_at[name][1] - middles[name] for name in names], axis=1)
            to_sides, *_ = np.linalg.lstsq(self._sides(self.read_at[names[0]][0]), effects)
            for k, name in enumerate(names):
                if (ends := self.ends[name]) is not None:
                    found[name] = _range(0.0, self._sides(ends) @ to_sides[:, k])
        return found

    def _sides(self, rows: Array) -> Array:
        off = rows - self.mean[0, self.columns]
        return np.concatenate([off, np.abs(off)], axis=1)

    def _want(self, rows: Array, name: str) -> None:
        for row in rows:
            key = row.tobytes()
            if not self.known or self._place(key, name) is None:
                self.waiting.setdefault(key, (row, []))[1].append(name)

    def _place(self, key: bytes, name: str) -> tuple[Mapping[str, Array], int] | None:
        for own in self.known.get(key, ()):
            if name in own[0]:
                return own
        return None

    def read(self, rows: Array, name: str) -> Array:
        """Values of a measure (rows,) of components (rows, components)."""
        together = self.known_together.setdefault(rows.tobytes(), [])
        for found, at in together:
            if name in found:
                return np.asarray(found[name][at], dtype=np.float64)
        places = [own for row in rows if (own := self._place(row.tobytes(), name)) is not None] if self.known else []
        if len(places) < len(rows):
            self._want(rows, name)
            raise _NotKnownError
        if all(place[0] is places[0][0] for place in places):
            together.append((places[0][0], [k for _, k in places]))
        return np.array([found[name][k] for found, k in places], dtype=np.float64)

    def of(self, name: str) -> Array | None:
        """Values at both ends, None where these are not known."""
        ends = self.ends.get(name)
        return None if ends is None else self.read(ends, name)


@dataclass
class _Reading:
    """A measure as a draw reads it."""

    alone: _Alone
    name: str

    def __call__(self, rows: Array) -> Array:
        rows = np.asarray(rows, dtype=np.float64)
        found = self.alone.read(rows, self.name)
        self.alone.read_at[self.name] = rows, found
        return found


def _refuse_to_read(rows: Array) -> Array:
    raise _NotKnownError


_Wanted = tuple[_Alone, bytes, Array]


def _answer(asked: Sequence[_Alone], measures: Sequence[Measure], values: Values, cost: Cost) -> None:
    """Build what contributors wait for, together what the same measures ask, and let those go on that read it."""
    known = {measure.name: measure for measure in measures}
    groups: dict[tuple[str, ...], list[_Wanted]] = {}
    for own in asked:
        for key, (row, names) in own.waiting.items():
            groups.setdefault(tuple(dict.fromkeys(names)), []).append((own, key, row))
        own.waiting = {}
    every = [each for wanted in groups.values() for each in wanted]
    if len(groups) > len(measures):  # ends lie elsewhere for each measure
        groups = {
            (measure.name,): wanted
            for measure in measures
            if (wanted := [each for names, its in groups.items() if measure.name in names for each in its])
        }
    if len(groups) > 1 and len(every) <= TOGETHER:
        apart = sum(CALL + len(wanted) * cost([known[name] for name in names]) for names, wanted in groups.items())
        if len(every) * cost(measures) <= apart:
            groups = {tuple(known): every}
    for asking, wanted in groups.items():
        rows = np.repeat(asked[0].mean, len(wanted), axis=0)
        for k, (own, _, row) in enumerate(wanted):
            rows[k, own.columns] = row
        found = values(rows, [known[name] for name in asking])
        for k, (own, key, _) in enumerate(wanted):
            own.known.setdefault(key, []).append((found, k))
    for own in asked:
        own.ask(name for name in known if name not in own.ends)
