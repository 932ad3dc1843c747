"""Possible failures before a measure: datum frames and moves, each with those that it needs."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from tol3d.assembly.model import Assembly, Measured, Move
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
        for part in move.joined:
            self.of_part(part, f"moves.{move.name}")
        joined = frozenset[str]().union(*(self.bodies[part] for part in move.joined))
        causes, placed = frozenset([index]).union(*self._of_move(move)), dict(self.placed)
        for part in move.parts:
            held = self.placed.get(part, frozenset())
            placed |= {other: causes | held | self.placed[other] for other in self.bodies[part] - {part}}
            placed[part] = causes
        return Causes(self.assembly, placed, {**self.bodies, **dict.fromkeys(joined, joined)})

    def _of_move(self, move: Move) -> Iterable[frozenset[Cause]]:
        yield from map(self.of_frame, move.frames)
        leader = {other: part for part in move.parts for other in self.bodies[part]}
        for name in (each for pair in move.feature_pairs for each in pair):
            yield self.of_feature(name)
            part = self.assembly.features[name].part
            if part not in move.parts:  # of another body, or welded to one that it places
                yield self.of_part(part, f"moves.{move.name}")
                yield self.of_part(leader.get(part, part), f"moves.{move.name}")

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
