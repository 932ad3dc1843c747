"""The worst case of a measure: the builds within the regions of all contributors that lower and that raise it most.

It is looked for from several builds at several positions, all of them side by side in batches: along the gradient to
where every contributor is furthest (Frank and Wolfe 1956), along it within the regions, and with one contributor at a
time at its ends and at its middle. The largest gain is taken until nothing gains. Of a sum of effects the first step is
the last one; else the worst found is a bound from inside, and no proof that nothing is worse.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.arrays import Array
from tol3d.study.effects.extremes import ends_together
from tol3d.study.effects.regions import (
    AT_ONCE,
    Built,
    Codes,
    Rows,
    Space,
    Standing,
    builds_in,
    confined,
    furthest,
    gradient_of,
    random_ends,
    repeated,
    settled,
)
from tol3d.study.system.outcome import OK

Side = Literal["low", "high"]

ROUNDS: Final = 40
USUAL_ROUNDS: Final = 6
"""Usual number of rounds of a search, to estimate its cost."""
STEP: Final = 0.05
"""Step of differences, in sigma of each component."""
SIGMA: Final = 1.0
"""The same for the slopes whose ends are the first starts."""
SHARES: Final = 0.5 ** np.arange(9)
"""Fractions of the way to the point where all contributors are furthest."""
STRIDES: Final = 8.0 * 0.25 ** np.arange(9)
"""Strides along the gradient within the regions: of the largest component, in its sigma."""
LEAST: Final = 1e-12
"""The same for an unmoved measure, in its unit."""
GAIN: Final = 1e-7
"""Fraction of the measure's total movement; a row that gains less goes no further."""


@dataclass(frozen=True, eq=False)
class WorstBuild:
    """A build.

    Args:
        value: of the measure, in its unit.
        deviations: (components,) [mm, rad, K].
        positions: at which it is read, of one row.
        code: its status.
    """

    value: float
    deviations: Array
    positions: Standing
    code: int = OK


@dataclass(frozen=True, eq=False)
class WorstCase:
    """Result of a search.

    Args:
        low, high: the builds that lower and that raise the measure most; None if none is measured.
        unseated: a build within the regions that cannot be assembled; None if none was met.
        met: number of such builds that were met.
        evaluations: number of builds evaluated.
    """

    low: WorstBuild | None
    high: WorstBuild | None
    unseated: WorstBuild | None
    met: int
    evaluations: int

    def with_builds(self, builds: Sequence[WorstBuild]) -> "WorstCase":
        """The same where builds within the regions, known from elsewhere, are worse than those that were found."""
        low = min([*([self.low] if self.low else []), *builds], key=lambda own: own.value, default=None)
        high = max([*([self.high] if self.high else []), *builds], key=lambda own: own.value, default=None)
        return replace(self, low=low, high=high)


@dataclass(frozen=True, eq=False)
class Starts:
    """Builds from which a worst case is looked for.

    Args:
        rows: builds within the regions.
        positions: of each.
        signs: 1 for upwards, -1 for downwards (rows,).
    """

    rows: Rows
    positions: Standing
    signs: Array

    @classmethod
    def both_ways(cls, rows: Rows, positions: Standing) -> "Starts":
        """Each build taken down and up."""
        count = len(rows.deviations)
        twice = {name: np.concatenate([own, own]) for name, own in positions.items()}
        return cls(Rows.joined([rows, rows]), twice, np.repeat([-1.0, 1.0], count))

    def and_(self, other: "Starts") -> "Starts":
        """These and others below them."""
        places = {name: np.concatenate([own, other.positions[name]]) for name, own in self.positions.items()}
        return Starts(Rows.joined([self.rows, other.rows]), places, np.concatenate([self.signs, other.signs]))


def first_starts(space: Space, built: Built, at_rest: Standing, random: int) -> Starts:
    """The mean build, the ends by its slopes, and builds at random ends: all at rest.

    Args:
        space, built: which.
        at_rest: positions of one row.
        random: number of ends along slopes drawn at random.
    """
    mean = space.mean[None]
    values, _ = built(mean, at_rest)
    slopes = gradient_of(space, built, mean, at_rest, values, SIGMA)
    ends = settled(space, furthest(space, np.repeat(mean, 2, axis=0), np.concatenate([-slopes, slopes])))
    several = Rows.joined([builds_in(space, mean), random_ends(space, random, seed=1)])
    found = Starts.both_ways(several, repeated(at_rest, random + 1))
    found = found.and_(Starts(ends, repeated(at_rest, 2), np.array([-1.0, 1.0])))
    stated = _stated_ends(space, mean, slopes[0])
    known = np.asarray(np.isfinite(stated.deviations).all(axis=1))  # ends are not where a slope is not
    places = repeated(at_rest, int(known.sum()))
    return found.and_(Starts(stated.at(known), places, np.array([-1.0, 1.0])[known]))


