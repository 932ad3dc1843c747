"""The regions of all contributors of a measure together: their furthest builds, and builds between them.

Contributors that read others lie where these leave them: so far towards their furthest point there.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.arrays import Array
from tol3d.statistics.distributions import DeviationLaw
from tol3d.study.system.contributor import Contributor
from tol3d.study.system.dependent import Dependent, Given, in_draw_order, reads_of
from tol3d.study.system.draw import Draw, component_sigmas
from tol3d.study.system.measure import Measure
from tol3d.study.system.region import Filled, Region, region_of
from tol3d.study.system.stated import component_slices
from tol3d.study.system.system import System

Codes = NDArray[np.int8]
Standing = Mapping[str, Array]
"""Positions (rows,) of the system's streams."""
Built = Callable[[Array, Standing], tuple[Array, Codes]]
"""A measure (rows,) in its unit and statuses (rows,) of deviations (rows, components) at positions."""

NOISE: Final = 1e-9
"""Fraction of the largest values; smaller differences are rounding."""
AT_ONCE: Final = 2**21
"""Numbers of builds in one batch."""


@dataclass(frozen=True)
class Drawing:
    """A contributor as it is drawn; its part for the order of drawing.

    Args:
        name, draw: of it.
        columns: of its deviations.
        turning: whether its direction turns through all angles from trial to trial.
        acts: whether it acts on the measure, or is read by one that does.
    """

    name: str
    draw: Draw
    columns: slice
    turning: bool = False
    acts: bool = True

    @property
    def distribution(self) -> DeviationLaw:
        """See Contributor."""
        return self.draw.distribution


@dataclass(frozen=True, eq=False)
class Space:
    """The regions of all contributors together.

    Args:
        drawings: of all contributors, in the order of their columns.
    """

    drawings: Sequence[Drawing]

    @cached_property
    def free(self) -> Sequence[tuple[Drawing, Region]]:
        """Contributors that act and read no others, with their regions."""
        return [
            (drawing, region_of(drawing.draw, turning=drawing.turning))
            for drawing in self.drawings
            if drawing.acts and not isinstance(drawing.draw, Dependent)
        ]

    @cached_property
    def bound(self) -> Sequence[Drawing]:
        """Contributors that act and read others, in the order of drawing."""
        return [own for own in in_draw_order(self.drawings) if own.acts and isinstance(own.draw, Dependent)]

    @cached_property
    def read(self) -> frozenset[str]:
        """Names of those that are read."""
        return frozenset(name for own in self.bound for name in reads_of(own))

    @cached_property
    def mean(self) -> Array:
        """All at their means (components,)."""
        means = [np.array(drawing.draw.mean(turning=drawing.turning), dtype=float) for drawing in self.drawings]
        return np.concatenate([np.zeros(0), *means])

    @cached_property
    def sigmas(self) -> Array:
        """Sigma of each component."""
        each = [np.array(component_sigmas(drawing.draw), dtype=float) for drawing in self.drawings]
        found = np.concatenate([np.zeros(0), *each])
        return np.where(found > 0.0, found, 0.0)

    @cached_property
    def acting(self) -> NDArray[np.int64]:
        """Columns that are moved: those of contributors that act and vary."""
        own = [np.arange(drawing.columns.start, drawing.columns.stop) for drawing in self.drawings if drawing.acts]
        columns = np.concatenate(own) if own else np.zeros(0, dtype=np.int64)
        return np.asarray(columns[self.sigmas[columns] > 0.0])


