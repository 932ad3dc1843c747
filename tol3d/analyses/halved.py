"""Deviations of builds as if one tolerance were half as wide: halved about their mean, also where others read it."""

import numpy as np

from tol3d.analyses.response import Response
from tol3d.numerics.arrays import Array

HALF = 0.5


def halved_deviations(response: Response, name: str, deviations: Array) -> Array:
    """Deviations (n, components) with those of a contributor halved about their mean.

    Of draws that follow others only the deviations themselves are halved: a zone that a size widens keeps its width.

    Args:
        response: whose draws.
        name: of the contributor.
        deviations: as they were drawn (n, components) [mm, rad, K].
    """
    found = np.array(deviations)
    own = response.slices[name]
    mean = np.asarray(response.draws[name].mean(turning=False))
    found[:, own] = mean + HALF * (deviations[:, own] - mean)
    return found
