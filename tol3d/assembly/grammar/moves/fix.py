"""A part that stays where it is nominally."""

from collections.abc import Iterator
from typing import ClassVar, Literal

from tol3d.assembly.grammar.moves.placing_move import PairSpec, PlacingSpec
from tol3d.scene.place import KeyPath


class FixSpec(PlacingSpec):
    """A part stays where it is nominally: the first of an assembly, or a fixture."""

    words: ClassVar[str] = "a fixed part"

    kind: Literal["fix"]

    def paired(self) -> Iterator[tuple[KeyPath, PairSpec]]:
        """None."""
        return iter(())