def _stated_ends(space: Space, mean: Array, slopes: Array) -> Rows:
    """The ends by slopes as first order states them (2, components): also of contributors that have no slope."""
    acting = [drawing for drawing in space.drawings if drawing.acts]
    ends = ends_together(
        acting, {own.name: slopes[own.columns] for own in acting}, {own.name: own.turning for own in acting}
    )
    builds = np.repeat(mean, 2, axis=0)
    for own in acting:
        builds[:, own.columns] = ends[own.name]
    return Rows(builds, np.stack([-slopes, slopes]), np.ones_like(builds))


def joined(several: Sequence[Starts]) -> Starts:
    """Starts below each other."""
    first, *others = several
    for other in others:
        first = first.and_(other)
    return first


def builds_a_row(space: Space) -> int:
    """Number of builds per row that a search of usual length takes."""
    steps = len(SHARES) + len(STRIDES) + 4 * len(space.free) + 3 * len(space.bound)
    return USUAL_ROUNDS * (2 * len(space.acting) + steps)


def worst_case(space: Space, built: Built, starts: Starts, *, most: int, rounds: int = ROUNDS) -> WorstCase:
    """The worst builds of a measure.

    Args:
        space: the regions of the contributors.
        built: the measure.
        starts: from which it is looked for.
        most: evaluations after which no step is begun.
        rounds: steps at most.
    """
    search = _Search(space, built, starts)
    for _ in range(rounds):
        if search.evaluations > most or not search.step():
            break
    return search.found


