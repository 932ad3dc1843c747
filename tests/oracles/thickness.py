"""Tooth thickness deviations of a build as arcs, which it keeps as turns of the flanks."""

import numpy as np

from tol3d.gearing.builds.build import Build
from tol3d.gearing.model import Model
from tol3d.gears import SpurGear


def thickness_of(model: Model, made: Build) -> np.ndarray:
    """Arcs at the reference circles of spur gears [mm], (trials, gears): half an arc turns its flank by arc/(2 r)."""
    gears = [part.gear for part in model.gears if isinstance(part.gear, SpurGear)]
    return made.flank_turn * np.array([2 * gear.reference_radius for gear in gears])
