"""Poses of a gear by scipy's rotations, each step a 4x4 matrix."""

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial.transform import Rotation


def pose(rotation_vector: ArrayLike, translation: ArrayLike) -> np.ndarray:
    """4x4 transform of a rotation vector [rad] and a translation [mm]."""
    matrix = np.eye(4)
    matrix[:3, :3] = Rotation.from_rotvec(rotation_vector).as_matrix()
    matrix[:3, 3] = translation
    return matrix


def world_from_gear(world_from_shaft: np.ndarray, angle: float, centre: np.ndarray) -> np.ndarray:
    """Pose of a gear on a shaft at rest, turned by `angle` [rad]; its centre (x, y) [mm] turns with it."""
    return world_from_shaft @ pose([0.0, 0.0, angle], np.zeros(3)) @ pose(np.zeros(3), [centre[0], centre[1], 0.0])


def world_from_gears(world_from_shaft: np.ndarray, angle: np.ndarray, centre: np.ndarray) -> np.ndarray:
    """The same for rows: (n, 4, 4), (n,), (n, 2) to (n, 4, 4)."""
    return np.stack([world_from_gear(s, a, c) for s, a, c in zip(world_from_shaft, angle, centre, strict=True)])
