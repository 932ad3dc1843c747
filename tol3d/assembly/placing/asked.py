"""Constraints of datums and moves on the motions of a part, nominally, for tables of freedoms."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tol3d.assembly.model import Assembly
from tol3d.assembly.model.feature import Asks
from tol3d.numerics.arrays import Array


@dataclass(frozen=True, eq=False)
class Asked:
    """Constraint by one feature, contact or relation, or by several at once.

    Args:
        words: its description.
        rows: its change per shift of the reference point of motions, and per turn (rows, 6) [mm].
        is_room: True if it takes no freedom but leaves a clearance.
    """

    words: str
    rows: Array
    is_room: bool = False


def point_rows(at: Array, directions: Array) -> Array:
    """Rows of a point (3,) along directions (n, 3)."""
    return np.hstack([directions, np.cross(at, directions)])


def direction_rows(toward: Array) -> Array:
    """Rows of a direction that stays."""
    return np.hstack([np.zeros((2, 3)), across(toward)])


def rows_of(asks: Asks, at: Array, z: Array) -> Array:
    """Rows of a point (3,) and a direction (3,) that stay as is asked; not of a direction that stays level."""
    held, turning = asks
    rows = point_rows(at, np.eye(3) if held == "all" else z[None] if held == "along" else across(z))
    return np.concatenate([rows, direction_rows(z)]) if turning == "direction" else rows


def across(direction: Array) -> Array:
    """Two directions square to one (2, 3)."""
    return np.asarray(np.linalg.svd(direction[None])[2][1:])


def rows_about(rows: Array, off: Array) -> Array:
    """Rows (n, 6) about another point, from which that of the given rows is offset by (3,)."""
    return np.hstack([rows[:, :3], rows[:, 3:] + np.cross(off, rows[:, :3])])


def frame_in_world(assembly: Assembly, feature: str) -> Array:
    """A feature's frame in the world (4, 4)."""
    own = assembly.features[feature]
    return np.asarray(assembly.part[own.part].pose @ own.frame)


def touched(assembly: Assembly, name: str) -> str:
    """A feature, or the plane of which it is a point that another feature touches."""
    return name if assembly.features[name].is_named else name.rpartition(" at ")[0] or name


def listed(names: Sequence[str]) -> str:
    """Names of features; a common part is named once: "cover.A1, A2"."""
    part = names[0].partition(".")[0]
    if any(name.partition(".")[0] != part for name in names):
        return ", ".join(names)
    return ", ".join([names[0], *(name.partition(".")[2] for name in names[1:])])
