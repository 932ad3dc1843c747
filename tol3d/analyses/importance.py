"""Importance sampling about design points: whatever these are worth, its mean is the probability.

Builds are drawn from a mixture: plain ones, normals about each design point, and normals beyond the plane through it.
Each is weighed by how much likelier the mixture made it. Positions are drawn as the study draws them; where some of
them fail much more easily, more of these are drawn, and weighed as well.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.special import gammaincc, gammainccinv, logsumexp, ndtr, ndtri

from tol3d.analyses.design_points import DesignPoint, design_points, kept, points_from, probed
from tol3d.analyses.estimate import Estimate, counted, effective, weighted_interval
from tol3d.analyses.limit_state import LimitState, Positions, taken
from tol3d.analyses.second_order import curvatures
from tol3d.numerics.arrays import Array

PLAIN: Final = 0.05
"""Share of the draws that are not about any design point: no build that fails is left out."""
PLAIN_IF_COMMON: Final = 0.5
AROUND: Final = 0.1
"""Share of the draws at random beyond the distance of the nearest design point: it bounds all weights there."""
COMMON: Final = 1e-3
"""Probability from which on half of the draws are plain, and that from which on all are."""
FREQUENT: Final = 0.05
LEAST_DRAWS: Final = 40
"""At a position."""
FLAT: Final = 0.25
"""Share of the draws that positions get alike; the others by how likely they fail."""
SEEN: Final = 40
"""Other positions at which the design points are looked at."""
NEARER: Final = 0.5
"""By how much nearer to failing a position may be than those that were searched."""
SCREENED: Final = 1024
CHOSEN: Final = 64
"""Positions chosen among those that were screened."""
DEFENCE: Final = 0.15
"""Share of them that is chosen alike."""
REFINEMENTS: Final = 3
POOR: Final = 0.08
"""Effective draws, as a share of all, under which draws follow the limit's curvatures."""
WIDEST: Final = 6.0
"""Variance along directions in which the limit bends towards the origin."""
LEAST_CURVED: Final = 0.02
"""Excess of a variance over 1 that is followed."""
APART: Final = 0.02
"""Share of the failures that plain draws may find apart from the design points."""
MOST_APART: Final = 4
FEW: Final = 30.0
"""Effective draws, under which it is told."""
FEW_PLACES: Final = 6.0
HEAVY: Final = 0.2
"""Share of one draw in all of them, from which on it is told."""


@dataclass(frozen=True, eq=False)
class Places:
    """Positions at which a limit is looked at, and design points there.

    Args:
        positions: one row each.
        points: of each.
        weights: how much each stands for, 1 where they were drawn as the study draws them.
        shapes: by how the limit curves at each of the points, if that is followed.
    """

    positions: Positions
    points: Sequence[Sequence[DesignPoint]]
    weights: Array
    shapes: "Sequence[Sequence[Shape]] | None" = None

    @property
    def count(self) -> int:
        """How many."""
        return len(self.points)

    @property
    def beyond(self) -> NDArray[np.bool_]:
        """Where the build at the origin fails."""
        return np.array([any(own.beyond for own in each) for each in self.points], dtype=bool)

    @property
    def rare(self) -> Array:
        """By first order, how often builds fail, or do not where the one at the origin fails; see `first_order`."""
        return np.array([sum(float(ndtr(-own.distance)) for own in each) for each in self.points])

    @property
    def first_order(self) -> float | None:
        """Φ(-β) of the nearest design points, the mean over positions; None without any."""
        if not any(self.points):
            return None
        each = [float(ndtr(-own[0].beta)) if own else 0.0 for own in self.points]
        return float(np.mean(self.weights * each))


