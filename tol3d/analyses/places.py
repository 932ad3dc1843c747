"""Positions at which a limit is evaluated, with the design points there.

They are drawn as the study draws them; if some fail much more easily, more of these are chosen, and weighted.
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

TRIED: Final = 40
"""Further positions at which the known design points are evaluated."""
NEARER: Final = 0.5
"""Distance by which a position may be nearer to failing than those that were searched."""
SCREENED: Final = 1024
"""Positions screened, if some of those tried fail much more easily."""
SCREENING_CENTRES: Final = 8
"""Design points by which they are screened."""
LIKELIHOOD_POWER: Final = 0.9
"""Exponent of the likelihood of failures, below 1 because betas of a screening are rough."""
LEAST_BETA, MOST_BETA = -8.0, 12.0
CHOSEN: Final = 64
"""Positions chosen among those screened."""
DEFENCE: Final = 0.15
"""Share of the choice that is uniform."""
CURVED_BUILDS: Final = 4000
"""Most builds for the curvatures at all design points together."""
FEWEST_PLACES, FEWEST_STARTS = 5, 3
MOST_MINUTES: Final = 0.01
"""Processor minutes for one step of a walk from all positions: where builds take long there are fewer."""
LEAST_MINUTES: Final = 1e-9


@dataclass(frozen=True, eq=False)
class Places:
    """Positions at which a limit is evaluated, and design points there.

    Args:
        positions: one row each.
        points: design points of each, the nearest first.
        weights: importance weight of each (positions,); 1 if they were drawn as the study draws them.
        out: True where the build at the origin fails (positions,).
        shapes: distributions about each of the points that follow the curvature of the limit; None if not followed.
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
        """True where the build at the origin fails (positions,); draws are then made about builds that do not fail."""
        return np.array([any(point.beyond for point in points) for points in self.points], dtype=bool)

    @property
    def rare(self) -> Array:
        """Fraction of builds that fail, or that do not where the one at the origin fails (positions,).

        By first order: the sum of Φ(-distance) of the design points.
        """
        return np.array([sum(float(ndtr(-point.distance)) for point in points) for points in self.points])

    @property
    def first_order(self) -> float | None:
        """Φ(-β) of the nearest design points, the weighted mean over positions; None without any."""
        if not any(self.points):
            return None
        each = [
            float(ndtr(-points[0].beta)) if points else float(out)
            for points, out in zip(self.points, self.out, strict=True)
        ]
        return float(np.mean(self.weights * each))


def searched(state: LimitState, places: int, starts: int, alone: int, generator: np.random.Generator) -> Places:
    """Design points at several positions, or at the only one there is.

    Args:
        state: the limit state.
        places: most positions.
        starts: of walks at each position.
        alone: most starts where there is one position alone.
        generator: source of all draws.
    """
    moving = state.reads_positions
    count = affordable(state, places, FEWEST_PLACES) if moving else 1
    starts = starts if moving else max(starts, affordable(state, alone, FEWEST_STARTS))
    seed = int(generator.integers(2**31))
    positions = state.response.positions(count, "drawn" if moving else "rest", seed)
    points = design_points(state, positions, count, starts, generator)
    ends, where = probed(state, positions, points, generator)
    first = Places(positions, points, np.ones(count), _out(state, positions, count))
    places_found = with_more(state, first, ends, where)
    return _screened(state, places_found, generator) if moving else places_found


def affordable(state: LimitState, most: int, fewest: int) -> int:
    """Number of walks: `most`, or fewer, down to `fewest`, if their gradients take long."""
    step = 2 * len(state.acting) * state.response.minutes
    return min(most, max(fewest, int(MOST_MINUTES / max(step, LEAST_MINUTES))))


def with_more(state: LimitState, places: Places, ends: Array, where: NDArray[np.int64]) -> Places:
    """Places with further design points, to which failing builds lead.

    Args:
        state: the limit state.
        places: as far as they are known.
        ends: the failing builds (n, dimension); tried at all places, or at their own if builds take long.
        where: place of each (n,).
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
    """Places whose draws follow the curvatures at all design points, or at the nearest of each if these take long."""
    every = sum(map(len, places.points)) * len(state.acting) ** 2 <= CURVED_BUILDS
    shapes = [
        [Shape.curved(state, point) if every or k == 0 else Shape.plain(point) for k, point in enumerate(points)]
        for points in places.points
    ]
    return replace(places, shapes=shapes)


# positions that fail more easily --------------------------------------------------------------------


def _centres(places: Places, most: int) -> list[DesignPoint]:
    """Nearest design points of positions that have gradients, the nearest first."""
    centres = [point for points in places.points for point in points[:1] if not point.beyond and point.gradient.any()]
    return sorted(centres, key=lambda point: point.beta)[:most]


def _betas_elsewhere(state: LimitState, centres: Sequence[DesignPoint], positions: Positions, count: int) -> Array:
    """Estimate of beta at other positions (count,), by the limit state of known design points there."""
    builds = np.repeat(np.array([centre.normals for centre in centres]), count, axis=0)
    at = {name: np.concatenate([column] * len(centres)) for name, column in positions.items()}
    inside = np.nan_to_num(state.at(builds, at)[0].reshape(len(centres), count), nan=0.0)
    slopes = np.array([float(np.linalg.norm(centre.gradient)) for centre in centres])
    betas = np.array([centre.beta for centre in centres])
    return np.asarray((betas[:, None] + inside / slopes[:, None]).min(axis=0))


def _screened(state: LimitState, places: Places, generator: np.random.Generator) -> Places:
    """The places, or others chosen among many if some fail much more easily."""
    centres = _centres(places, places.count)
    if not centres:
        return places
    tried = state.response.positions(TRIED, "drawn", int(generator.integers(2**31)))
    tried_betas = _betas_elsewhere(state, centres, tried, TRIED)
    uneven = effective(places.rare) < places.count / 2
    if tried_betas.min() > min(centre.beta for centre in centres) - NEARER and not uneven:
        return places
    many = state.response.positions(SCREENED, "drawn", int(generator.integers(2**31)))
    betas = _betas_elsewhere(state, centres[:SCREENING_CENTRES], many, SCREENED)
    likely = ndtr(-np.clip(betas, LEAST_BETA, MOST_BETA)) ** LIKELIHOOD_POWER
    shares = DEFENCE / SCREENED + (1 - DEFENCE) * likely / likely.sum()
    count = max(affordable(state, CHOSEN, FEWEST_PLACES), places.count)
    chosen = generator.choice(SCREENED, size=count, p=shares)
    positions = taken(many, chosen)
    points = design_points(state, positions, count, 2, generator)
    return Places(positions, points, 1.0 / (SCREENED * shares[chosen]), _out(state, positions, count))


def _out(state: LimitState, positions: Positions, count: int) -> NDArray[np.bool_]:
    return state.failing(np.full((count, state.dimension), AT_ORIGIN), positions)[0]
