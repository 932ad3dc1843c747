"""Importance sampling about design points: its mean is the probability even for poor ones.

Builds are drawn from a mixture: plain ones, normals about each design point, and normals beyond the plane through it.
Each has the ratio of the plain density to that of the mixture as its weight. Positions are drawn as the study draws
them; if some of them fail much more easily, more of these are drawn, and weighted as well.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.analyses.design_points import FURTHEST
from tol3d.analyses.limit_state import (
    MOST_UNSEEN,
    Estimate,
    LimitState,
    counted,
    effective,
    taken,
    weighted_interval,
)
from tol3d.analyses.mixture import AROUND, Mixture, Shape
from tol3d.analyses.places import SCREENED, Places, shaped, with_more
from tol3d.numerics.arrays import Array

FREQUENT: Final = 0.05
"""Probability from which on all draws are plain."""
LEAST_DRAWS: Final = 40
"""Draws at each position."""
FLAT: Final = 0.25
"""Share of the draws divided evenly among positions; the others go by their likelihood of failure."""
REFINEMENTS: Final = 3
"""Most searches for further design points, from failures far from the known ones."""
POOR, POOR_AMONG_PLACES = 0.3, 0.08
"""Effective draws, as a fraction, below which draws follow the limit's curvatures: at one position, at several."""
MORE, MORE_MINUTES = 4, 0.2
"""Factor on the draws if too few are effective after all, and the most processor minutes for them."""
APART: Final = 0.02
"""Fraction of the failures that may lie apart from the design points."""
MOST_APART: Final = 4
"""Failures apart from the design points from which further ones are searched, the nearest."""
FEW: Final = 30.0
"""Effective draws below which a warning is given."""
FEW_PLACES: Final = 6.0
"""The same of positions."""
HEAVY: Final = 0.2
"""Share of a single draw in the result above which a warning is given."""


# draws ----------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Drawn:
    """Draws at all places. Those count that fail, or that do not fail where the build at the origin does.

    Args:
        places: place of each draw (n,).
        weights: of those that count, 0 of the others (n,).
        unseated: True for those that count and cannot be assembled (n,).
        apart: True for those that count and are far from every design point (n,).
        normals: (n, dimension).
        counts: number of draws at each place (places,).
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
        state: the limit state.
        places: positions and design points.
        draws: number of draws; more if they turn out too few.
        generator: source of the draws.
    """
    first = places.first_order
    if first is None or FREQUENT < first < 1 - FREQUENT:
        return _plain(state, places, draws, generator, no_point=first is None), places
    notes: list[str] = []
    spent, poor = 0, (POOR if places.count == 1 else POOR_AMONG_PLACES) * draws
    for k in range(REFINEMENTS + 2):  # the last one may follow the curvatures at all points that were found
        drawn = _sampled(state, places, draws, generator)
        spent += len(drawn.weights)
        apart = drawn.apart & ~places.beyond[drawn.places]
        total = float(_by_place(drawn, places, drawn.weights).mean())
        far = float(_by_place(drawn, places, np.where(apart, drawn.weights, 0.0)).mean())
        rows = np.flatnonzero(apart)
        if far > APART * total and k < REFINEMENTS:
            rows = rows[np.argsort(np.linalg.norm(drawn.normals[rows], axis=1))][:MOST_APART]
            more = with_more(state, places, drawn.normals[rows], drawn.places[rows])
            if sum(map(len, more.points)) > sum(map(len, places.points)):
                places = more
                continue
        if effective(drawn.weights) >= poor or places.shapes is not None:
            break
        places = shaped(state, places)
        if not any(len(shape.axes) for shapes in places.shapes or () for shape in shapes):
            break
    if places.count == 1 and effective(drawn.weights) < poor and MORE * draws * state.response.minutes < MORE_MINUTES:
        drawn = _sampled(state, places, MORE * draws, generator)
        spent += len(drawn.weights)
    elif far > APART * total and effective(drawn.weights[apart]) < FEW:
        notes.append(
            f"{100 * far / total:.0f} % of the failures lie apart from the design points, found by few draws: others "
            "of the kind may be missing"
        )
    return _estimate(state, drawn, places, spent, notes), places