def searched(state: LimitState, places: int, starts: int, alone: int, generator: np.random.Generator) -> Places:
    """Design points at several positions, or at the only one there is; see `rare_event`."""
    moving = bool(state.response.simulation.system.streams)
    count = places if moving else 1
    starts = starts if moving else max(starts, alone)
    seed = int(generator.integers(2**31))
    positions = state.response.positions(count, "drawn" if moving else "rest", seed)
    points = design_points(state, positions, count, starts, generator)
    ends, where = probed(state, positions, points, generator)
    found = _more(state, Places(positions, points, np.ones(count)), ends, where)
    return _screened(state, found, generator) if moving else found


def _more(state: LimitState, places: Places, ends: Array, where: NDArray[np.int64]) -> Places:
    """Places with the design points to which builds lead that failed at some of them; they are tried at all."""
    if not len(ends):
        return places
    points = [list(own) for own in places.points]
    beyond = places.beyond
    for place in range(places.count):
        rows = np.full(len(ends), place)
        at = taken(places.positions, rows)
        points[place] = kept([*points[place], *points_from(state, ends, at, beyond[rows])])
    return replace(places, points=points, shapes=None)


# shapes ---------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Shape:
    """Normals about a design point as the limit curves there.

    Args:
        centre: of them (dimension,), on the ray of the design point.
        axes: directions (n, dimension), orthonormal and across the ray.
        variances: along these (n,); 1 elsewhere.
    """

    centre: Array
    axes: Array
    variances: Array

    @classmethod
    def plain(cls, point: DesignPoint) -> "Shape":
        """Of no curvatures."""
        return cls(point.normals, np.zeros((0, len(point.normals))), np.zeros(0))

    @classmethod
    def curved(cls, state: LimitState, point: DesignPoint) -> "Shape":
        """That which failures have there to second order: variances 1/(1 + β κ), and their mean of the way."""
        if not point.smooth or not point.gradient.any():
            return cls.plain(point)
        values, axes = curvatures(state, point)
        values = -values if point.beyond else values
        variances = 1.0 / np.clip(1.0 + point.distance * values, 1.0 / WIDEST, 1.0)
        kept = variances - 1.0 > LEAST_CURVED
        along = point.distance + float((values * variances)[kept].sum()) / 2
        along = max(0.3 * point.distance, along)
        return cls(along * point.sensitivities, axes[kept], variances[kept])

    def drawn(self, z: Array) -> Array:
        """Draws of standard normals (n, dimension)."""
        stretched: Array = ((z @ self.axes.T) * (np.sqrt(self.variances) - 1.0)) @ self.axes
        return z + stretched + self.centre

    def log_ratio(self, z: Array) -> Array:
        """Logarithm of their density by that of plain draws (n,)."""
        across = z @ self.axes.T
        curved = 0.5 * (across**2 @ (1.0 - 1.0 / self.variances) - np.log(self.variances).sum())
        return np.asarray(z @ self.centre - 0.5 * float(self.centre @ self.centre) + curved)


def _shaped(state: LimitState, places: Places) -> Places:
    """Places whose draws follow the curvatures."""
    shapes = [
        [Shape.curved(state, own) if k == 0 else Shape.plain(own) for k, own in enumerate(each)]
        for each in places.points
    ]
    return replace(places, shapes=shapes)


# positions that fail more easily --------------------------------------------------------------------


def _centres(places: Places, most: int) -> list[DesignPoint]:
    own = [point for each in places.points for point in each[:1] if not point.beyond and point.gradient.any()]
    return sorted(own, key=lambda point: point.beta)[:most]


def _betas_elsewhere(state: LimitState, centres: Sequence[DesignPoint], positions: Positions, count: int) -> Array:
    """About how far from failing positions are (count,), from what the limit state is there at known design points."""
    builds = np.repeat(np.array([own.normals for own in centres]), count, axis=0)
    at = {name: np.concatenate([own] * len(centres)) for name, own in positions.items()}
    inside = np.nan_to_num(state.at(builds, at)[0].reshape(len(centres), count), nan=0.0)
    slopes = np.array([float(np.linalg.norm(own.gradient)) for own in centres])
    betas = np.array([own.beta for own in centres])
    return np.asarray((betas[:, None] + inside / slopes[:, None]).min(axis=0))