@dataclass(frozen=True, eq=False)
class Rows:
    """Builds on their way.

    Args:
        deviations: (rows, components).
        towards: of contributors that read others, their direction in the remaining region (rows, components).
        reach: fraction of that way, 0 in the middle of what remains and 1 at the end (rows, components).
    """

    deviations: Array
    towards: Array
    reach: Array

    def at(self, rows: NDArray[np.int64] | NDArray[np.bool_]) -> "Rows":
        """Some of them."""
        return Rows(self.deviations[rows], self.towards[rows], self.reach[rows])

    def put(self, rows: NDArray[np.int64], others: "Rows") -> None:
        """Others in place of some of them."""
        self.deviations[rows], self.towards[rows], self.reach[rows] = others.deviations, others.towards, others.reach

    @classmethod
    def joined(cls, several: "Iterable[Rows]") -> "Rows":
        """Rows below each other."""
        own = [*several]
        return cls(
            np.concatenate([each.deviations for each in own]),
            np.concatenate([each.towards for each in own]),
            np.concatenate([each.reach for each in own]),
        )


def space_of(system: System, measure: Measure, draws: Mapping[str, Draw], acting: Iterable[Contributor]) -> Space:
    """The regions that act on a measure, or are read by contributors that act.

    Args:
        system, measure: which.
        draws: of all contributors, by name: the system's own, or other tolerances.
        acting: contributors that act on it.
    """
    names = {own.name for own in acting}
    while added := {read for name in names for read in _reads(draws[name])} - names:
        names |= added
    slices = component_slices(system)
    return Space(
        [
            Drawing(
                contributor.name,
                draws[contributor.name],
                slices[contributor.name],
                system.turns_at_random(contributor, measure.positions),
                contributor.name in names,
            )
            for contributor in system.contributors
        ]
    )


def _reads(draw: Draw) -> Sequence[str]:
    return draw.reads if isinstance(draw, Dependent) else ()


