"""The main bearing of the carrier."""

from typing import ClassVar, Literal

from pydantic import Field

from tol3d.cycloid.grammar.parts.crank_carrier import CrankCarrierSpec
from tol3d.scene.name import Name
from tol3d.scene.reference import Reference
from tol3d.scene.tolerance import ToleranceSpec


class CarrierBearingSpec(ToleranceSpec):
    """A length: the axis of the carrier lies off that of its main bearing, in a random direction that turns with it.

    Half of a run-out of the inner ring.
    """

    words: ClassVar[str] = "the main bearing of a carrier"

    kind: Literal["carrier_bearing"]
    of: Name = Field(description="the carrier")

    def references(self) -> tuple[Reference, ...]:
        """What it is a tolerance of."""
        return (Reference(("of",), self.of, (CrankCarrierSpec,)),)