def _plain(
    state: LimitState, places: Places, draws: int, generator: np.random.Generator, *, no_point: bool
) -> Estimate:
    """Estimate by plain draws, if failures are frequent or no design point is known."""
    moving = bool(state.response.simulation.system.streams)
    positions = state.response.positions(draws, "drawn" if moving else "rest", int(generator.integers(2**31)))
    fails, unseated = state.failing(generator.standard_normal((draws, state.dimension)), positions)
    words = f"no design point was found within {FURTHEST:g} standard deviations; the bound is that of plain draws"
    return counted(fails, unseated, (words,) if no_point else ())


def _sampled(state: LimitState, places: Places, draws: int, generator: np.random.Generator) -> Drawn:
    """Draws at all places in one batch, more of them where failures are more likely."""
    likely = places.weights * np.minimum(places.rare, 0.5)
    shares = FLAT / places.count + (1 - FLAT) * likely / (likely.sum() or 1.0)
    counts = np.maximum(LEAST_DRAWS, np.floor(draws * shares)).astype(np.int64)
    shapes: Sequence[Sequence[Shape] | None] = places.shapes or [None] * places.count
    mixtures = [Mixture.about(points, state, each) for points, each in zip(places.points, shapes, strict=True)]
    rows = np.repeat(np.arange(places.count), counts)
    normals = np.concatenate([mixture.drawn(int(n), generator) for mixture, n in zip(mixtures, counts, strict=True)])
    fails, unseated = state.failing(normals, taken(places.positions, rows))
    counts_as = fails != places.beyond[rows]
    weights, apart = np.zeros(len(rows)), np.zeros(len(rows), dtype=bool)
    for place, mixture in enumerate(mixtures):
        counted_rows = np.flatnonzero(counts_as & (rows == place))
        logs, elsewhere = mixture.log_ratio(normals[counted_rows])
        weights[counted_rows] = np.exp(-logs)
        apart[counted_rows] = elsewhere > logs + math.log(0.5)  # drawn more likely by the other components
    return Drawn(rows, weights, unseated & counts_as, apart, normals, counts)


def _by_place(drawn: Drawn, places: Places, weights: Array) -> Array:
    """Mean weight of the draws at each place, times the place's weight (places,)."""
    return np.asarray(places.weights * np.bincount(drawn.places, weights, minlength=places.count) / drawn.counts)


def _estimate(state: LimitState, drawn: Drawn, places: Places, spent: int, notes: list[str]) -> Estimate:
    """Mean over places with its error, from the draws within places and between them."""
    rare = _by_place(drawn, places, drawn.weights)
    beyond = places.beyond
    each = np.where(beyond, places.weights - rare, rare)
    per_draw = drawn.weights * (places.weights / drawn.counts)[drawn.places]
    within = per_draw - (rare / drawn.counts)[drawn.places]
    variance = float((within * within).sum()) / places.count**2
    freedoms = max(effective(per_draw) - 1.0, 1.0)
    if places.count > 1:
        square = float((each * each / places.weights).mean()) - float(each.mean()) ** 2
        among = square / SCREENED if np.ptp(places.weights) > 0.0 else 0.0
        between = float(each.var(ddof=1)) / places.count + max(among, 0.0)
        freedoms = min(freedoms, places.count - 1.0)
        if between >= variance:
            variance, freedoms = between, min(freedoms, max(effective(rare) - 1.0, 1.0))
    few = effective(per_draw) < FEW
    if few:
        notes.append(f"few draws decide, as many as {effective(per_draw):.0f} equal ones: take more (--draws)")
    elif per_draw.max() > HEAVY * per_draw.sum():
        notes.append(f"one draw makes {100 * per_draw.max() / per_draw.sum():.0f} % of the result: take more (--draws)")
    if places.count > 1 and effective(rare) < FEW_PLACES:
        notes.append(f"few positions decide, as many as {effective(rare):.0f} of {places.count} equal ones")
    probability = float(np.clip(each.mean(), 0.0, 1.0))
    error = math.sqrt(variance)
    interval = weighted_interval(probability, error, freedoms, MOST_UNSEEN / max(spent, 1))
    if few and probability <= 0.5:  # failures may be missed by the draws in any direction
        outer = float(np.mean([Mixture.about(points, state, None).outer for points in places.points]))
        around = max(AROUND * len(per_draw), 1.0)
        interval = interval[0], min(1.0, max(interval[1], probability + MOST_UNSEEN * outer / around))
    beyond_there = beyond[drawn.places]
    unseated = per_draw[drawn.unseated & ~beyond_there].sum() / (per_draw[~beyond_there].sum() or 1.0)
    return Estimate(probability, error, interval, float(unseated), spent, tuple(notes))
