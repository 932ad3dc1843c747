"""Points, turns and poses in the plane."""

import math

import numpy as np

from tol3d.numerics.arrays import Array, Complex


def as_complex(points: Array) -> Complex:
    """Points or displacements (..., 2) as complex numbers."""
    return np.asarray(points[..., 0] + 1j * points[..., 1])


def as_points(values: Complex) -> Array:
    """Complex numbers as points (..., 2)."""
    return np.stack([values.real, values.imag], axis=-1)


def evenly(count: int) -> Array:
    """Azimuths spaced evenly around from 0 on (count,) [rad]."""
    return 2 * np.pi * np.arange(count) / count


def turned(vectors: Array, turns: Array) -> Array:
    """Vectors (trials, ..., 2) turned by angles (trials, ...)."""
    angles = 2 * np.pi * (turns - np.round(turns))
    cos, sin = np.cos(angles), np.sin(angles)
    x, y = vectors[..., 0], vectors[..., 1]
    return np.stack([cos * x - sin * y, sin * x + cos * y], axis=-1)


def upright_pose(angle: float, at: Array | tuple[float, float] = (0.0, 0.0), level: float = 0.0) -> Array:
    """Pose (4, 4) of a body whose z is the world's, turned about it [rad], with its origin at x, y and a level."""
    pose = np.eye(4)
    cos, sin = math.cos(angle), math.sin(angle)
    pose[:2, :2] = [[cos, -sin], [sin, cos]]
    pose[:2, 3], pose[2, 3] = at, level
    return pose
