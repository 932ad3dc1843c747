"""Importance sampling about design points: its mean is the probability even for poor ones.

Builds are drawn from a mixture: plain ones, normals about each design point, and normals beyond the plane through it.
Each is weighed by how much likelier the mixture made it. Positions are drawn as the study draws them; where some of
them fail much more easily, more of these are drawn, and weighed as well.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.analyses.limit_state import Estimate, LimitState, counted, effective, taken, weighted_interval
from tol3d.analyses.mixture import AROUND, Mixture, Shape
from tol3d.analyses.places import SCREENED, Places, shaped, with_more
from tol3d.numerics.arrays import Array

FREQUENT: Final = 0.05
"""Probability from which on all draws are plain."""
LEAST_DRAWS: Final = 40
"""At a position."""
FLAT: Final = 0.25
"""Share of the draws that positions get alike; the others by how likely they fail."""
REFINEMENTS: Final = 3
POOR, POOR_AMONG_PLACES = 0.3, 0.08
"""Effective draws, as a share of all, below which draws follow the limit's curvatures: at one position, at several."""
MORE, MORE_MINUTES = 4, 0.2
"""Times as many draws where so few of them count after all, if they take no longer."""
APART: Final = 0.02
"""Share of the failures that plain draws may find apart from the design points."""
MOST_APART: Final = 4
FEW: Final = 30.0
"""Effective draws, below which a warning is given."""
FEW_PLACES: Final = 6.0
HEAVY: Final = 0.2
"""Share of one draw in all of them, above which a warning is given."""


# draws ----------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Drawn:
    """Draws of all places.

    Args:
        places: of each (n,).
        weights: of each that counts, 0 of the others (n,).
        unseated: which cannot be assembled (n,).
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
        state: the limit state.
        places: positions and design points.
        draws: their number.
        generator: of the draws.
    """
    first = places.first_order
    if first is None or FREQUENT < first < 1 - FREQUENT:
        return _plain(state, places, draws, generator, no_point=first is None), places
    notes: list[str] = []
    spent, poor = 0, (POOR if places.count == 1 else POOR_AMONG_PLACES) * draws
    for k in range(REFINEMENTS + 2):  # the last one may follow the curvatures at all points that were found
        found = _sampled(state, places, draws, generator)
        spent += len(found.weights)
        apart = found.apart & ~places.beyond[found.places]
        total = float(_by_place(found, places, found.weights).mean())
        far = float(_by_place(found, places, np.where(apart, found.weights, 0.0)).mean())
        rows = np.flatnonzero(apart)
        if far > APART * total and k < REFINEMENTS:
            rows = rows[np.argsort(np.linalg.norm(found.normals[rows], axis=1))][:MOST_APART]
            more = with_more(state, places, found.normals[rows], found.places[rows])
            if sum(map(len, more.points)) > sum(map(len, places.points)):
                places = more
                continue
        if effective(found.weights) >= poor or places.shapes is not None:
            break
        places = shaped(state, places)
        if not any(len(own.axes) for each in places.shapes or () for own in each):
            break
    if places.count == 1 and effective(found.weights) < poor and MORE * draws * state.response.minutes < MORE_MINUTES:
        found = _sampled(state, places, MORE * draws, generator)
        spent += len(found.weights)
    elif far > APART * total and effective(found.weights[apart]) < FEW:
        notes.append(
            f"{100 * far / total:.0f} % of the failures lie apart from the design points, found by few draws: others "
            "of the kind may be missing"
        )
    return _estimate(state, found, places, spent, notes), places


def _plain(
    state: LimitState, places: Places, draws: int, generator: np.random.Generator, *, no_point: bool
) -> Estimate:
    """By plain draws, if failures are frequent, or nothing is known of them."""
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
    mixtures = [Mixture.about(own, state, each) for own, each in zip(places.points, shapes, strict=True)]
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


def _by_place(found: Drawn, places: Places, weights: Array) -> Array:
    """Mean of the draws of each place, times its weight."""
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
    if few and probability <= 0.5:  # may be missed by draws in all directions
        outer = float(np.mean([Mixture.about(point, state, None).outer for point in places.points]))
        around = max(AROUND * len(own), 1.0)
        interval = interval[0], min(1.0, max(interval[1], probability - math.log(0.025) * outer / around))
    unseated = own[found.unseated & ~beyond[found.places]].sum() / (own[~beyond[found.places]].sum() or 1.0)
    return Estimate(probability, error, interval, float(unseated), spent, tuple(notes))
