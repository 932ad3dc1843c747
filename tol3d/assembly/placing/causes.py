"""Possible failures before a measure: datum frames and moves, each with those that it needs."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from tol3d.assembly.model import Assembly, Engage, Measured, Move, StatedMove, Weld
from tol3d.assembly.model.moves import pairs_of
from tol3d.errors import InputError

Cause = str | int
"""Name of a datum frame, or index of a move."""


@dataclass(frozen=True, eq=False)
class Causes:
    """State before the first move or after one: the moves on which the poses of parts depend.

    Args:
        assembly: the model.
        placed: of each part that is placed, what may have failed.
        bodies: parts welded to each part, itself included.
    """

    assembly: Assembly
    placed: Mapping[str, frozenset[Cause]]
    bodies: Mapping[str, frozenset[str]]

    def of_frame(self, name: str) -> frozenset[Cause]:
        """Failures of a datum frame: its own and those of its features; none for ""."""
        if not name:
            return frozenset()
        features = (feature for datum in self.assembly.datum_frames[name].datums for feature in datum.features)
        return frozenset([name]).union(*(self.of_feature(feature) for feature in features))

    def of_feature(self, name: str) -> frozenset[Cause]:
        """Failures of a feature in its part."""
        return self.of_frame(self.assembly.features[name].parent)

    def of_part(self, name: str, reader: str) -> frozenset[Cause]:
        """Failures of a part in the world.

        Raises:
            InputError: no move has placed it.
        """
        if name not in self.placed:
            raise InputError(f"{reader}: {name} is not placed: expected a move before that places it")
        return self.placed[name]

    def after(self, index: int, move: Move) -> "Causes":
        """After a move."""
        if isinstance(move, Weld):
            for part in (move.part, *move.others):
                self.of_part(part, f"moves.{move.name}")
            body = frozenset[str]().union(*(self.bodies[part] for part in (move.part, *move.others)))
            return Causes(self.assembly, self.placed, {**self.bodies, **dict.fromkeys(body, body)})
        causes = frozenset([index]).union(*self._of_move(move))
        if isinstance(move, StatedMove):
            bodies = {other: causes for part in move.parts for other in self.bodies[part]}
            return Causes(self.assembly, {**self.placed, **bodies}, self.bodies)
        held = self.placed.get(move.part, frozenset())
        placed = {part: causes | held | self.placed[part] for part in self.bodies[move.part] - {move.part}}
        return Causes(self.assembly, {**self.placed, **placed, move.part: causes}, self.bodies)

    def _of_move(self, move: Move) -> Iterable[frozenset[Cause]]:
        if isinstance(move, StatedMove):
            yield from map(self.of_frame, move.frames)
            yield from self._of_stated(move)
            return
        for moving, target in self._pairs(move):
            yield self.of_feature(moving) | self.of_feature(target)
            yield self.of_part(self.assembly.features[target].part, f"moves.{move.name}")
            own = self.assembly.features[moving].part
            if own != move.part:
                yield self.of_part(own, f"moves.{move.name}") | self.of_part(move.part, f"moves.{move.name}")

    def _of_stated(self, move: StatedMove) -> Iterable[frozenset[Cause]]:
        its = frozenset[str]().union(*(self.bodies[part] for part in move.parts))
        for moving, target in move.pairs:
            yield self.of_feature(moving) | self.of_feature(target)
            if (part := self.assembly.features[target].part) not in its:
                yield self.of_part(part, f"moves.{move.name}")

    def _pairs(self, move: Move) -> Sequence[tuple[str, str]]:
        """See pairs_of; for engagements, the feature of the placed body and the other one."""
        if not isinstance(move, Engage):
            return pairs_of(move)
        related, body = len(move.relations), self.bodies[move.part]
        both = pairs_of(move)[related:]
        engaged = [pair if self.assembly.features[pair[0]].part in body else pair[::-1] for pair in both]
        return [*pairs_of(move)[:related], *engaged]

    def before(self, move: Move) -> frozenset[Cause]:
        """Failures before a move, of all that it needs."""
        return frozenset[Cause]().union(*self._of_move(move))


def causes_of(measured: Measured, name: str, moments: tuple[Causes, ...]) -> tuple[Cause, ...]:
    """Possible failures before a measure is read, in order: datum frames, then moves.

    Args:
        measured: the measure.
        name: its name.
        moments: before the first move, and after each.
    """
    return ordered(_causes(measured, name, moments))


def ordered(causes: Iterable[Cause]) -> tuple[Cause, ...]:
    """Datum frames, then moves."""
    return tuple(sorted(causes, key=lambda cause: (isinstance(cause, int), cause)))


def _causes(measured: Measured, name: str, moments: tuple[Causes, ...]) -> frozenset[Cause]:
    if measured.of_move >= 0:
        return moments[measured.of_move].before(moments[0].assembly.moves[measured.of_move])
    causes = moments[-1] if measured.after < 0 else moments[measured.after + 1]
    found = causes.of_frame(measured.frame).union(*(causes.of_feature(feature) for feature in measured.features))
    if not measured.reads.of_part:
        parts = {*measured.parts, *(causes.assembly.features[feature].part for feature in measured.features)}
        found = found.union(*(causes.of_part(part, f"measures.{name}") for part in parts))
    return found | (_causes(measured.minus, name, moments) if measured.minus is not None else frozenset())