def _screened(state: LimitState, places: Places, generator: np.random.Generator) -> Places:
    """The places, or others chosen among many where some fail much more easily."""
    centres = _centres(places, places.count)
    if not centres:
        return places
    first = state.response.positions(SEEN, "drawn", int(generator.integers(2**31)))
    seen = _betas_elsewhere(state, centres, first, SEEN)
    rare = places.rare
    uneven = effective(rare) < places.count / 2
    if seen.min() > min(own.beta for own in centres) - NEARER and not uneven:
        return places
    many = state.response.positions(SCREENED, "drawn", int(generator.integers(2**31)))
    betas = _betas_elsewhere(state, centres[:8], many, SCREENED)
    likely = ndtr(-np.clip(betas, -8.0, 12.0)) ** 0.9
    shares = DEFENCE / SCREENED + (1 - DEFENCE) * likely / likely.sum()
    chosen = generator.choice(SCREENED, size=CHOSEN, p=shares)
    positions = taken(many, chosen)
    points = design_points(state, positions, CHOSEN, 2, generator)
    return Places(positions, points, 1.0 / (SCREENED * shares[chosen]))


# draws ----------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Drawn:
    """Draws of all places.

    Args:
        places: of each (n,).
        weights: of each that counts, 0 of the others (n,).
        unseated: which do not seat (n,).
        apart: which counts, and is far from every design point (n,).
        normals: of each (n, dimension).
        counts: draws of each place.
    """

    places: NDArray[np.int64]
    weights: Array
    unseated: NDArray[np.bool_]
    apart: NDArray[np.bool_]
    normals: Array
    counts: NDArray[np.int64]


def importance_sampled(
    state: LimitState, places: Places, draws: int, generator: np.random.Generator
) -> tuple[Estimate, Places]:
    """The probability by importance sampling, and the places with the design points that the draws found besides.

    Args:
        state: whose.
        places: positions and design points.
        draws: how many in all.
        generator: of the draws.
    """
    first = places.first_order
    if first is None or FREQUENT < first < 1 - FREQUENT:
        return _plain(state, places, draws, generator, no_point=first is None), places
    notes: list[str] = []
    spent = 0
    for _ in range(REFINEMENTS + 1):
        found = _sampled(state, places, draws, generator)
        spent += len(found.weights)
        apart = found.apart & ~places.beyond[found.places]
        total = float(_by_place(found, places, found.weights).mean())
        far = float(_by_place(found, places, np.where(apart, found.weights, 0.0)).mean())
        rows = np.flatnonzero(apart)
        if far > APART * total:
            rows = rows[np.argsort(np.linalg.norm(found.normals[rows], axis=1))][:MOST_APART]
            more = _more(state, places, found.normals[rows], found.places[rows])
            if sum(map(len, more.points)) > sum(map(len, places.points)):
                places = more
                continue
        if effective(found.weights) >= POOR * draws or places.shapes is not None:
            break
        places = _shaped(state, places)
        if not any(len(own.axes) for each in places.shapes or () for own in each):
            break
    if far > APART * total and effective(found.weights[apart]) < FEW:
        notes.append(
            f"{100 * far / total:.0f} % of the failures lie apart from the design points, found by few draws: others "
            "of the kind may be missing"
        )
    return _estimate(state, found, places, spent, notes), places


def _plain(
    state: LimitState, places: Places, draws: int, generator: np.random.Generator, *, no_point: bool
) -> Estimate:
    """By plain draws, where failures are frequent, or nothing is known of them."""
    moving = bool(state.response.simulation.system.streams)
    positions = state.response.positions(draws, "drawn" if moving else "rest", int(generator.integers(2**31)))
    fails, unseated = state.failing(generator.standard_normal((draws, state.dimension)), positions)
    words = "no design point was found within 9 standard deviations; the bound is that of plain draws"
    return counted(fails, unseated, (words,) if no_point else ())


