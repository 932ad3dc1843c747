"""Tooth thickness deviations of a build as arcs, which it keeps as turns of the flanks."""

import numpy as np

from tol3d.gearing.build import Build
from tol3d.gearing.model import Model


def thickness_of(model: Model, made: Build) -> np.ndarray:
    """Arcs at the reference circles of spur gears [mm], (trials, gears): half an arc turns its flank by arc/(2 r)."""
    return made.flank_turn * np.array([2 * part.gear.reference_radius for part in model.gears])
