"""Design points: the most likely builds that fail, found by gradients, by probes and, if there is no gradient, without.

Sources: Hasofer and Lind 1974; Rackwitz and Fiessler 1978; Zhang and Der Kiureghian 1995 (the step's length).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.analyses.limit_state import LimitState, Positions, at_place, repeated, taken, tiled
from tol3d.numerics.arrays import Array

ROUNDS: Final = 60
FEWEST_ROUNDS: Final = 12
WALK_MINUTES: Final = 0.4
"""Time of a processor for a walk; where builds take long it has fewer rounds."""
MET: Final = 1e-4
"""Remaining distance from the limit, as a share of that of the mean build, and of the way across it."""
FURTHEST: Final = 9.0
"""Distance from the origin beyond which nothing is sought."""
HALVINGS: Final = 30
SHRINKS: Final = 6
"""Halvings of a step that leads nowhere."""
PENALTY: Final = 2.0
"""Weight of the limit in the merit of a step, over the weight needed."""
LEAST: Final = 1e-300
AT_ORIGIN: Final = 1e-3
"""Length of each normal of a start at the origin, where a length has no direction."""
SAME: Final = 0.1
"""Design points nearer to each other are one, and by this share of their distance from the origin."""
FARTHER: Final = 2.0
"""Distance beyond that of the nearest design point up to which builds are drawn about another one."""
MOST: Final = 24
"""Design points at a position."""


@dataclass(frozen=True, eq=False)
class DesignPoint:
    """The most likely build that fails, nearby.

    Args:
        normals: it (dimension,).
        positions: at which it is read, of one row.
        gradient: of the limit state there (dimension,); zeros where it is not known.
        beyond: whether the build at the origin fails, and this one is the most likely that does not.
        smooth: whether a gradient led to it; else it is the nearest that was found of an edge, or of builds that cannot
            be assembled.
    """

    normals: Array
    positions: Positions
    gradient: Array
    beyond: bool = False
    smooth: bool = True

    @property
    def distance(self) -> float:
        """Its distance from the origin."""
        return float(np.linalg.norm(self.normals))

    @property
    def beta(self) -> float:
        """The same; below 0 where the build at the origin fails."""
        return -self.distance if self.beyond else self.distance

    @property
    def sensitivities(self) -> Array:
        """Direction cosines of the design point (dimension,): their squares are shares of the failures."""
        return self.normals / (self.distance or 1.0)


def is_same(first: Array, other: Array) -> bool:
    """True if two design points coincide."""
    return float(np.linalg.norm(first - other)) < SAME * max(1.0, float(np.linalg.norm(first)))


def design_points(
    state: LimitState, positions: Positions, places: int, starts: int, generator: np.random.Generator
) -> list[list[DesignPoint]]:
    """Design points at each of several positions, the nearest ones first.

    The first walk starts at the origin, the next one opposite to where it ended, the others at random.
    """
    begun = np.full((places, state.dimension), AT_ORIGIN)
    first, beyond = _walked(state, begun, positions, np.zeros(places, dtype=bool), known=False)
    found = [[own] if own is not None else [] for own in first]
    if starts > 1:
        others = generator.standard_normal((starts - 1, places, state.dimension))
        for place, own in enumerate(first):
            if own is not None:
                others[0, place] = -own.normals + 0.05 * others[0, place]
        rows, again = others.reshape(-1, state.dimension), starts - 1
        size = _size(state.at(begun, positions)[0])
        more, _ = _walked(state, rows, tiled(positions, again), np.tile(beyond, again), known=True, scale=size)
        for k, own in enumerate(more):
            if own is not None:
                found[k % places].append(own)
    return [kept(own) for own in found]


def points_from(state: LimitState, starts: Array, positions: Positions, beyond: NDArray[np.bool_]) -> list[DesignPoint]:
    """Design points from builds (n, dimension) that fail, at their positions.

    Args:
        state: the limit state.
        starts, positions: of the builds.
        beyond: where the build at the origin fails; without a gradient none is sought there.
    """
    if not len(starts):
        return []
    walked, _ = _walked(state, starts, positions, beyond, known=True)
    left = np.array([k for k, own in enumerate(walked) if own is None and not beyond[k]], dtype=np.int64)
    found = [own for own in walked if own is not None]
    ends = nearest_failing(state, starts[left], taken(positions, left))
    zero = np.zeros(state.dimension)
    return found + [
        DesignPoint(end, at_place(positions, int(k)), zero, smooth=False) for end, k in zip(ends, left, strict=True)
    ]


def kept(points: Sequence[DesignPoint]) -> list[DesignPoint]:
    """Design points of a position that differ and are near enough to matter, the nearest first."""
    mine: list[DesignPoint] = []
    for point in sorted(points, key=lambda each: each.distance):
        if len(mine) == MOST or point.distance > (mine[0] if mine else point).distance + FARTHER:
            break
        if not any(is_same(point.normals, other.normals) for other in mine):
            mine.append(point)
    return mine


def _walked(
    state: LimitState,
    begun: Array,
    positions: Positions,
    beyond: NDArray[np.bool_],
    *,
    known: bool,
    scale: float | None = None,
) -> tuple[list[DesignPoint | None], NDArray[np.bool_]]:
    """The design point to which each start leads, and whether the build at the origin fails."""
    walk = _Walk.begun(state, begun, positions, scale)
    if not known:
        beyond = walk.inside < 0.0
    round_minutes = max(2 * len(state.acting) * len(begun) * state.response.minutes, LEAST)
    for _ in range(int(np.clip(WALK_MINUTES / round_minutes, FEWEST_ROUNDS, ROUNDS))):
        if not walk.step():
            break
    smooth = walk.met.copy()
    walk.end_on_rays(beyond)
    rough = np.flatnonzero(walk.met & ~smooth & ~beyond)
    if rough.size:
        walk.normals[rough] = nearest_failing(state, walk.normals[rough], taken(positions, rough))
    walk.met &= walk.sizes <= FURTHEST
    found = [
        DesignPoint(walk.normals[k], at_place(positions, k), walk.gradients[k], bool(beyond[k]), smooth=bool(smooth[k]))
        if walk.met[k]
        else None
        for k in range(len(begun))
    ]
    return found, beyond


def _size(inside: Array) -> float:
    """Size of a limit state, by its values (n,)."""
    return float(np.nanmax(np.abs(inside), initial=0.0)) or 1.0


@dataclass(eq=False)
class _Walk:
    """Rows on their way to design points, each by the steps of Rackwitz and Fiessler as far as they lead somewhere.

    Args:
        state: the limit state.
        positions: at which each row is read.
        normals: where they are (n, dimension).
        inside: the limit state there (n,).
        gradients: where they were found last (n, dimension).
        scale: of the limit state.
        met, ended: which are there, and which go no further (n,).
    """

    state: LimitState
    positions: Positions
    normals: Array
    inside: Array
    gradients: Array
    scale: float
    met: NDArray[np.bool_]
    ended: NDArray[np.bool_]

    @classmethod
    def begun(cls, state: LimitState, normals: Array, positions: Positions, scale: float | None = None) -> "_Walk":
        """At their starts; those that cannot be assembled go nowhere."""
        inside, _ = state.at(normals, positions)
        scale, none = scale or _size(inside), np.zeros(len(normals), dtype=bool)
        return cls(state, positions, normals.copy(), inside, np.zeros_like(normals), scale, none, ~np.isfinite(inside))

    @property
    def sizes(self) -> Array:
        """Distances from the origin (n,)."""
        return np.asarray(np.linalg.norm(self.normals, axis=1))

    def step(self) -> bool:
        """One step of all unfinished rows; True if any is left."""
        rows = np.flatnonzero(~self.ended)
        if not rows.size:
            return False
        z, inside = self.normals[rows], self.inside[rows]
        gradient = self.state.gradient(z, taken(self.positions, rows))
        self.gradients[rows] = gradient
        square = np.maximum((gradient * gradient).sum(axis=1), LEAST)
        aim = ((gradient * z).sum(axis=1) - inside) / square
        steps = aim[:, None] * gradient - z
        left = np.linalg.norm(steps, axis=1)
        there = (np.abs(inside) <= MET * self.scale) & (left <= 10 * MET * (1.0 + np.linalg.norm(z, axis=1)))
        self.met[rows[there]] = self.ended[rows[there]] = True
        going = ~there
        weights = PENALTY * (1.0 + np.linalg.norm(z, axis=1)) / np.sqrt(square)
        self._go(rows[going], steps[going], weights[going])
        return True

    def end_on_rays(self, beyond: NDArray[np.bool_]) -> None:
        """Take rows that found no rest, such as at an edge of the limit, to it along their rays, if it is there."""
        rows = np.flatnonzero(~self.met & np.isfinite(self.inside) & (self.sizes > 0.0))
        if not rows.size:
            return
        own, sign = taken(self.positions, rows), np.where(beyond[rows], -1.0, 1.0)
        low, high = np.zeros(len(rows)), FURTHEST / self.sizes[rows]
        crossed = sign * self.state.at(high[:, None] * self.normals[rows], own)[0] < 0.0
        rows, own, sign, low, high = (
            rows[crossed],
            taken(own, np.flatnonzero(crossed)),
            sign[crossed],
            low[crossed],
            high[crossed],
        )
        if not rows.size:
            return
        for _ in range(HALVINGS):
            middle = (low + high) / 2
            inside = sign * self.state.at(middle[:, None] * self.normals[rows], own)[0] >= 0.0
            low, high = np.where(inside, middle, low), np.where(inside, high, middle)
        near = high < 2.0
        self.normals[rows[near]] *= high[near, None]
        self.met[rows[near]] = True

    def _go(self, rows: NDArray[np.int64], steps: Array, weights: Array) -> None:
        """The part of each step that improves rows: nearer to the origin, or to the limit."""
        merits = 0.5 * self.sizes[rows] ** 2 + weights * np.abs(self.inside[rows])
        waiting, share = np.arange(len(rows)), 1.0
        for _ in range(SHRINKS):
            if not waiting.size:
                return
            own = rows[waiting]
            there = self.normals[own] + share * steps[waiting]
            inside, _ = self.state.at(there, taken(self.positions, own))
            good = 0.5 * (there * there).sum(axis=1) + weights[waiting] * np.abs(inside) < merits[waiting]
            self.normals[own[good]], self.inside[own[good]] = there[good], inside[good]
            waiting, share = waiting[~good], share / 2
        self.ended[rows[waiting]] = True  # no progress


# without gradients ----------------------------------------------------------------------------------

TRIES: Final = 24
"""Random moves of a round, besides one for each normal."""
TRIED_ROUNDS: Final = 16
LEAST_MOVE: Final = 1e-3


def nearest_failing(state: LimitState, normals: Array, positions: Positions) -> Array:
    """Builds that fail (n, dimension) nearer to the origin than those given, by moves that keep failing.

    Each round shrinks the whole, single normals, those of them together that may shrink, and moves at random.
    """
    z, acting = normals.copy(), state.acting
    if not len(z):
        return z
    generator = np.random.default_rng(1)
    shares, count = np.full(len(z), 0.5), len(acting)
    for _ in range(TRIED_ROUNDS):
        going = np.flatnonzero(shares > LEAST_MOVE)
        if not going.size:
            break
        here, share = z[going], shares[going, None, None]
        moves = np.repeat(here[:, None], count + 1 + TRIES, axis=1)
        moves[:, np.arange(count), acting] *= 1.0 - share[:, 0]
        moves[:, count] *= 1.0 - share[:, 0] / 2
        noise = np.zeros((len(here), TRIES, here.shape[1]))
        noise[:, :, acting] = generator.standard_normal((len(here), TRIES, count)) / np.sqrt(max(count, 1))
        size = np.linalg.norm(here, axis=1)[:, None, None]
        moves[:, count + 1 :] = moves[:, count + 1 :] * (1.0 - share / 4) + share / 2 * size * noise
        own = taken(positions, going)
        fails = _fails(state, moves, own)
        together = here.copy()
        for k, may in enumerate(fails[:, :count]):
            together[k, acting[may]] *= 1.0 - share[k, 0, 0]
        moves = np.concatenate([moves, together[:, None]], axis=1)
        fails = np.concatenate([fails, _fails(state, together[:, None], own)], axis=1)
        sizes = np.where(fails, np.linalg.norm(moves, axis=2), np.inf)
        best = sizes.argmin(axis=1)
        least = sizes[np.arange(len(here)), best]
        better = least < np.linalg.norm(here, axis=1) * (1.0 - 1e-6)
        z[going[better]] = moves[better, best[better]]
        shares[going[~better]] /= 2
    return z


def _fails(state: LimitState, moves: Array, positions: Positions) -> NDArray[np.bool_]:
    rows, tries, dimension = moves.shape
    return state.failing(moves.reshape(-1, dimension), repeated(positions, tries))[0].reshape(rows, tries)


def probed(
    state: LimitState, positions: Positions, points: Sequence[Sequence[DesignPoint]], generator: np.random.Generator
) -> tuple[Array, NDArray[np.int64]]:
    """Builds that fail where no design point says so, and their places: along each normal, and in random directions."""
    beta = min((point[0].distance for point in points if point), default=FURTHEST)
    radius, acting = float(np.clip(beta + 1.0, 3.0, 6.5)), state.acting
    count = len(acting)
    if not count:
        return np.zeros((0, state.dimension)), np.zeros(0, dtype=np.int64)
    directions = np.zeros((2 * count + 3 * PROBES, state.dimension))
    directions[np.arange(count), acting], directions[count + np.arange(count), acting] = 1.0, -1.0
    some = generator.standard_normal((3 * PROBES, count))
    for first, most in ((0, 2), (PROBES, 3)):
        order = generator.random((PROBES, count)).argsort(axis=1)
        some[first : first + PROBES] *= order < most
    directions[2 * count :, acting] = some / np.maximum(np.linalg.norm(some, axis=1, keepdims=True), LEAST)
    places = generator.integers(len(points), size=len(directions))
    own = taken(positions, places)
    builds = radius * directions
    fails, _ = state.failing(builds, own)
    explained = np.array([_explained(build, points[place]) for build, place in zip(builds, places, strict=True)])
    rows = np.flatnonzero(fails & ~explained)
    if not rows.size:
        return builds[rows], places[rows]
    low, high, own = np.zeros(len(rows)), np.ones(len(rows)), taken(own, rows)
    for _ in range(COARSE):
        middle = (low + high) / 2
        fails, _ = state.failing(middle[:, None] * builds[rows], own)
        low, high = np.where(fails, low, middle), np.where(fails, middle, high)
    edges = high[:, None] * builds[rows]
    explained = np.array([_explained(edge, points[place]) for edge, place in zip(edges, places[rows], strict=True)])
    chosen = np.flatnonzero(~explained)
    chosen = chosen[np.argsort(high[chosen])][:MOST_PROBED]
    return edges[chosen], places[rows][chosen]


PROBES: Final = 16
"""Random directions of two normals, of three, and of all."""
COARSE: Final = 8
MOST_PROBED: Final = 6
ABOUT: Final = 0.5
"""A build this much nearer than the plane of a design point is not explained by it."""


def _explained(build: Array, points: Sequence[DesignPoint]) -> bool:
    return any(point.beyond or float(point.sensitivities @ build) >= point.distance - ABOUT for point in points)
