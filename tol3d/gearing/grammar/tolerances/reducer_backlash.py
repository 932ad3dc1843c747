"""Backlash of a reducer."""

from collections.abc import Iterator, Mapping
from typing import ClassVar, Literal

from pydantic import Field

from tol3d.gearing.grammar.moves import MoveSpec, ReducerSpec
from tol3d.gearing.grammar.parts import PartSpec
from tol3d.scene.name import Name
from tol3d.scene.reference import Contradiction, Reference
from tol3d.scene.tolerance import ToleranceSpec
from tol3d.units import Dimension


class ReducerBacklashSpec(ToleranceSpec):
    """An angle: the free turn of the reducer's driven shaft while its driver is held; draws below 0 are unphysical."""

    dimensions: ClassVar[tuple[Dimension, ...]] = ("angle",)

    kind: Literal["reducer_backlash"]
    of: Name = Field(description="the reducer")

    def references(self) -> tuple[Reference, ...]:
        """The reducer."""
        return (Reference(("of",), self.of, (ReducerSpec,)),)

    def contradictions(self, parts: Mapping[str, PartSpec], moves: Mapping[str, MoveSpec]) -> Iterator[Contradiction]:
        """The reducer's own backlash would be a second one."""
        reducer = moves[self.of]
        if isinstance(reducer, ReducerSpec) and reducer.backlash is not None:
            got = f"{self.of!r}, which says backlash: {reducer.backlash}"
            yield Contradiction(("of",), "a reducer without a backlash of its own", got)
