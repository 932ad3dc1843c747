"""Moves as planned by nominal geometry, once for all trials.

Constraints of datums and moves on the motions of a part, nominally, for tables of freedoms.
"""

from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from tol3d.assembly.model import Assembly, Fix, Move, Weld
from tol3d.assembly.model.feature import Asks
from tol3d.assembly.model.statuses import OK
from tol3d.assembly.placing.poses import Codes, Pose
from tol3d.assembly.placing.world import World
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


ALL_OK: Final[Codes] = np.full(1, OK, dtype=np.int8)
"""Codes of a move that never fails."""


class Placer(ABC):
    """A move planned by its nominal geometry; frozen, compared by identity."""

    move: Move

    @property
    def words(self) -> str:
        """By what it places its parts, for tables."""
        return self.move.words

    @abstractmethod
    def placed(self, world: World) -> tuple[World, Codes]:
        """The world after the move, and what became of it: codes (n,) or (1,) of tol3d.assembly.model.statuses."""

    def asked(self, assembly: Assembly, middle: Array) -> Iterator[Asked]:
        """Constraints of a move of one body about a point (3,) in the world, in order; none where `holds` tells."""
        return iter(())


class RoomPlacer(Placer):
    """A move that leaves its part within clearances."""

    @property
    @abstractmethod
    def motions(self) -> int:
        """Number of the part's freedoms that clearances limit."""

    @abstractmethod
    def nudged(self, by: Array) -> "RoomPlacer":
        """The same with the part a step (motions,) [mm] from where other constraints lay it, whatever its float."""

    @abstractmethod
    def at_support_point(self, push: Array) -> "RoomPlacer":
        """The same with the part pushed to the limit along its freedoms (motions,); centred along 0."""

    @abstractmethod
    def pushed_alike(self, move: Any, settled: Assembly) -> tuple[Move, float]:
        """A settled move that pushes as this one does, as a push does not turn itself.

        Args:
            move: of the settled assembly.
            settled: with parts where moves place them without deviations.

        Returns:
            The move, and shift times turn by which the push displaces the part [mm], of second order.
        """


class RockingPlacer(Placer):
    """A move whose part a force presses on one-sided contacts, on which it may rock."""

    rows: Array
    """Change of nominal gaps by its motions (contacts, motions)."""
    pull: Array
    """Force along its motions (motions,)."""
    reach: float
    """Largest distance of contacts from their middle [mm]."""

    @property
    @abstractmethod
    def contacts(self) -> Sequence[tuple[str, str]]:
        """Features of each contact: of the part, and what it touches."""

    @abstractmethod
    def nudged(self, by: Array) -> "RockingPlacer":
        """The same, moved on along the motions (motions, n), to second order."""

    @abstractmethod
    def leaning(self, along: Array) -> "RockingPlacer":
        """The same, pushed to the limit along a motion (motions,) where it may rock."""

    @abstractmethod
    def carries(self) -> tuple[Array, Array]:
        """The least and the largest part of the force that each contact may carry (contacts,)."""


@dataclass(frozen=True, eq=False)
class Fixing(Placer):
    """A part that stays where it is drawn."""

    move: Fix

    def placed(self, world: World) -> tuple[World, Codes]:
        return world.with_part_at(self.move.part, Pose.of(world.assembly.part[self.move.part].pose)), ALL_OK


def fixing(move: Fix, nominal: World) -> Fixing:
    """A part that stays where it is drawn."""
    return Fixing(move)


@dataclass(frozen=True, eq=False)
class Welding(Placer):
    """Parts that become one body."""

    move: Weld

    def placed(self, world: World) -> tuple[World, Codes]:
        return world.with_welded(self.move.joined), ALL_OK


def welding(move: Weld, nominal: World) -> Welding:
    """Parts that become one body."""
    return Welding(move)