@dataclass(eq=False)
class _Search:
    """Rows from all starts, each down or up."""

    space: Space
    built: Built
    starts: Starts
    evaluations: int = 0
    met: int = 0
    unseated: WorstBuild | None = None
    best: dict[Side, WorstBuild] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.rows = Rows.joined([self.starts.rows])
        self.places, self.signs = self.starts.positions, self.starts.signs
        self.values = self._values(self.rows.deviations, self.places)
        self.going = np.isfinite(self.values)

    def _count(self, deviations: Array, positions: Standing) -> tuple[Array, Codes]:
        self.evaluations += len(deviations)
        return self.built(deviations, positions)

    def _values(self, deviations: Array, positions: Standing) -> Array:
        """Values of builds, the worst of which are noted."""
        found, codes = np.empty(len(deviations)), np.empty(len(deviations), dtype=np.int8)
        many = max(1, AT_ONCE // max(1, deviations.shape[1]))
        for first in range(0, len(deviations), many):
            rows = slice(first, first + many)
            found[rows], codes[rows] = self._count(deviations[rows], {n: own[rows] for n, own in positions.items()})
        if (failed := np.flatnonzero(codes != OK)).size:
            self.met += len(failed)
            if self.unseated is None:
                self.unseated = self._build(failed[0], found, deviations, positions, codes)
        if np.isfinite(found).any():
            ends: tuple[tuple[Side, int], ...] = (("low", int(np.nanargmin(found))), ("high", int(np.nanargmax(found))))
            for side, k in ends:
                known = self.best.get(side)
                if known is None or (found[k] < known.value if side == "low" else found[k] > known.value):
                    self.best[side] = self._build(k, found, deviations, positions, codes)
        return found

    def _build(self, k: int, values: Array, deviations: Array, positions: Standing, codes: Codes) -> WorstBuild:
        at = {name: own[k : k + 1] for name, own in positions.items()}
        return WorstBuild(float(values[k]), deviations[k].copy(), at, int(codes[k]))

    @property
    def found(self) -> WorstCase:
        """The worst of all."""
        return WorstCase(self.best.get("low"), self.best.get("high"), self.unseated, self.met, self.evaluations)

    def step(self) -> bool:
        """The best step of each row that is on its way; whether any is left."""
        going = np.flatnonzero(self.going)
        if not going.size or not self.space.acting.size:
            return False
        rows, signs = self.rows.at(going), self.signs[going]
        places = {name: own[going] for name, own in self.places.items()}
        values = self.values[going]
        slopes = signs[:, None] * gradient_of(self.space, self._count, rows.deviations, places, values, STEP)
        least = GAIN * max(float(np.nanmax(self.values) - np.nanmin(self.values)), LEAST)
        together = [*self._to_ends(rows, slopes), *self._along(rows, slopes)]
        ended = np.flatnonzero(~(self._take(going, together) > least))
        if ended.size:
            alone = self._alone(rows.at(ended), slopes[ended])
            stopped = ~(self._take(going[ended], alone) > least)
            self.going[going[ended[stopped]]] = False
        self._drop_doubles()
        return bool(self.going.any())

    def _take(self, going: NDArray[np.int64], several: Sequence[Rows]) -> Array:
        """Take the best of several steps of rows where it gains; return the gain (rows,)."""
        if not several:
            return np.zeros(len(going))
        steps = settled(self.space, Rows.joined(several))
        places = {name: np.concatenate([own[going]] * len(several)) for name, own in self.places.items()}
        found = self._values(steps.deviations, places).reshape(len(several), -1).T
        before, signs = self.values[going], self.signs[going]
        gains = np.where(np.isfinite(found), signs[:, None] * (found - before[:, None]), -np.inf)
        best = gains.argmax(axis=1)
        gain = gains[np.arange(len(going)), best]
        better = np.flatnonzero(gain > 0.0)
        self.rows.put(going[better], steps.at(best[better] * len(going) + better))
        self.values[going[better]] = found[better, best[better]]
        return np.asarray(gain)

    def _drop_doubles(self) -> None:
        """Let go only one of the rows that have come to the same build."""
        seen: set[bytes] = set()
        for row in np.flatnonzero(self.going):
            place = [own[row].tobytes() for own in self.places.values()]
            key = b"".join([self.signs[row].tobytes(), self.rows.deviations[row].tobytes(), *place])
            if key in seen:
                self.going[row] = False
            seen.add(key)

    def _to_ends(self, rows: Rows, slopes: Array) -> list[Rows]:
        """Shares of the way to where all are furthest."""
        ends = furthest(self.space, rows.deviations, slopes)
        found = []
        for share in SHARES:
            part = rows.deviations + share * (ends.deviations - rows.deviations)
            if share < 1.0:
                part = self._without_gaps(confined(self.space, part), rows)
            reach = rows.reach + share * (1.0 - rows.reach)
            found.append(Rows(part, slopes, reach))
        return found

    def _without_gaps(self, deviations: Array, rows: Rows) -> Array:
        """Contributors that may not lie between two of their deviations stay where they are."""
        for own, region in self.space.free:
            if not region.fills:
                deviations[:, own.columns] = rows.deviations[:, own.columns]
        return deviations

    def _along(self, rows: Rows, slopes: Array) -> list[Rows]:
        """Strides along the gradient, each component in its sigma, of contributors whose nearest points are known."""
        scaled = self.space.sigmas * slopes
        size = np.abs(scaled).max(axis=1, keepdims=True)
        way = self.space.sigmas * scaled / np.where(size > 0.0, size, 1.0)
        for own in self.space.bound:
            way[:, own.columns] = 0.0
        for own, region in self.space.free:
            if not region.has_nearest:
                way[:, own.columns] = 0.0
        return [
            Rows(confined(self.space, rows.deviations + stride * way), rows.towards, rows.reach) for stride in STRIDES
        ]

    def _alone(self, rows: Rows, slopes: Array) -> list[Rows]:
        """One contributor at its furthest, at its nearest, and half way and all the way to its mean."""
        found = []
        for own, region in self.space.free:
            if not self.space.sigmas[own.columns].any():
                continue
            along = slopes[:, own.columns]
            along = np.where(along.any(axis=1, keepdims=True), along, 1.0)
            middle = np.broadcast_to(self.space.mean[own.columns], along.shape)
            here = rows.deviations[:, own.columns]
            places = [region.furthest(along), region.furthest(-along)]
            if region.fills or region.has_nearest:
                places += [region.confined(middle), region.confined((here + middle) / 2)]
            for place in places:
                deviations = rows.deviations.copy()
                deviations[:, own.columns] = place
                found.append(Rows(deviations, rows.towards, rows.reach))
        for own in self.space.bound:
            for share in (1.0, 0.5, 0.0):
                towards, reach = rows.towards.copy(), rows.reach.copy()
                towards[:, own.columns], reach[:, own.columns] = slopes[:, own.columns], share
                found.append(Rows(rows.deviations.copy(), towards, reach))
        return found
