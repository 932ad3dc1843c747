"""Sigma by rates: slopes of measures at the mean build and the spreads of the draws, averaged over positions."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from tol3d.analyses.response import Response
from tol3d.numerics.arrays import Array
from tol3d.study.system.draw import Draw, JointDraw, component_sigmas
from tol3d.study.trials.correlated import value_correlations

PLACES: Final = 16
"""Positions at which slopes are taken."""
MANY_PLACES: Final = 256
"""Positions at which the mean build is read."""
JUMP: Final = 10.0
"""Slope over the mean change within one sigma from which a measure jumps at the mean build."""


def covariance_of(draw: Draw) -> Array:
    """Covariance of the components of a draw (components, components) [mm², rad² or K²]."""
    if isinstance(draw, JointDraw):
        return draw.covariance
    if draw.uniforms == 1 and len(draw.components) > 1:  # a length in one direction
        ends = draw.ends(lambda own: own[:, 0], turning=False)
        along = ends[1] - ends[0]
        along = along / (float(np.linalg.norm(along)) or 1.0)
        return np.asarray(draw.sigma**2 * np.outer(along, along))
    return np.diag(np.square(component_sigmas(draw)))


@dataclass(frozen=True, eq=False)
class Rates:
    """Slopes of the measures of a response, for any tolerances of the same system.

    Args:
        slopes: at the mean build, at some positions (places, measures, components), in measures' units a mm, rad or K;
            NaN where a measure jumps there.
        of_positions: variance of the mean build over positions (measures,).
    """

    slopes: Array
    of_positions: Array

    def variances(self, response: Response) -> dict[str, Array]:
        """Parts of the variance (measures,) by contributor, in the squares of the measures' units."""
        found = {}
        for name, own in response.slices.items():
            slopes = self.slopes[:, :, own]
            found[name] = np.einsum("pmi,ij,pmj->m", slopes, covariance_of(response.draws[name]), slopes) / len(slopes)
        return found

    def sigmas(self, response: Response) -> Array:
        """Sigmas of the measures, positions included (measures,); NaN where a measure jumps at the mean build."""
        return np.asarray(np.sqrt(sum(self.variances(response).values(), self.of_positions) + self._together(response)))

    def _together(self, response: Response) -> Array:
        """Change of the variances by correlated contributors (measures,)."""
        total = np.zeros(self.slopes.shape[1])
        for block in response.copula.blocks:
            sigmas = np.array([response.draws[name].sigma for name in block.names])
            effects = self.slopes[:, :, [response.slices[name].start for name in block.names]] * sigmas
            others = value_correlations(block, response.draws) - np.eye(len(sigmas))
            total += np.einsum("pmi,ij,pmj->m", effects, others, effects) / len(effects)
        return total


def rates_of(response: Response) -> Rates:
    """The rates at the mean build of a response."""
    moves = bool(response.simulation.system.streams)
    mean = response.mean
    read: list[Array] = []
    for count in (PLACES, MANY_PLACES) if moves else (1, 1):
        builds, positions = np.tile(mean, (count, 1)), response.positions(count, "drawn" if moves else "rest")
        read.append(response.values(builds, positions).values if read else response.gradient(builds, positions))
    slopes, values = read
    slopes = _without_jumps(response, slopes)
    return Rates(slopes, np.asarray(np.nanvar(values, axis=0)) if moves else np.zeros(values.shape[1]))


def _without_jumps(response: Response, slopes: Array) -> Array:
    """Slopes with NaN for those by a share of a play that are jumps.

    A part that floats anywhere in the room of a pattern lies elsewhere as soon as the start of its draw changes.
    """
    columns = [
        k
        for contributor in response.contributors
        if contributor.unit == "1"
        for k in _columns(response.slices[contributor.name])
    ]
    if not columns:
        return slopes
    draws = [response.draws[contributor.name] for contributor in response.contributors]
    sigmas = np.concatenate([component_sigmas(draw) for draw in draws])
    shifts = np.zeros((len(columns), response.components))
    shifts[np.arange(len(columns)), columns] = sigmas[columns]
    builds = response.mean + np.concatenate([shifts, -shifts])
    positions = {name: np.repeat(own, len(builds), axis=0) for name, own in response.positions(1, "rest").items()}
    up, down = response.values(builds, positions).values.reshape(2, len(columns), -1)
    jumps = np.abs(slopes[:, :, columns]) * 2 * sigmas[columns] > JUMP * np.abs(up - down).T
    found = slopes.copy()
    found[:, :, columns] = np.where(jumps, np.nan, slopes[:, :, columns])
    return found


def _columns(of: slice) -> range:
    return range(of.start, of.stop)
