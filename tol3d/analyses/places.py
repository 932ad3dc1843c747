"""Positions at which a limit is looked at, with the design points there.

They are drawn as the study draws them; where some fail much more easily, more of these are chosen, and weighed.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from tol3d.analyses.design_points import AT_ORIGIN, DesignPoint, design_points, kept, points_from, probed
from tol3d.analyses.limit_state import LimitState, Positions, effective, taken
from tol3d.analyses.mixture import Shape
from tol3d.numerics.arrays import Array

SEEN: Final = 40
"""Other positions at which the design points are looked at."""
NEARER: Final = 0.5
"""Distance by which a position may be nearer to failing than those that were searched."""
SCREENED: Final = 1024
CHOSEN: Final = 64
"""Positions chosen among those that were screened."""
DEFENCE: Final = 0.15
"""Share of them that is chosen alike."""
CURVED_BUILDS: Final = 4000
"""Builds for the curvatures at all design points together."""
FEWEST_PLACES, FEWEST_STARTS = 5, 3
MOST_MINUTES: Final = 0.01
"""Processor minutes for one step of a walk from all positions: where builds take long there are fewer."""
LEAST_MINUTES: Final = 1e-9


@dataclass(frozen=True, eq=False)
class Places:
    """Positions at which a limit is looked at, and design points there.

    Args:
        positions: one row each.
        points: of each.
        weights: how much each stands for, 1 where they were drawn as the study draws them.
        out: where the build at the origin fails.
        shapes: by how the limit curves at each of the points, if that is followed.
    """

    positions: Positions
    points: Sequence[Sequence[DesignPoint]]
    weights: Array
    out: NDArray[np.bool_]
    shapes: "Sequence[Sequence[Shape]] | None" = None

    @property
    def count(self) -> int:
        """Number of positions."""
        return len(self.points)

    @property
    def beyond(self) -> NDArray[np.bool_]:
        """True where the build at the origin fails; draws are then made about the builds that do not fail."""
        return np.array([any(own.beyond for own in point) for point in self.points], dtype=bool)

    @property
    def rare(self) -> Array:
        """By first order, how often builds fail, or do not where the one at the origin fails; see `first_order`."""
        return np.array([sum(float(ndtr(-own.distance)) for own in point) for point in self.points])

    @property
    def first_order(self) -> float | None:
        """Φ(-β) of the nearest design points, the mean over positions; None without any."""
        if not any(self.points):
            return None
        each = [
            float(ndtr(-own[0].beta)) if own else float(out) for own, out in zip(self.points, self.out, strict=True)
        ]
        return float(np.mean(self.weights * each))


def searched(state: LimitState, places: int, starts: int, alone: int, generator: np.random.Generator) -> Places:
    """Design points at several positions, or at the only one there is; see `rare_event`."""
    moving = state.reads_positions
    count = affordable(state, places, FEWEST_PLACES) if moving else 1
    starts = starts if moving else max(starts, affordable(state, alone, FEWEST_STARTS))
    seed = int(generator.integers(2**31))
    positions = state.response.positions(count, "drawn" if moving else "rest", seed)
    points = design_points(state, positions, count, starts, generator)
    ends, where = probed(state, positions, points, generator)
    found = with_more(state, Places(positions, points, np.ones(count), _out(state, positions, count)), ends, where)
    return _screened(state, found, generator) if moving else found


def affordable(state: LimitState, most: int, fewest: int) -> int:
    """So many walks, fewer where their gradients take long."""
    step = 2 * len(state.acting) * state.response.minutes
    return min(most, max(fewest, int(MOST_MINUTES / max(step, LEAST_MINUTES))))


def with_more(state: LimitState, places: Places, ends: Array, where: NDArray[np.int64]) -> Places:
    """Places with the design points to which builds lead that failed at some of them.

    They are tried at all places; where builds take long, at their own.
    """
    if not len(ends):
        return places
    points = [list(point) for point in places.points]
    beyond, everywhere = places.beyond, len(ends) * places.count
    anywhere = affordable(state, everywhere, 1) == everywhere
    for place in range(places.count):
        tried = ends if anywhere else ends[where == place]
        rows = np.full(len(tried), place)
        at = taken(places.positions, rows)
        points[place] = kept([*points[place], *points_from(state, tried, at, beyond[rows])])
    return replace(places, points=points, shapes=None)


def shaped(state: LimitState, places: Places) -> Places:
    """Places whose draws follow the curvatures at all design points; where these take long, at the nearest of each."""
    every = sum(map(len, places.points)) * len(state.acting) ** 2 <= CURVED_BUILDS
    shapes = [
        [Shape.curved(state, own) if every or k == 0 else Shape.plain(own) for k, own in enumerate(point)]
        for point in places.points
    ]
    return replace(places, shapes=shapes)


# positions that fail more easily --------------------------------------------------------------------


def _centres(places: Places, most: int) -> list[DesignPoint]:
    own = [point for each in places.points for point in each[:1] if not point.beyond and point.gradient.any()]
    return sorted(own, key=lambda point: point.beta)[:most]


def _betas_elsewhere(state: LimitState, centres: Sequence[DesignPoint], positions: Positions, count: int) -> Array:
    """About how far from failing positions are (count,), from what the limit state is there at known design points."""
    builds = np.repeat(np.array([centre.normals for centre in centres]), count, axis=0)
    at = {name: np.concatenate([own] * len(centres)) for name, own in positions.items()}
    inside = np.nan_to_num(state.at(builds, at)[0].reshape(len(centres), count), nan=0.0)
    slopes = np.array([float(np.linalg.norm(centre.gradient)) for centre in centres])
    betas = np.array([centre.beta for centre in centres])
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
    if seen.min() > min(centre.beta for centre in centres) - NEARER and not uneven:
        return places
    many = state.response.positions(SCREENED, "drawn", int(generator.integers(2**31)))
    betas = _betas_elsewhere(state, centres[:8], many, SCREENED)
    likely = ndtr(-np.clip(betas, -8.0, 12.0)) ** 0.9
    shares = DEFENCE / SCREENED + (1 - DEFENCE) * likely / likely.sum()
    count = max(affordable(state, CHOSEN, FEWEST_PLACES), places.count)
    chosen = generator.choice(SCREENED, size=count, p=shares)
    positions = taken(many, chosen)
    points = design_points(state, positions, count, 2, generator)
    return Places(positions, points, 1.0 / (SCREENED * shares[chosen]), _out(state, positions, count))


def _out(state: LimitState, positions: Positions, count: int) -> NDArray[np.bool_]:
    return state.failing(np.full((count, state.dimension), AT_ORIGIN), positions)[0]
