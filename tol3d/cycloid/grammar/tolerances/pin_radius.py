"""Radii of the pins."""

from typing import ClassVar, Literal

from pydantic import Field

from tol3d.cycloid.grammar.parts.pin_ring import PinRingSpec
from tol3d.scene.name import Name
from tol3d.scene.reference import Reference
from tol3d.scene.tolerance import ToleranceSpec


class PinRadiusSpec(ToleranceSpec):
    """A length: the radius of each pin is larger by it; each one's own deviation."""

    words: ClassVar[str] = "radii of pins"

    kind: Literal["pin_radius"]
    of: Name = Field(description="the ring of pins")
    each: Literal["pin"] = Field(default="pin", description="pin: every pin deviates by itself")

    def references(self) -> tuple[Reference, ...]:
        """What it is a tolerance of."""
        return (Reference(("of",), self.of, (PinRingSpec,)),)
