"""Places of the pins on which planets turn."""

from typing import ClassVar, Literal

from pydantic import Field

from tol3d.planetary.grammar.parts.carrier import CarrierSpec
from tol3d.scene.name import Name
from tol3d.scene.reference import Reference
from tol3d.scene.tolerance import ToleranceSpec


class PlanetPinSpec(ToleranceSpec):
    """A length: each pin, or the bore of the carrier that holds it, lies off its place; each one's own deviation.

    `radial` is positive outwards, `tangential` counter-clockwise; `random` takes the law for the distance from the
    place, in any direction, as the axis of a bore within a round position zone.
    """

    words: ClassVar[str] = "places of pins"

    kind: Literal["planet_pin"]
    of: Name = Field(description="the carrier")
    each: Literal["planet"] = Field(default="planet", description="planet: every pin deviates by itself")
    direction: Literal["radial", "tangential", "random"] = Field(description="radial, tangential or random")

    def references(self) -> tuple[Reference, ...]:
        """The carrier."""
        return (Reference(("of",), self.of, (CarrierSpec,)),)
