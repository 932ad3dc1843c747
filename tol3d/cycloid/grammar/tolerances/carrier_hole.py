"""Places of the holes of the carrier."""

from typing import ClassVar, Literal

from pydantic import Field

from tol3d.cycloid.grammar.parts.crank_carrier import CrankCarrierSpec
from tol3d.scene.name import Name
from tol3d.scene.reference import Reference
from tol3d.scene.tolerance import ToleranceSpec


class CarrierHoleSpec(ToleranceSpec):
    """A length: holes for crankshafts lie off their places in the carrier, in a random direction that turns with it.

    `hole` takes a deviation of every hole; `circle` one of their common centre.
    """

    words: ClassVar[str] = "places of a carrier's holes"

    kind: Literal["carrier_hole"]
    of: Name = Field(description="the carrier")
    each: Literal["hole", "circle"] = Field(default="hole", description="hole: every hole by itself; circle: all alike")

    def references(self) -> tuple[Reference, ...]:
        """What it is a tolerance of."""
        return (Reference(("of",), self.of, (CrankCarrierSpec,)),)
