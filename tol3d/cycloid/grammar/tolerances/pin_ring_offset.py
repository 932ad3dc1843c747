"""A pin ring off its axis."""

from typing import ClassVar, Literal

from pydantic import Field

from tol3d.cycloid.grammar.parts.pin_ring import PinRingSpec
from tol3d.scene.name import Name
from tol3d.scene.reference import Reference
from tol3d.scene.tolerance import ToleranceSpec


class PinRingOffsetSpec(ToleranceSpec):
    """A length: the pins' circle lies off the axis of the carrier by it, in a random direction."""

    words: ClassVar[str] = "the pin ring off its axis"

    kind: Literal["pin_ring_offset"]
    of: Name = Field(description="the ring of pins")

    def references(self) -> tuple[Reference, ...]:
        """What it is a tolerance of."""
        return (Reference(("of",), self.of, (PinRingSpec,)),)
