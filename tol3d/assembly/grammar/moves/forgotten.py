"""Parts that no move places, and moves to add for them."""

from collections.abc import Mapping
from typing import Any

from tol3d.assembly.grammar.moves.assembly_move import AssemblyMoveSpec, fixed_parts
from tol3d.assembly.grammar.parts import SolidSpec
from tol3d.scene.reference import Reference


class MoveReference(Reference):
    """A move that an entry names."""

    def advice(self, parts: Mapping[str, Any], moves: Mapping[str, Any]) -> str:
        """See Reference: parts that no move places, for one of their moves may have been forgotten."""
        own = [move for move in moves.values() if isinstance(move, AssemblyMoveSpec)]
        placed = {part for move in own for _, part in (*move.parts_placed, *move.joined)}
        lacking = [name for name, part in parts.items() if isinstance(part, SolidSpec) and name not in placed]
        if not lacking:
            return ""
        return f"; no move places {lacking[0]!r}: {how_to_place(lacking[0], moves)}"


def how_to_place(part: str, moves: Mapping[str, Any]) -> str:
    """The move to add for a part: the first one is fixed, others are laid on it."""
    if not fixed_parts(moves):
        return f"add one, such as {{kind: fix, part: {part}}}"
    kinds = "three_two_one, six_plane, best_fit, mate, touch, rest, pin_and_hole or pattern"
    return f"add one of part: {part}, of kind {kinds}, or fix where it stays as it is `placed`"
