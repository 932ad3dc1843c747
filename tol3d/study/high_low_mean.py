"""High-low-mean shares: one contributor at its ends, the others at their means, as 3DCS ranks contributors.

They stand beside shares of the variance because published tables mix the two senses. A length in a random
direction acts along the direction in which it changes the measure most.
"""

import math
from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.model import Contributor, Measure, Model, Planar
from tol3d.study import draws

Array = NDArray[np.float64]
Values = Callable[[Array], Array]


def high_low_mean_percents(model: Model, measure: Measure, values: Values) -> Mapping[str, float | None]:
    """Share [%] of each contributor: the square of its range (largest less smallest of three states) in their sum.

    Args:
        model, measure: what is built, and what is read of it.
        values: the measure (rows,) of deviations (rows, components); nan where a build does not seat.

    Returns:
        percents by the contributor's name; None where a build does not seat, 0 where nothing moves the measure.
    """
    mean = draws.mean_deviations(model, measure.positions)
    middle = values(mean)[0]
    ranges = {}
    for contributor in model.contributors:
        columns = model.component_slices[contributor.name]

        def states(ends: Array, columns: slice = columns) -> Array:
            rows = np.repeat(mean, len(ends), axis=0)
            rows[:, columns] = ends
            return values(rows)

        found = [middle, *states(_ends(contributor, measure, states))]
        ranges[contributor.name] = float(np.max(found) - np.min(found))
    total = sum(own**2 for own in ranges.values())
    if math.isnan(total):
        return dict.fromkeys(ranges, None)
    return {name: 100 * own**2 / total if total > 0.0 else 0.0 for name, own in ranges.items()}


def _ends(contributor: Contributor, measure: Measure, states: Values) -> Array:
    """Both ends of a contributor, (2, components)."""
    law, draw = contributor.distribution, contributor.draw
    if not isinstance(draw, Planar):
        return np.array([[law.low], [law.high]])
    turns_at_random = contributor.effect.turns_with is not None and measure.positions.over == "random"
    if draw.direction is not None and not turns_at_random:
        return np.outer([law.low, law.high], [math.cos(draw.direction), math.sin(draw.direction)])
    east, west, north, south = states(law.radius * np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]]))
    steepest = math.atan2(north - south, east - west)
    along = law.radius * np.array([math.cos(steepest), math.sin(steepest)])
    return np.stack([along, -along])
