"""Means and covariances of an assembly's draws, and deviations with the same spread."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from tol3d.assembly.zones import ZoneDraw
from tol3d.numerics.arrays import Array
from tol3d.study.system.contributor import Contributor
from tol3d.study.system.draw import JointDraw

MOTIONS: Final = 384
"""Deviations at which the nearest places of parts are sought; half of them twice as wide as trials."""


def moments_of(contributor: Contributor) -> tuple[Array, Array]:
    """Mean (components,) and covariance (components, components) of a contributor [mm, K]."""
    draw = contributor.draw
    if isinstance(draw, ZoneDraw):
        return draw.mean_vector, draw.covariance
    mean = np.array(draw.mean(turning=False))
    if isinstance(draw, JointDraw):
        return mean, draw.covariance
    return mean, draw.sigma**2 * np.eye(len(mean))


def widely(contributors: Sequence[Contributor]) -> Array:
    """Deviations (trials, columns) like those of trials and twice as wide, the same in every process [mm, K]."""
    rng = np.random.default_rng(0)
    columns = []
    for contributor in contributors:
        mean, covariance = moments_of(contributor)
        sizes, axes = np.linalg.eigh(covariance)
        normal = rng.normal(size=(MOTIONS, len(mean))) * np.sqrt(np.maximum(sizes, 0.0))
        normal[::2] *= 2.0
        columns.append(mean + normal @ axes.T)
    return np.concatenate([np.zeros((MOTIONS, 0)), *columns], axis=1)
