"""Causes of failures: the share of each contributor in a measure's ppm.

Where failures are frequent among the builds of a simulation these are Sobol' indices of failing itself, a number that
is 1 where a build is beyond a limit or fails, and 0 elsewhere. If failures are rare a simulation does not find
them: then the shares are the squared direction cosines of the design points, the most likely builds that fail, averaged
over positions and limits by how likely each of them is. To first order these are the shares in the reliability index.
Where contributors are correlated both are Shapley effects: of failing, or of the limit made linear at the design point.

Sources: Perrin and Defaux, Efficient evaluation of reliability-oriented sensitivity indices, J. Sci. Comput. 79
(2019); Madsen, Krenk, Lind, Methods of Structural Safety (1986), on direction cosines.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final, Literal

import numpy as np
from scipy.linalg import solve_triangular
from scipy.special import ndtr

from tol3d.analyses.design_points import DesignPoint, design_points
from tol3d.analyses.limit_state import LimitState, Side
from tol3d.analyses.pick_freeze import PickFreeze
from tol3d.analyses.response import Response
from tol3d.analyses.shapley import ShapleyEffects
from tol3d.numerics.arrays import Array
from tol3d.statistics.estimates.shapley import linear_shapley

BlameBy = Literal["simulation", "design points"]
Valued = tuple[float, float]
"""A share, and its standard error."""

FREQUENT: Final = 1000
FREQUENT_SHARE: Final = 1 / 8
"""Failing builds of all pairs from which a simulation is used; of few builds such a fraction."""
PLACES: Final = 8
FEWEST_PLACES: Final = 2
MOST_MINUTES: Final = 0.02
"""Processor minutes for one step towards the design points at all positions."""
LEAST_MINUTES: Final = 1e-9
STARTS, STARTS_ALONE = 1, 8


@dataclass(frozen=True)
class Blame:
    """Shares in the failures of a measure.

    Args:
        by: their method; None if there are no failures.
        words: reason, or parts left out.
        first: by contributor, alone.
        total: likewise, with what it does together with others; of a simulation.
    """

    by: BlameBy | None
    words: str
    first: Mapping[str, Valued] = field(default_factory=dict)
    total: Mapping[str, Valued] = field(default_factory=dict)


def blame_of(response: Response, sampled: PickFreeze, shapley: ShapleyEffects | None, k: int, seed: int) -> Blame:
    """The causes of a measure's failures.

    Args:
        response: of that measure alone.
        sampled: result of pairs of builds.
        shapley: likewise, where it was asked for.
        k: of the measure there.
        seed: of starts towards design points.
    """
    failing, count = int(sampled.failing[:, k].sum()), len(sampled.failing)
    measure = response.measures[0]
    enough = min(FREQUENT, FREQUENT_SHARE * count)
    if enough <= failing <= count - enough:
        if shapley is not None:
            words = "Shapley effects on failing"
            pairs = zip(shapley.failures[:, k].tolist(), shapley.failure_errors[:, k].tolist(), strict=True)
            return Blame("simulation", words, dict(zip(shapley.names, pairs, strict=True)))
        found = sampled.failures
        first, total = (
            {
                name: (float(shares[i, k]), float(errors[i, k]))
                for i, own in enumerate(sampled.inputs)
                for name in own.names
                if math.isfinite(shares[i, k])
            }
            for shares, errors in ((found.first, found.first_errors), (found.total, found.total_errors))
        )
        return Blame("simulation", "Sobol' indices of failing", first, total)
    sides: Sequence[tuple[Side, float | None]] = (("low", measure.lower_limit), ("high", measure.upper_limit))
    limits = [(side, limit * measure.per_internal) for side, limit in sides if limit is not None]
    if not limits:
        return Blame(None, "no limits" if failing == 0 else "too few to blame anyone for them")
    if response.rough:
        return Blame(None, f"too few to blame anyone, and no smooth map from normals: {', '.join(response.rough)}")
    points = [point for side, limit in limits for point in _points(LimitState(response, limit, side), seed)]
    if not points:
        return Blame(None, "no design point found")
    likely = ndtr(-np.array([point.beta for point in points]))
    weights = likely / likely.sum() if likely.sum() > 0.0 else np.full(len(points), 1.0 / len(points))
    shares = failure_shares(response, points, weights)
    words = f"{len(points)} design points, the nearest at β = {min(point.beta for point in points):.2f}"
    return Blame("design points", words, {name: (own, math.nan) for name, own in shares.items()})


def _points(state: LimitState, seed: int) -> Sequence[DesignPoint]:
    generator = np.random.default_rng(seed)
    response = state.response
    most = MOST_MINUTES / max(2 * len(state.acting) * response.minutes, LEAST_MINUTES)
    places = min(max(int(most), FEWEST_PLACES), PLACES) if response.simulation.system.streams else 1
    positions = response.positions(places, "drawn" if places > 1 else "rest", int(generator.integers(2**31)))
    starts = STARTS if places > 1 else STARTS_ALONE
    return [own for design_point in design_points(state, positions, places, starts, generator) for own in design_point]


def failure_shares(response: Response, points: Sequence[DesignPoint], weights: Array) -> Mapping[str, float]:
    """Shares of contributors in the way to design points, averaged with weights (points,).

    They are squared direction cosines, but of correlated contributors Shapley effects on the limit made linear there.
    """
    squares = np.array([point.sensitivities**2 for point in points])
    mean = weights @ squares
    found = {name: float(mean[own].sum()) for name, own in response.normals.items()}
    for block in response.copula.blocks:
        places = [response.normals[name].start for name in block.names]
        divided = np.zeros(len(places))
        for weight, own in zip(weights, points, strict=True):
            slopes = solve_triangular(block.factor, own.sensitivities[places], lower=True, trans="T")
            divided += weight * linear_shapley(slopes, block.correlation)
        found |= dict(zip(block.names, divided.tolist(), strict=True))
    return found
