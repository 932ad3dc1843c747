"""Whether planets at equal angles clear each other."""

import math


def tip_gap(centre_distance: float, planets: int, largest_tip_radius: float) -> float:
    """Free distance [mm] between the tip circles of neighbouring planets: 2 a sin(pi/n) - d_a; negative: they overlap.

    Args:
        centre_distance: a [mm].
        planets: n; one alone has no neighbour.
        largest_tip_radius: d_a/2 of the planet's larger step [mm].

    >>> round(tip_gap(26.0, 4, 14.5), 4)
    7.7696
    """
    if planets < 2:
        return math.inf
    return 2 * centre_distance * math.sin(math.pi / planets) - 2 * largest_tip_radius
