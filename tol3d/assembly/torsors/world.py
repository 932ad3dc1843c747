"""Parts in the world after moves: a torsor each, seen at the world's origin."""

from collections.abc import Mapping
from copy import copy

from tol3d.assembly.model import Assembly, Fix, Weld
from tol3d.assembly.torsors.columns import Columns
from tol3d.assembly.torsors.features import PartTorsors
from tol3d.assembly.torsors.torsor import seen_from
from tol3d.numerics.arrays import Array


class World:
    """Torsors of parts after a move; before the first move all are nominal.

    Args:
        assembly: the model.
        columns: its columns, extended by datum frames and moves.
    """

    def __init__(self, assembly: Assembly, columns: Columns) -> None:
        self.assembly = assembly
        self.columns = columns
        self.own = {part.name: PartTorsors(part, columns) for part in assembly.parts}
        self.parts: Mapping[str, Array] = {part.name: columns.zeros(6) for part in assembly.parts}
        self.slacks: Mapping[str, Array] = {}
        self._bodies = {part.name: frozenset([part.name]) for part in assembly.parts}

    def part_of(self, feature: str) -> str:
        """The part to which a feature belongs."""
        return self.assembly.features[feature].part

    def frame(self, feature: str) -> Array:
        """A feature's frame, nominally in the world (4, 4)."""
        return self.assembly.part[self.part_of(feature)].pose @ self.assembly.features[feature].frame

    def origin(self, feature: str) -> Array:
        """The origin of a feature's frame, nominally in the world (3,) [mm]."""
        return self.frame(feature)[:3, 3]

    def axis(self, feature: str) -> Array:
        """The z of a feature's frame, nominally in the world (3,)."""
        return self.frame(feature)[:3, 2]

    def turned(self, direction: Array, part: str) -> Array:
        """A direction in a part's frame (3,) or directions (directions, 3), in the world."""
        return direction @ self.assembly.part[part].pose[:3, :3].T

    def on_part(self, feature: str) -> Array:
        """The torsor (6, columns) of a feature on its part, in the world."""
        part = self.part_of(feature)
        return seen_from(self.assembly.part[part].pose) @ self.own[part].feature(feature)

    def frame_on_part(self, frame: str, part: str) -> Array:
        """The torsor (6, columns) of a datum frame on its part, in the world; 0 for "", the part's frame."""
        return seen_from(self.assembly.part[part].pose) @ self.own[part].datum_frame(frame)

    def placed(self, feature: str) -> Array:
        """The torsor (6, columns) of a feature, in the world."""
        return self.parts[self.part_of(feature)] + self.on_part(feature)

    def on_body(self, feature: str, part: str) -> Array:
        """The torsor (6, columns) of a feature relative to a part of the same body, in the world."""
        return self.placed(feature) - self.parts[part]

    def with_part_at(self, part: str, torsor: Array) -> "World":
        """The world in which a part has a torsor; what is welded to it goes along."""
        moved = torsor - self.parts[part]
        body = self._bodies[part]
        changed = copy(self)
        changed.parts = {name: own + moved if name in body else own for name, own in self.parts.items()}
        return changed

    def with_slack(self, move: str, slack: Array) -> "World":
        """The world in which a move with play has a slack (columns,)."""
        changed = copy(self)
        changed.slacks = {**self.slacks, move: slack}
        return changed

    def is_of_body(self, feature: str, part: str) -> bool:
        """True if a feature belongs to a part or to a part welded to it."""
        return self.part_of(feature) in self._bodies[part]

    def with_welded(self, parts: tuple[str, ...]) -> "World":
        """The world in which parts and what is welded to them are one body."""
        body = frozenset().union(*(self._bodies[part] for part in parts))
        changed = copy(self)
        changed._bodies = self._bodies | dict.fromkeys(body, body)
        return changed

    def size(self, feature: str) -> Array:
        """Deviation of a feature's size (columns,) [mm]."""
        return self.own[self.part_of(feature)].size(feature)

    def mating_size(self, feature: str) -> Array:
        """Deviation of the size of a feature that a fit sees, form included (columns,) [mm]."""
        return self.own[self.part_of(feature)].mating_size(feature)


def fixed(move: Fix, world: World) -> World:
    """The world with a part that stays where it is drawn."""
    return world.with_part_at(move.part, world.columns.zeros(6))


def welded(move: Weld, world: World) -> World:
    """The world in which parts are one body."""
    return world.with_welded(move.joined)
