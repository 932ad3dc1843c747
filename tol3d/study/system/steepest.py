"""Ends of a deviation of several components, in the directions in which a measure changes most."""

from collections.abc import Callable
from typing import Final

import numpy as np

from tol3d.numerics.arrays import Array

Values = Callable[[Array], Array]
"""A measure (rows,) of the components (rows, components) of one contributor, all others at their means."""
LEAST_STEP: Final = 1e-9
"""Step of a slope [mm or rad] where a deviation has no width."""
TIE: Final = 1e-6
"""Part by which one change must be larger than another: features alike, and effects to one side, differ by rounding."""
CURVED: Final = 0.1
"""Change that is alike to both sides over the one that is not, from which on other directions are looked at too."""


def steepest_ends(values: Values, mean: Array, steps: Array, furthest: Callable[[Array], Array]) -> Array:
    """Ends along a measure's slopes and against them (2, components); nan where builds beside the mean fail.

    Where it changes alike to both sides, as the size of a vector does, slopes at the mean do not tell all. They are
    taken again beside it, on the side of the component that moves it most, if that tells more; and what lies across
    them moves the measure too: pairs of ends (2 components, components), the steepest first.

    Args:
        values: of the measure.
        mean: deviation at which slopes are taken (components,).
        steps: to both sides of it, of each component (components,).
        furthest: where a function with these slopes (components,) is largest (components,).
    """
    steps = np.maximum(steps, LEAST_STEP)
    both = np.concatenate([np.diag(steps), -np.diag(steps)])
    *found, middle = values(np.concatenate([mean + both, mean[None]]))
    above, below = np.array(found).reshape(2, len(steps))
    slopes, alike = (above - below) / (2.0 * steps), (above + below) / 2.0 - middle
    if not np.isfinite(slopes).all():
        return np.full((2, len(steps)), np.nan)
    odd, even = np.abs(above - below).sum() / 2.0, np.abs(alike).sum()
    if even > (1.0 + TIE) * odd:
        most = _largest(alike)
        place = mean + (
            both[most] if slopes[most] * steps[most] * alike[most] >= -TIE * alike[most] ** 2 else -both[most]
        )
        above, below = values(place + both).reshape(2, len(steps))
        there = np.sign(alike[most]) * (above - below) / (2.0 * steps)
        slopes = there if np.isfinite(there).all() else slopes
    ways = [slopes]
    if even > CURVED * odd:
        others = np.delete(np.diag(steps), _largest(slopes * steps), axis=1)
        across, _ = np.linalg.qr(np.column_stack([slopes * steps, others]))
        ways = [_without_rounding(way, steps) for way in (slopes, *(across.T[1:] / steps))]
    return np.array([furthest(sign * way) for way in ways for sign in (1.0, -1.0)])


def _largest(changes: Array) -> int:
    """The component of the largest change; of those that are as large but for rounding the first."""
    return int(np.argmax(np.abs(changes) >= (1.0 - TIE) * np.abs(changes).max()))


def _without_rounding(way: Array, steps: Array) -> Array:
    """Slopes (components,) of which those that are rounding beside the largest are none."""
    changes = np.abs(way * steps)
    return np.where(changes < TIE * changes.max(), 0.0, way)


def along(radius: float, slopes: Array) -> Array:
    """The point of a ball about 0 where a function with these slopes is largest; on the first axis if it has none."""
    size = float(np.sqrt((slopes * slopes).sum()))
    return radius * (slopes / size if size > 0.0 else np.eye(len(slopes))[0])
