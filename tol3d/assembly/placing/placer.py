"""Moves as planned by nominal geometry, once for all trials."""

from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from tol3d.assembly.model import Assembly, Fix, Move, Weld
from tol3d.assembly.model.statuses import OK
from tol3d.assembly.placing.asked import Asked
from tol3d.assembly.placing.poses import Codes, Pose
from tol3d.assembly.placing.world import World
from tol3d.numerics.arrays import Array

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
