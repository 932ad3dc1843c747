"""Gears that sit turned on their shafts, the same on both roads: it matters where parallel ways meet."""

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.model import Clocking, Mesh, Model
from tol3d.gearing.model.contributor import single_effects

Array = NDArray[np.float64]


def clocking(model: Model, mesh: Mesh, deviations: Array) -> Array:
    """Turn of the shaft that a mesh drives, about the driven gear's z, by how its gears sit on their shafts [rad].

    A driver that sits ahead takes the driven gear with it, a driven gear that sits ahead leaves its shaft behind.

    Args:
        model, mesh: the mesh.
        deviations: (trials, components) [mm, rad, K].

    Returns:
        (trials,)
    """
    total = np.zeros(len(deviations))
    for contributor in model.contributors:
        own = deviations[:, model.component_slices[contributor.name].start]
        for effect in single_effects(contributor.effect):
            total = total + clocking_rate(effect, mesh) * own if isinstance(effect, Clocking) else total
    return total


def clocking_rate(effect: Clocking, mesh: Mesh) -> float:
    """The same per deviation."""
    return float(mesh.rate) * (effect.part == mesh.driver) - (effect.part == mesh.driven)
