"""The common slack of a move with play."""

from collections.abc import Sequence
from typing import ClassVar, Literal

from pydantic import Field

from tol3d.assembly.grammar.measures.assembly_measure import AssemblyMeasureSpec
from tol3d.assembly.grammar.moves.forgotten import MoveReference
from tol3d.assembly.grammar.moves.play import PlaySpec
from tol3d.assembly.model.measures import PLACING, TORSORS, Measured, Reading
from tol3d.scene.name import Name
from tol3d.scene.reference import Reference


class SlackSpec(AssemblyMeasureSpec):
    """The largest clearance that a pose leaves at all pairs of a `pin_and_hole` or `pattern` move together.

    Below 0 they do not go together.
    """

    words: ClassVar[str] = "a slack"
    reads: ClassVar[Reading] = Reading("slack", f"{PLACING}:slack", f"{TORSORS}:slack", is_linear=True)

    kind: Literal["slack"]
    of: Name = Field(description="the move, of kind pin_and_hole or pattern")

    def references(self) -> tuple[Reference, ...]:
        """The move."""
        return (MoveReference(("of",), self.of, (PlaySpec,)),)

    @property
    def of_what(self) -> Sequence[str]:
        """The move."""
        return (self.of,)

    def measured(self, moves: Sequence[str]) -> Measured:
        """The move."""
        return Measured(self.reads, (), of_move=moves.index(self.of))
