"""Sigma by rates: slopes of measures at the mean build and the spreads of the draws, averaged over positions."""

from typing import Final

import numpy as np

from tol3d.analyses.response import Response
from tol3d.numerics.arrays import Array
from tol3d.system.draw import Draw, JointDraw, component_sigmas

PLACES: Final = 16
"""Positions at which slopes are taken."""
MANY_PLACES: Final = 256
"""Positions at which the mean build is read."""


def covariance_of(draw: Draw) -> Array:
    """Of the components of a draw (components, components) [mm², rad² or K²]."""
    if isinstance(draw, JointDraw):
        return draw.covariance
    if draw.uniforms == 1 and len(draw.components) > 1:  # a length in one direction
        ends = draw.ends(lambda own: own[:, 0], turning=False)
        along = ends[1] - ends[0]
        along = along / (float(np.linalg.norm(along)) or 1.0)
        return np.asarray(draw.sigma**2 * np.outer(along, along))
    return np.diag(np.square(component_sigmas(draw)))


class Rates:
    """Slopes of the measures of a response, for any tolerances of the same system.

    Args:
        response: at whose mean build they are taken.
    """

    def __init__(self, response: Response) -> None:
        count, how = (PLACES, "drawn") if response.simulation.system.streams else (1, "rest")
        mean = response.mean
        positions = response.positions(count, "drawn" if how == "drawn" else "rest")
        self.slopes = response.gradient(np.tile(mean, (count, 1)), positions)
        many = MANY_PLACES if how == "drawn" else 1
        read = response.values(np.tile(mean, (many, 1)), response.positions(many, "drawn" if how == "drawn" else "rest"))
        self.of_positions = np.asarray(np.nanvar(read.values, axis=0)) if many > 1 else np.zeros(read.values.shape[1])

    def variances(self, response: Response) -> dict[str, Array]:
        """Parts of the variance (measures,) by contributor, in the squares of the measures' units."""
        found = {}
        for name, own in response.slices.items():
            slopes = self.slopes[:, :, own]
            found[name] = np.einsum("pmi,ij,pmj->m", slopes, covariance_of(response.draws[name]), slopes) / len(slopes)
        return found

    def sigmas(self, response: Response) -> Array:
        """Of the measures, positions included (measures,)."""
        return np.sqrt(sum(self.variances(response).values(), self.of_positions))
