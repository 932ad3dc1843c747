"""The analytic method of assemblies: values of measures, and their slopes, from the nominal geometry alone."""

from collections.abc import Sequence
from weakref import WeakKeyDictionary

import numpy as np

from tol3d.assembly.model import Assembly
from tol3d.assembly.torsors.first_order import FirstOrder, Slopes, displaced, first_order
from tol3d.numerics.arrays import Array

_FOUND: WeakKeyDictionary[Assembly, FirstOrder] = WeakKeyDictionary()
"""Cache for each assembly in this process; another process finds its own, a matter of milliseconds."""


def values(assembly: Assembly, deviations: Array, names: Sequence[str]) -> dict[str, Array]:
    """Values of some measures, to first order [mm or rad].

    Args:
        assembly: the model.
        deviations: (trials, columns) [mm, rad].
        names: of the measures.

    Returns:
        (trials,) by name; a trial's do not depend on the others.

    Raises:
        InputError: as `first_order`.
    """
    return _first_order(assembly).values(deviations, names)


def slopes(assembly: Assembly, name: str, means: Array, sigmas: Array) -> Slopes:
    """Slopes of a measure for each column of the deviations, at their means; see FirstOrder.slopes."""
    return _first_order(assembly).slopes(name, means, sigmas)


def is_bent(assembly: Assembly, name: str) -> bool:
    """True if a measure is not linear in the deviations."""
    return _first_order(assembly).is_bent(name)


def displacements(assembly: Assembly, part: str, after: int, deviations: Array) -> Array:
    """Torsors (trials, 6) of a part, seen at the world's origin [mm, rad].

    Args:
        assembly: the model.
        part: its name.
        after: index of the move after which it is evaluated; -1 for the end.
        deviations: (trials, columns) [mm, rad].
    """
    found = displaced(assembly, part, after)
    return np.stack([*found.values(deviations, list(found.rows)).values()], axis=1)


def _first_order(assembly: Assembly) -> FirstOrder:
    found = _FOUND.get(assembly)
    if found is None:
        found = _FOUND[assembly] = first_order(assembly)
    return found
