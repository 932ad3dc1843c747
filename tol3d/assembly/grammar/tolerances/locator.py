"""Repeatability of a locator: how far a contact of a move lies off along its normal."""

from collections.abc import Iterator, Mapping
from typing import Any, ClassVar, Literal

from pydantic import Field

from tol3d.assembly.grammar.moves.locating import LocatingSpec
from tol3d.scene.name import Name
from tol3d.scene.reference import Contradiction, Reference
from tol3d.scene.tolerance import ToleranceSpec


class LocatorSpec(ToleranceSpec):
    """How far a locator stands off along its normal; positive lifts the part."""

    words: ClassVar[str] = "a locator's tolerance"

    kind: Literal["locator"]
    of: Name = Field(description="the move")
    pair: str = Field(description="which of its pairs: primary 1 .. 3, secondary 1, 2, tertiary 1, or 1 .. 6")

    def references(self) -> tuple[Reference, ...]:
        """The move."""
        return (Reference(("of",), self.of, (LocatingSpec,)),)

    def contradictions(self, parts: Mapping[str, Any], moves: Mapping[str, Any]) -> Iterator[Contradiction]:
        """A pair that the move does not have."""
        known = tuple(moves[self.of].pairs_by_name)
        if self.pair not in known:
            yield Contradiction(("pair",), f"one of {', '.join(known)}", repr(self.pair), known)