def _sampled(state: LimitState, places: Places, draws: int, generator: np.random.Generator) -> Drawn:
    """Draws at all places, more of them where failures are likelier, in one batch."""
    likely = places.weights * np.minimum(places.rare, 0.5)
    shares = FLAT / places.count + (1 - FLAT) * likely / (likely.sum() or 1.0)
    counts = np.maximum(LEAST_DRAWS, np.floor(draws * shares)).astype(np.int64)
    shapes: Sequence[Sequence[Shape] | None] = places.shapes or [None] * places.count
    mixtures = [_Mixture.about(own, state, each) for own, each in zip(places.points, shapes, strict=True)]
    rows = np.repeat(np.arange(places.count), counts)
    normals = np.concatenate([own.drawn(int(n), generator) for own, n in zip(mixtures, counts, strict=True)])
    fails, unseated = state.failing(normals, taken(places.positions, rows))
    counts_as = fails != places.beyond[rows]
    weights, apart = np.zeros(len(rows)), np.zeros(len(rows), dtype=bool)
    for place, own in enumerate(mixtures):
        mine = np.flatnonzero(counts_as & (rows == place))
        logs, elsewhere = own.log_ratio(normals[mine])
        weights[mine] = np.exp(-logs)
        apart[mine] = elsewhere > logs + math.log(0.5)
    return Drawn(rows, weights, unseated & counts_as, apart, normals, counts)


@dataclass(frozen=True, eq=False)
class _Mixture:
    """What is drawn from at a position.

    Args:
        shapes: of draws about each point.
        normals: unit directions of planes (points, dimension).
        ends: where draws beyond a plane begin (points,).
        plain, around: shares of plain draws, and of those in any direction beyond a radius.
        shares: of each point (points,), half of them about it, half beyond its plane.
        acting: the normals among which that radius is taken.
        radius: it.
    """

    shapes: Sequence[Shape]
    normals: Array
    ends: Array
    plain: float
    around: float
    shares: Array
    acting: NDArray[np.int64]
    radius: float

    @classmethod
    def about(cls, points: Sequence[DesignPoint], state: LimitState, shapes: Sequence[Shape] | None) -> "_Mixture":
        """About design points; plain alone without any."""
        if not points:
            none = np.zeros((0, state.dimension))
            return cls((), none, np.zeros(0), 1.0, 0.0, np.zeros(0), state.acting, 0.0)
        distances = np.array([own.distance for own in points])
        plain = PLAIN_IF_COMMON if ndtr(-distances).sum() > COMMON else PLAIN
        likely = np.exp(-0.5 * (distances**2 - distances[0] ** 2))
        likely = np.maximum(likely / likely.sum(), 0.1 / len(points))
        ends = distances - 1.0 / np.maximum(distances, 1.0)
        return cls(
            shapes or [Shape.plain(own) for own in points],
            np.array([own.sensitivities for own in points]),
            ends,
            plain,
            AROUND,
            (1 - plain - AROUND) * likely / likely.sum(),
            state.acting,
            float(ends[0]),
        )

    @property
    def _shares(self) -> Array:
        return np.concatenate([[self.plain, self.around], self.shares / 2, self.shares / 2])

    @property
    def outer(self) -> float:
        """Share of plain draws beyond the radius."""
        return float(gammaincc(max(len(self.acting), 1) / 2, self.radius**2 / 2))

    def drawn(self, count: int, generator: np.random.Generator) -> Array:
        """So many draws (count, dimension)."""
        z = generator.standard_normal((count, self.normals.shape[1]))
        shares, points = self._shares, len(self.shares)
        of = generator.choice(len(shares), size=count, p=shares / shares.sum()) - 2
        far = np.flatnonzero(of == -1)
        if far.size:
            lengths = np.sqrt(2 * gammainccinv(len(self.acting) / 2, generator.random(far.size) * self.outer))
            own = z[np.ix_(far, self.acting)]
            z[np.ix_(far, self.acting)] = own * (lengths / np.linalg.norm(own, axis=1))[:, None]
        for k, shape in enumerate(self.shapes):
            z[of == k] = shape.drawn(z[of == k])
        past = of >= points
        normals, ends = self.normals[of[past] - points], self.ends[of[past] - points]
        lengths = -ndtri(generator.random(len(ends)) * ndtr(-ends))
        z[past] += (lengths - (z[past] * normals).sum(axis=1))[:, None] * normals
        return z

    def log_ratio(self, z: Array) -> tuple[Array, Array]:
        """Logarithm of its density by that of plain draws (n,), and of the part that is not about design points."""
        # φ(z - c) / φ(z) = exp(z·c - c²/2); beyond a plane 1 / Φ(-end), elsewhere 0
        about = np.array([own.log_ratio(z) for own in self.shapes]).reshape(len(self.shapes), len(z)).T
        far = (z[:, self.acting] ** 2).sum(axis=1) >= self.radius**2
        with np.errstate(divide="ignore"):
            past = np.log(z @ self.normals.T >= self.ends) - np.log(ndtr(-self.ends))
            outer = np.log(far) - math.log(self.outer)
            parts = np.column_stack([np.zeros(len(z)), outer, about, past]) + np.log(self._shares)
        return np.asarray(logsumexp(parts, axis=1)), np.asarray(logsumexp(parts[:, :2], axis=1))


