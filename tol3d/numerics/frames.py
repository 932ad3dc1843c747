"""Poses of many trials at once: rotations (..., 3, 3) and 4x4 transforms, by elementwise arithmetic only.

Without BLAS, so that a row has the same bits alone and among thousands.
"""

import numpy as np

from tol3d.numerics.arrays import Array

SMALL_TURN = 1e-8  # rad; below it sin(x)/x and (1 - cos x)/x^2 are 1 and 1/2 to the last bit


def matmul(left: Array, right: Array) -> Array:
    """Matrix product over leading axes, (..., n, 3) @ (..., 3, m) or with 4; the same bits for any batch."""
    inner = left.shape[-1]
    total = left[..., :, 0, None] * right[..., None, 0, :]
    for k in range(1, inner):
        total = total + left[..., :, k, None] * right[..., None, k, :]
    return total


def apply(matrix: Array, vector: Array) -> Array:
    """Matrix (..., 3, 3) times vector (..., 3)."""
    return (
        matrix[..., :, 0] * vector[..., None, 0]
        + matrix[..., :, 1] * vector[..., None, 1]
        + matrix[..., :, 2] * vector[..., None, 2]
    )


def transposed(matrix: Array) -> Array:
    """The inverse of rotations (..., 3, 3)."""
    return np.swapaxes(matrix, -1, -2)


def about_z(angle: Array) -> Array:
    """Rotations about z by angles [rad], (...) to (..., 3, 3)."""
    cos, sin = np.cos(angle), np.sin(angle)
    zero, one = np.zeros_like(cos), np.ones_like(cos)
    return np.stack(
        [np.stack([cos, -sin, zero], -1), np.stack([sin, cos, zero], -1), np.stack([zero, zero, one], -1)], -2
    )


def about_vector(vector: Array) -> Array:
    """Rotations by rotation vectors [rad], (..., 3) to (..., 3, 3); Rodrigues' formula."""
    x, y, z = vector[..., 0], vector[..., 1], vector[..., 2]
    angle = np.sqrt(x * x + y * y + z * z)
    safe = np.where(angle < SMALL_TURN, 1.0, angle)
    first = np.where(angle < SMALL_TURN, 1.0, np.sin(safe) / safe)
    second = np.where(angle < SMALL_TURN, 0.5, 2 * (np.sin(safe / 2) / safe) ** 2)
    return np.stack(
        [
            np.stack([1 - second * (y * y + z * z), second * x * y - first * z, second * x * z + first * y], -1),
            np.stack([second * x * y + first * z, 1 - second * (x * x + z * z), second * y * z - first * x], -1),
            np.stack([second * x * z - first * y, second * y * z + first * x, 1 - second * (x * x + y * y)], -1),
        ],
        -2,
    )


def transform(rotation: Array, translation: Array) -> Array:
    """Transforms (..., 4, 4) of rotations (..., 3, 3) and translations (..., 3)."""
    pose = np.zeros((*rotation.shape[:-2], 4, 4))
    pose[..., :3, :3] = rotation
    pose[..., :3, 3] = translation
    pose[..., 3, 3] = 1.0
    return pose
