"""Small assemblies by numbers: parts of points, planes and axes whose deviations are columns."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from tol3d.assembly.model import Assembly, Contribution, DatumFrame, Feature, Measured, Move, Pair, Part, Shape

Array = NDArray[np.float64]
Vector = Sequence[float] | Array


def seeds(few: int) -> list[Any]:
    """Seeds of random assemblies: a few, and two hundred of the slow tests."""
    return [*range(few), *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(100, 300))]


class Columns:
    """Hands out columns of the deviations."""

    def __init__(self) -> None:
        self.width = 0

    def __call__(self, matrix: object = None, count: int = 1) -> Contribution:
        """A contributor of its own: by how much its components move those of the feature."""
        weights = np.eye(count) if matrix is None else np.atleast_2d(np.asarray(matrix, dtype=np.float64))
        start, self.width = self.width, self.width + weights.shape[1]
        return Contribution(f"contributor {start}", slice(start, self.width), weights)


def frame(origin: Vector, z: Vector = (0, 0, 1), x: Vector | None = None) -> Array:
    """A frame (4, 4) by its origin and z, and x as near as it goes to one that is given."""
    along = np.asarray(z, dtype=np.float64) / np.linalg.norm(z)
    first = np.asarray(x if x is not None else np.eye(3)[np.argmin(np.abs(along))], dtype=np.float64)
    first = first - first @ along * along
    first /= np.linalg.norm(first)
    made = np.eye(4)
    made[:3, :3] = np.column_stack([first, np.cross(along, first), along])
    made[:3, 3] = origin
    return made


def part(name: str, features: Sequence[Feature], frames: Sequence[DatumFrame] = (), pose: object = None) -> Part:
    """A part, at the origin if nothing else is said."""
    return Part(name, np.eye(4) if pose is None else np.asarray(pose), tuple(features), tuple(frames))


def feature(name: str, shape: Shape, at: Array, moved_by: Sequence[Contribution] = (), parent: str = "") -> Feature:
    """A feature of the part that its name begins with."""
    return Feature(name, name.split(".")[0], shape, at, parent, tuple(moved_by))


def posed(rotation_vector: Vector, shift: Vector) -> Array:
    """A pose (4, 4)."""
    made = np.eye(4)
    made[:3, :3] = Rotation.from_rotvec(rotation_vector).as_matrix()
    made[:3, 3] = shift
    return made


def moved_as_a_whole(nominal: Assembly, pose: Array) -> Assembly:
    """The same assembly elsewhere."""
    return replace(nominal, parts=tuple(replace(each, pose=pose @ each.pose) for each in nominal.parts))


def assembly(
    columns: Columns, parts: Sequence[Part], moves: Sequence[Move] = (), measures: Mapping[str, Measured] | None = None
) -> Assembly:
    """An assembly."""
    return Assembly(tuple(parts), tuple(moves), measures or {}, columns.width)


def pair(moving: str, target: str, normal: Vector, locator: Sequence[Contribution] = ()) -> Pair:
    """A contact."""
    return Pair(moving, target, np.asarray(normal, dtype=np.float64), tuple(locator))
