"""Tolerances of links that are no gear meshes."""

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Literal

from pydantic import Field

from tol3d.gearing.effects import LinkDeviation
from tol3d.gearing.grammar.moves import LinkSpec, ReducerSpec
from tol3d.gearing.grammar.tolerances.gearing_tolerance import GearingToleranceSpec, Meaning
from tol3d.scene.move import MoveSpec
from tol3d.scene.name import Name
from tol3d.scene.part import PartSpec
from tol3d.scene.reference import Contradiction, Reference
from tol3d.units import Dimension

if TYPE_CHECKING:
    from tol3d.gearing.model.contributor import Unit
    from tol3d.gearing.model.nominal import Nominal


class LinkToleranceSpec(GearingToleranceSpec):
    """A deviation of a link; the link finds it by the kind of the tolerance, and knows what it does to its play."""

    link_spec: ClassVar[type[Any]] = LinkSpec  # or a kind of it

    of: Name = Field(description="the link")

    def references(self) -> tuple[Reference, ...]:
        """The link."""
        return (Reference(("of",), self.of, (self.link_spec,)),)

    def meaning(self, nominal: "Nominal") -> Meaning:
        """A deviation of one component, of the link alone."""
        return Meaning(LinkDeviation(self.of))


class ReducerBacklashSpec(LinkToleranceSpec):
    """An angle: the free turn of the reducer's driven shaft while its driver is held; draws below 0 are unphysical."""

    dimensions: ClassVar[tuple[Dimension, ...]] = ("angle",)
    link_spec: ClassVar[type[Any]] = ReducerSpec

    kind: Literal["reducer_backlash"]
    of: Name = Field(description="the reducer")

    def contradictions(self, parts: Mapping[str, PartSpec], moves: Mapping[str, MoveSpec]) -> Iterator[Contradiction]:
        """The reducer's own backlash would be a second one."""
        reducer = moves[self.of]
        if isinstance(reducer, ReducerSpec) and reducer.backlash is not None:
            got = f"{self.of!r}, which says backlash: {reducer.backlash}"
            yield Contradiction(("of",), "a reducer without a backlash of its own", got)

    def meaning(self, nominal: "Nominal") -> Meaning:
        """The shaft that the reducer drives has this play."""
        return Meaning(LinkDeviation(self.of), least=0.0)

    @property
    def unit(self) -> "Unit":
        """Arc minutes, as data sheets state it."""
        return "arcmin"