def gradient_of(
    space: Space, built: Built, deviations: Array, positions: Standing, values: Array, step: float
) -> Array:
    """Change of a measure with each component (rows, components), one-sided where a build beside it has no value.

    Args:
        space, built: which.
        deviations, positions: of the builds.
        values: of the measure there (rows,).
        step: of differences, in sigma of each component.
    """
    acting = space.acting
    if not len(acting):
        return np.zeros_like(deviations)
    steps = step * space.sigmas[acting]
    shifts = np.zeros((2 * len(acting), deviations.shape[1]))
    shifts[np.arange(len(acting)), acting] = steps
    shifts[len(acting) + np.arange(len(acting)), acting] = -steps
    found = np.empty((len(deviations), len(shifts)))
    many = max(1, AT_ONCE // max(1, shifts.size))
    for first in range(0, len(deviations), many):
        rows = slice(first, first + many)
        builds = (deviations[rows, None] + shifts).reshape(-1, deviations.shape[1])
        places = repeated({name: own[rows] for name, own in positions.items()}, len(shifts))
        found[rows] = built(builds, places)[0].reshape(-1, len(shifts))
    above, below = found[:, : len(acting)], found[:, len(acting) :]
    noise = NOISE * np.nanmax(np.abs(found), axis=1, keepdims=True, initial=0.0)
    up, down = (
        np.where(np.isfinite(above), above, values[:, None]),
        np.where(np.isfinite(below), below, values[:, None]),
    )
    change = np.where(np.abs(up - down) > noise, up - down, 0.0)
    sides = np.isfinite(above).astype(float) + np.isfinite(below)
    gradient = np.zeros_like(deviations)
    gradient[:, acting] = change / (np.maximum(sides, 1.0) * steps)
    return np.nan_to_num(gradient)


def settled(space: Space, rows: Rows) -> Rows:
    """Contributors that read others where these leave them: so far from its middle towards their furthest point."""
    for own in space.bound:
        assert isinstance(own.draw, Dependent)
        known: dict[bytes, Remaining] = {}
        given = {name: rows.deviations[:, _columns(space, name)] for name in own.draw.reads}
        towards, reach = rows.towards[:, own.columns], rows.reach[:, own.columns]
        for k, slopes in enumerate(towards):
            key = b"".join(each[k].tobytes() for each in given.values())
            if key not in known:
                one = {name: each[k][:, None] for name, each in given.items()}
                known[key] = Remaining(own.draw, one, space.mean[own.columns], space.sigmas[own.columns])
            rows.deviations[k, own.columns] = known[key].point(slopes, reach[k])
    return rows


@dataclass(frozen=True, eq=False)
class Remaining:
    """The region that what a contributor reads leaves it, in one build.

    Args:
        draw: its own.
        given: what it reads (components, 1).
        mean, sigmas: of its components over all that it may read.
    """

    draw: Dependent
    given: Given
    mean: Array
    sigmas: Array
    known: dict[bytes, Array] = field(default_factory=dict)

    def point(self, slopes: Array, reach: Array) -> Array:
        """The point (components,) so far from the middle to the furthest along slopes; the middle where these are 0.

        The furthest at once of a draw that may not lie between two of its deviations.
        """
        if not (isinstance(self.draw, Filled) and self.draw.fills):
            return self._furthest(slopes if slopes.any() else np.ones_like(slopes))
        return self.middle + reach * (self._furthest(slopes) - self.middle) if slopes.any() else self.middle

    @cached_property
    def middle(self) -> Array:
        """Half way between two opposite points; the mean over all that is read, where it lies there too."""
        ones = np.ones_like(self.mean)
        found = 0.5 * (self._furthest(ones) + self._furthest(-ones))
        return np.where(np.abs(found - self.mean) <= NOISE * self.sigmas, self.mean, found)

    def _furthest(self, slopes: Array) -> Array:
        key = slopes.tobytes()
        if key not in self.known:
            self.known[key] = self.draw.furthest_given(self.given, slopes)
        return self.known[key]


def _columns(space: Space, name: str) -> slice:
    return next(drawing.columns for drawing in space.drawings if drawing.name == name)


def furthest(space: Space, deviations: Array, slopes: Array) -> Rows:
    """All contributors at their furthest along slopes (rows, components); those without a slope stay.

    Those that read others are told where to, and not yet moved there; see `settled`.
    """
    found = deviations.copy()
    for own, region in space.free:
        along = slopes[:, own.columns]
        moved = along.any(axis=1)
        if moved.any():
            found[moved, own.columns] = region.furthest(along[moved])
    return Rows(found, slopes.copy(), np.ones_like(found))


def confined(space: Space, deviations: Array) -> Array:
    """Builds with contributors taken into their regions, as far as the nearest point of these is known."""
    found = deviations.copy()
    for own, region in space.free:
        found[:, own.columns] = region.confined(found[:, own.columns])
    return found


def within_regions(space: Space, deviations: Array) -> NDArray[np.bool_]:
    """True where builds (rows, components) lie in the regions, as far as these have a nearest point."""
    moved = np.abs(confined(space, deviations) - deviations)
    return np.asarray((moved <= NOISE * (np.abs(deviations) + space.sigmas)).all(axis=1))


def builds_in(space: Space, deviations: Array) -> Rows:
    """Builds (rows, components) taken into the regions, those that read others in the middle of what these leave.

    Contributors whose deviations have gaps, and no nearest point that is known, are at an end where they are at their
    mean.
    """
    found = confined(space, deviations)
    for own, region in space.free:
        if not (region.fills or region.has_nearest):
            at_mean = (found[:, own.columns] == space.mean[own.columns]).all(axis=1)
            found[at_mean, own.columns] = region.furthest(np.ones((1, own.columns.stop - own.columns.start)))[0]
    return settled(space, Rows(found, np.zeros_like(found), np.zeros_like(found)))


def random_ends(space: Space, count: int, seed: int) -> Rows:
    """Builds with all contributors at their ends, along slopes drawn at random."""
    slopes = np.random.default_rng(seed).standard_normal((count, len(space.mean)))
    return settled(space, furthest(space, np.repeat(space.mean[None], count, axis=0), slopes))


def repeated(positions: Standing, count: int) -> Standing:
    """Each row's positions, repeated."""
    return {name: np.repeat(own, count, axis=0) for name, own in positions.items()}
