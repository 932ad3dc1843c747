"""High-low-mean shares: one contributor at its ends, the others at their means, as 3DCS ranks contributors.

They stand beside shares of the variance because published tables mix the two senses. A length in a random
direction acts along the direction in which it changes the measure most.
"""

import math
from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from tol3d.system.measure import Measure
from tol3d.system.stated import component_slices, mean_deviations
from tol3d.system.system import System

Array = NDArray[np.float64]
Values = Callable[[Array], Array]


def high_low_mean_percents(system: System, measure: Measure, values: Values) -> Mapping[str, float | None]:
    """Share [%] of each contributor: the square of its range (largest less smallest of three states) in their sum.

    Args:
        system, measure: what is built, and what is read of it.
        values: the measure (rows,) of deviations (rows, components); nan where a build does not seat.

    Returns:
        percents by the contributor's name; None where a build does not seat, 0 where nothing moves the measure.
    """
    mean = mean_deviations(system, measure.positions)
    middle = values(mean)[0]
    named = [contributor.name for contributor in system.contributors]
    if math.isnan(middle):
        return dict.fromkeys(named, None)
    ranges = {}
    for contributor, columns in zip(system.contributors, component_slices(system).values(), strict=True):

        def states(ends: Array, columns: slice = columns) -> Array:
            rows = np.repeat(mean, len(ends), axis=0)
            rows[:, columns] = ends
            return values(rows)

        turning = system.turns_at_random(contributor, measure.positions)
        ends = contributor.draw.ends(states, turning=turning)
        if not np.isfinite(ends).all():  # which way it acts is not known where a build beside the mean does not seat
            return dict.fromkeys(named, None)
        found = [middle, *states(ends)]
        ranges[contributor.name] = float(np.max(found) - np.min(found))
    total = sum(own**2 for own in ranges.values())
    if math.isnan(total):
        return dict.fromkeys(ranges, None)
    return {name: 100 * own**2 / total if total > 0.0 else 0.0 for name, own in ranges.items()}
