"""Play of the bearings of crankshafts."""

from typing import ClassVar, Literal

from pydantic import Field

from tol3d.cycloid.grammar.parts.crank_carrier import CrankCarrierSpec
from tol3d.cycloid.grammar.parts.cycloid_disc import CycloidDiscSpec
from tol3d.scene.name import Name
from tol3d.scene.reference import Reference
from tol3d.scene.tolerance import ToleranceSpec


class BearingPlaySpec(ToleranceSpec):
    """A length: the diametral clearance of each bearing, twice what an inner ring may lie off the middle of its hole.

    That is the radial internal clearance of ISO 5753-1, which is stated on the diameter, as it is left when fitted. Of
    a disc it is the bearing of each eccentric in it, of a carrier that of each crankshaft. Less than 0 is none.
    """

    words: ClassVar[str] = "play of the cranks' bearings"

    kind: Literal["bearing_play"]
    of: Name = Field(description="the disc or the carrier")
    each: Literal["hole"] = Field(default="hole", description="hole: every bearing has its own")

    def references(self) -> tuple[Reference, ...]:
        """What it is a tolerance of."""
        return (Reference(("of",), self.of, (CycloidDiscSpec, CrankCarrierSpec)),)
