"""Poses of many trials, component by component: values common to all trials are computed once.

Arrays have the trial on the LAST axis: vectors (3, n), rotations (3, 3, n), with n = 1 if nothing varies, so that each
product is a few long loops; `numerics.frames` has the trial first. No BLAS and no function of angles: a trial has the
same bits alone and among thousands.
"""

from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.arrays import Array

Codes = NDArray[np.int8]
Number = TypeVar("Number", bound=np.generic)

NO_LENGTH = 1e-150  # under it a squared length is 0 and has no direction


def dot(left: Array, right: Array) -> Array:
    """Scalar products of vectors (3, ...)."""
    return np.asarray(left[0] * right[0] + left[1] * right[1] + left[2] * right[2])


def cross(left: Array, right: Array) -> Array:
    """Vector products of vectors (3, ...)."""
    return np.stack(
        [
            left[1] * right[2] - left[2] * right[1],
            left[2] * right[0] - left[0] * right[2],
            left[0] * right[1] - left[1] * right[0],
        ]
    )


def length(vector: Array) -> Array:
    """Lengths of vectors (3, ...)."""
    return np.asarray(np.sqrt(dot(vector, vector)))


def square_to(vector: Array, direction: Array) -> Array:
    """The part of vectors (3, ...) that is square to directions of unit length."""
    return vector - dot(vector, direction) * direction


def unit(vector: Array) -> Array:
    """Vectors of length 1; 0 stays 0."""
    square = dot(vector, vector)
    return vector / np.sqrt(np.where(square > NO_LENGTH, square, 1.0))


def rotated(turn: Array, vector: Array) -> Array:
    """Rotations (3, 3, n) times vectors (3, n)."""
    return np.asarray(turn[:, 0] * vector[0] + turn[:, 1] * vector[1] + turn[:, 2] * vector[2])


def rotated_back(turn: Array, vector: Array) -> Array:
    """The inverse of rotations (3, 3, n) times vectors (3, n)."""
    return np.asarray(turn[0] * vector[0] + turn[1] * vector[1] + turn[2] * vector[2])


def product(left: Array, right: Array) -> Array:
    """Rotations (3, 3, n) one after the other, the right one first."""
    return np.asarray(
        left[:, 0, None] * right[None, 0] + left[:, 1, None] * right[None, 1] + left[:, 2, None] * right[None, 2]
    )


