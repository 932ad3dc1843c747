"""The common slack of a move with play."""

from collections.abc import Sequence
from typing import ClassVar, Literal

from pydantic import Field

from tol3d.assembly.grammar.feature_name import FeatureName
from tol3d.assembly.grammar.measures.assembly_measure import AssemblyMeasureSpec
from tol3d.assembly.grammar.moves.forgotten import MoveReference
from tol3d.assembly.grammar.moves.play import PlaySpec
from tol3d.scene.name import Name
from tol3d.scene.place import KeyPath
from tol3d.scene.reference import Reference


class SlackSpec(AssemblyMeasureSpec):
    """The largest clearance that a pose leaves at every pin together; below 0 they do not go in."""

    words: ClassVar[str] = "a slack"

    kind: Literal["slack"]
    of: Name = Field(description="the move, of kind pin_and_hole or pattern")

    def references(self) -> tuple[Reference, ...]:
        """The move."""
        return (MoveReference(("of",), self.of, (PlaySpec,)),)

    def named(self) -> Sequence[tuple[KeyPath, FeatureName, tuple[str, ...]]]:
        """None."""
        return ()
