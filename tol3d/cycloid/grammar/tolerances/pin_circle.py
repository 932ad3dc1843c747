"""Radius of the pins' circle."""

from typing import ClassVar, Literal

from pydantic import Field

from tol3d.cycloid.grammar.parts.pin_ring import PinRingSpec
from tol3d.scene.name import Name
from tol3d.scene.reference import Reference
from tol3d.scene.tolerance import ToleranceSpec


class PinCircleSpec(ToleranceSpec):
    """A length: the radius of the pins' circle is larger by it, alike for all pins."""

    words: ClassVar[str] = "radius of the pins' circle"

    kind: Literal["pin_circle"]
    of: Name = Field(description="the ring of pins")

    def references(self) -> tuple[Reference, ...]:
        """What it is a tolerance of."""
        return (Reference(("of",), self.of, (PinRingSpec,)),)
