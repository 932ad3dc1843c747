"""What tolerances of links that are no gear meshes have in common."""

from typing import TYPE_CHECKING, Any, ClassVar

from pydantic import Field

from tol3d.gearing.effects import LinkDeviation
from tol3d.gearing.grammar.moves import LinkSpec
from tol3d.gearing.grammar.tolerances.gearing_tolerance import GearingToleranceSpec, Meaning
from tol3d.scene.name import Name
from tol3d.scene.reference import Reference

if TYPE_CHECKING:
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
