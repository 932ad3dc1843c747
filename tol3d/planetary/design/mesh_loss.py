"""Friction in one mesh: how far flanks slide per base pitch, and what a coefficient of friction takes of the power."""

import math
from itertools import pairwise
from typing import Final, Literal

from tol3d.planetary.design.working_mesh import WorkingMesh

Sharing = Literal["formula", "equal shares"]
PAPER_FRICTION: Final = 0.08


def sliding_factor(epsilon_1: float, epsilon_2: float) -> float:
    """E = epsilon_1^2 + epsilon_2^2 - epsilon_1 - epsilon_2 + 1 of the parts of a path of contact.

    Twice the mean distance of contact from the pitch point in base pitches, where pairs in contact share the load
    alike; exact with both parts in 0 to 1 and their sum in 1 to 2, beyond that too large. Source: Wang, Yang, Du, Chen,
    China Mechanical Engineering 2024(1).

    >>> sliding_factor(0.5, 0.5)
    0.5
    """
    return epsilon_1**2 + epsilon_2**2 - epsilon_1 - epsilon_2 + 1


def shared_sliding_factor(epsilon_1: float, epsilon_2: float) -> float:
    """The same for any path of contact of at least one base pitch: pairs in contact carry alike.

    Pairs stand at s + k, k any integer; between the phases at which one enters, leaves or passes the pitch point their
    number is constant and the sum of |s + k| linear, so its mean is that in the middle.

    >>> round(shared_sliding_factor(0.5, 0.7), 12) == round(sliding_factor(0.5, 0.7), 12)
    True
    """
    phases = sorted({0.0, 1.0, epsilon_1 % 1.0, -epsilon_2 % 1.0})
    total = 0.0
    for low, high in pairwise(phases):
        middle = (low + high) / 2
        first = math.ceil(-epsilon_2 - middle)
        places = [middle + k for k in range(first, math.floor(epsilon_1 - middle) + 1)]
        if places:
            total += (high - low) * sum(map(abs, places)) / len(places)
    return 2 * total


def mesh_efficiency(mesh: WorkingMesh, friction: float, sharing: Sharing = "formula") -> float:
    """1 - mu pi (1/z_p + s/z) E.

    Args:
        mesh: at its centre distance.
        friction: mu, the same all along the path.
        sharing: E by the formula, or by equal shares of the pairs in contact.
    """
    factor = sliding_factor if sharing == "formula" else shared_sliding_factor
    slow = 1 / mesh.mesh.planet_teeth + mesh.sign / mesh.mesh.teeth
    return 1 - friction * math.pi * slow * factor(*mesh.contact_ratios)