def _by_place(found: Drawn, places: Places, weights: Array) -> Array:
    """Mean of the draws of each place, times what the place stands for."""
    return np.asarray(places.weights * np.bincount(found.places, weights, minlength=places.count) / found.counts)


def _estimate(state: LimitState, found: Drawn, places: Places, spent: int, notes: list[str]) -> Estimate:
    rare = _by_place(found, places, found.weights)
    beyond = places.beyond
    each = np.where(beyond, places.weights - rare, rare)
    own = found.weights * (places.weights / found.counts)[found.places]
    within = own - (rare / found.counts)[found.places]
    variance = float((within * within).sum()) / places.count**2
    freedoms = max(effective(own) - 1.0, 1.0)
    if places.count > 1:
        square = float((each * each / places.weights).mean()) - float(each.mean()) ** 2
        among = square / SCREENED if np.ptp(places.weights) > 0.0 else 0.0
        between = float(each.var(ddof=1)) / places.count + max(among, 0.0)
        freedoms = min(freedoms, places.count - 1.0)
        if between >= variance:
            variance, freedoms = between, min(freedoms, max(effective(rare) - 1.0, 1.0))
    unseen = -math.log(0.025) / max(spent, 1)
    few = effective(own) < FEW
    if few:
        notes.append(f"few draws decide, as many as {effective(own):.0f} equal ones: take more (--draws)")
    elif own.max() > HEAVY * own.sum():
        notes.append(f"one draw makes {100 * own.max() / own.sum():.0f} % of the result: take more (--draws)")
    if places.count > 1 and effective(rare) < FEW_PLACES:
        notes.append(f"few positions decide, as many as {effective(rare):.0f} of {places.count} equal ones")
    probability = float(np.clip(each.mean(), 0.0, 1.0))
    error = math.sqrt(variance)
    interval = weighted_interval(probability, error, freedoms, unseen)
    if few and probability <= 0.5:  # what draws in all directions may have missed
        outer = float(np.mean([_Mixture.about(own, state, None).outer for own in places.points]))
        around = max(AROUND * len(own), 1.0)
        interval = interval[0], min(1.0, max(interval[1], probability - math.log(0.025) * outer / around))
    unseated = own[found.unseated & ~beyond[found.places]].sum() / (own[~beyond[found.places]].sum() or 1.0)
    return Estimate(probability, error, interval, float(unseated), spent, tuple(notes))
