"""Gears that sit turned on their shafts, the same on both roads: it matters where parallel load paths join."""

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.model import Mesh, Model

Array = NDArray[np.float64]


def clocking(model: Model, mesh: Mesh, deviations: Array) -> Array:
    """Turn of the shaft that a mesh drives, about the driven gear's z, by how its gears sit on their shafts [rad].

    Args:
        model, mesh: the mesh.
        deviations: (trials, components) [mm, rad, K].

    Returns:
        (trials,)
    """
    total = np.zeros(len(deviations))
    for contributor in model.contributors:
        if rate := contributor.effect.clocking(mesh):
            total = total + rate * deviations[:, model.component_slices[contributor.name].start]
    return total
