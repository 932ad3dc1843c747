"""Places of the pins."""

from typing import ClassVar, Literal

from pydantic import Field

from tol3d.cycloid.grammar.parts.pin_ring import PinRingSpec
from tol3d.scene.name import Name
from tol3d.scene.reference import Reference
from tol3d.scene.tolerance import ToleranceSpec


class PinPositionSpec(ToleranceSpec):
    """A length: each pin lies off its place; each one's own deviation.

    `radial` is positive outwards, `tangential` counter-clockwise; `random` takes the law for the distance from the
    place, in any direction.
    """

    words: ClassVar[str] = "places of pins"

    kind: Literal["pin_position"]
    of: Name = Field(description="the ring of pins")
    each: Literal["pin"] = Field(default="pin", description="pin: every pin deviates by itself")
    direction: Literal["radial", "tangential", "random"] = Field(description="radial, tangential or random")

    def references(self) -> tuple[Reference, ...]:
        """What it is a tolerance of."""
        return (Reference(("of",), self.of, (PinRingSpec,)),)
