"""Rigid poses by scipy: the oracle of moves, which shares nothing with what places parts."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]


def solved_pose(residuals: Callable[[Array, Array], Array], near: Array, length: float = 100.0) -> Array:
    """The pose (4, 4) near a nominal one at which residuals of (rotation matrix, shift) are 0.

    Args:
        residuals: of a rotation (3, 3) and a shift (3,) [mm].
        near: the nominal pose (4, 4).
        length: by which turns are scaled [mm].
    """

    def of(unknowns: Array) -> tuple[Array, Array]:
        turn = Rotation.from_rotvec(unknowns[:3] / length).as_matrix()
        return turn @ near[:3, :3], near[:3, 3] + unknowns[3:]

    found = least_squares(lambda u: residuals(*of(u)), np.zeros(6), xtol=1e-15, ftol=1e-15, gtol=1e-15, x_scale=1.0)
    # least squares stop at the square root of rounding along valleys; Newton's steps with differences end it
    unknowns = found.x
    for _ in range(3):
        jacobian = np.column_stack(
            [(residuals(*of(unknowns + 1e-4 * e)) - residuals(*of(unknowns - 1e-4 * e))) / 2e-4 for e in np.eye(6)]
        )
        unknowns = unknowns - np.linalg.lstsq(jacobian, residuals(*of(unknowns)), rcond=None)[0]
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = of(unknowns)
    return pose