def repeated(values: NDArray[Number], trials: int) -> NDArray[Number]:
    """Values (..., n) of trials that follow each other several times (..., trials); (..., 1) of all of them stay."""
    count = values.shape[-1]
    return values if count in (1, trials) else np.tile(values, trials // count)


def column(vector: Array) -> Array:
    """A vector (3,) of all trials (3, 1)."""
    return np.asarray(vector, dtype=np.float64).reshape(3, 1)


def least_rotation(start: Array, end: Array) -> Array:
    """Rotations of least angle from one direction to another (3, n), of unit length and not opposed.

    R = c 1 + [v]x + v v^T / (1 + c), v = start x end, c = start . end: Rodrigues' formula without its angle.
    """
    vector, cos = cross(start, end), dot(start, end)
    spread = 1.0 + cos
    return _rotation(vector, cos, 1.0 / np.where(spread > NO_LENGTH, spread, 1.0))


def about(direction: Array, cos: Array, sin: Array) -> Array:
    """Rotations about directions of unit length (3, n), by the cosine and the sine of their angles (n,)."""
    return _rotation(direction * sin, cos, 1.0, (1.0 - cos)[None] * direction, direction)


def _rotation(
    sine: Array, cos: Array, share: Array | float, left: Array | None = None, right: Array | None = None
) -> Array:
    """Rotations cos 1 + [sine]x + share left right^T; left and right are `sine` where they are not given."""
    left = sine if left is None else left
    right = sine if right is None else right
    x, y, z = sine
    a, b, c = left * share
    u, v, w = right
    return np.stack(
        [
            np.stack([cos + a * u, a * v - z, a * w + y]),
            np.stack([b * u + z, cos + b * v, b * w - x]),
            np.stack([c * u - y, c * v + x, cos + c * w]),
        ]
    )


def rotation_vector(turn: Array) -> Array:
    """Vectors (3, n) of rotations (3, 3, n): along their axes, as long as their angles [rad], below half a turn."""
    double = np.stack([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
    sine, cosine = 0.5 * np.sqrt(dot(double, double)), 0.5 * (turn[0, 0] + turn[1, 1] + turn[2, 2] - 1.0)
    angle = np.arctan2(sine, cosine)
    return 0.5 * double * np.where(sine > NO_LENGTH, angle / np.where(sine > NO_LENGTH, sine, 1.0), 1.0)


@dataclass(frozen=True, eq=False)
class Pose:
    """From one frame to another: x = turn p + shift.

    Args:
        turn: rotations (3, 3, n).
        shift: (3, n) [mm].
    """

    turn: Array
    shift: Array

    @classmethod
    def of(cls, matrix: Array) -> "Pose":
        """A pose (4, 4) of all trials."""
        matrix = np.asarray(matrix, dtype=np.float64)
        return cls(matrix[:3, :3, None].copy(), matrix[:3, 3, None].copy())

    def point(self, point: Array) -> Array:
        """Points (3, n) taken along."""
        return rotated(self.turn, point) + self.shift

    def __matmul__(self, other: "Pose") -> "Pose":
        """This pose after the other."""
        return Pose(product(self.turn, other.turn), self.point(other.shift))

    @property
    def inverse(self) -> "Pose":
        """From the end to the start."""
        return Pose(np.swapaxes(self.turn, 0, 1), -rotated_back(self.turn, self.shift))

    def turned_about_z(self, cos: Array, sin: Array) -> "Pose":
        """This pose after a turn about its own z, by the cosine and the sine of its angle (n,)."""
        x, y, z = np.swapaxes(self.turn, 0, 1)
        turn = np.empty((3, 3, max(self.turn.shape[-1], len(cos))))
        turn[:, 0], turn[:, 1], turn[:, 2] = x * cos + y * sin, y * cos - x * sin, z
        return Pose(turn, self.shift)

    def repeated(self, trials: int) -> "Pose":
        """Of trials that follow each other several times."""
        return Pose(repeated(self.turn, trials), repeated(self.shift, trials))

    def matrices(self, trials: int) -> Array:
        """4x4 poses (trials, 4, 4)."""
        poses = np.zeros((trials, 4, 4))
        poses[:, :3, :3] = np.moveaxis(self.turn, -1, 0)
        poses[:, :3, 3] = self.shift.T
        poses[:, 3, 3] = 1.0
        return poses


IDENTITY = Pose.of(np.eye(4))
"""Nothing is moved."""


def turned_by(vector: Array, turn: Array) -> Array:
    """Vectors (3, n), or columns of rotations, turned about others (3, n) by 2 atan(length / 2): Cayley's formula."""
    half = turn / 2
    across = cross(half, vector)
    return np.asarray(vector + 2.0 / (1.0 + dot(half, half)) * (across + cross(half, across)))


def moved_about(pose: Pose, middle: Array, shift: Array, turn: Array) -> Pose:
    """A pose turned further about a middle (3,) by a vector (3, n), of angle 2 atan(length / 2), and shifted (3, n)."""
    arm = turned_by(pose.shift - column(middle), turn)
    return Pose(turned_by(pose.turn, turn), column(middle) + arm + shift)


def full(pose: Pose, trials: int) -> Pose:
    """With a trial of its own each."""
    return Pose(
        np.array(np.broadcast_to(pose.turn, (3, 3, trials))), np.array(np.broadcast_to(pose.shift, (3, trials)))
    )
