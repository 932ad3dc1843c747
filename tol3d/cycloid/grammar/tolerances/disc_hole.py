"""Places of the holes of the discs."""

from typing import ClassVar, Literal

from pydantic import Field

from tol3d.cycloid.grammar.parts.cycloid_disc import CycloidDiscSpec
from tol3d.scene.name import Name
from tol3d.scene.reference import Reference
from tol3d.scene.tolerance import ToleranceSpec


class DiscHoleSpec(ToleranceSpec):
    """A length: each hole for a crank lies off its place in the disc by it, in a random direction."""

    words: ClassVar[str] = "places of a disc's holes"

    kind: Literal["disc_hole"]
    of: Name = Field(description="the disc")
    each: Literal["hole"] = Field(default="hole", description="hole: every hole of every disc deviates by itself")

    def references(self) -> tuple[Reference, ...]:
        """What it is a tolerance of."""
        return (Reference(("of",), self.of, (CycloidDiscSpec,)),)
