"""Vocabulary of a disc between pins."""

from typing import ClassVar, Literal

from pydantic import Field

from tol3d.scene.bases import Length, MoveSpec, PartSpec, ToleranceSpec
from tol3d.scene.entry import Reference
from tol3d.scene.name import Name
from tol3d.study.system.plain import LengthSpec


class DiscSpec(PartSpec):
    """A disc."""

    words: ClassVar[str] = "a disc"

    kind: Literal["disc"]
    radius: Length


class PlateSpec(PartSpec):
    """A plate with pins round the disc."""

    words: ClassVar[str] = "a plate"

    kind: Literal["pin_plate"]
    pins: int = Field(ge=4)


class RoomSpec(ToleranceSpec):
    """Room that all pins leave round the disc."""

    kind: Literal["pin_room"]
    of: Name

    def references(self) -> tuple[Reference, ...]:
        return (Reference(("of",), self.of, (PlateSpec,)),)


class PinSpec(RoomSpec):
    """Room that each pin leaves besides."""

    kind: Literal["pin"]  # type: ignore[assignment]  # a kind of its own
    each: Literal["pin"]


class OffCentreSpec(ToleranceSpec):
    """Offset of the disc from its centre, in a random direction."""

    kind: Literal["off_centre"]
    of: Name

    def references(self) -> tuple[Reference, ...]:
        return (Reference(("of",), self.of, (DiscSpec,)),)


class DiscInPinsSpec(MoveSpec):
    """The disc is put between the pins."""

    words: ClassVar[str] = "a disc in pins"

    kind: Literal["disc_in_pins"]
    disc: Name
    plate: Name

    def references(self) -> tuple[Reference, ...]:
        return Reference(("disc",), self.disc, (DiscSpec,)), Reference(("plate",), self.plate, (PlateSpec,))


class InPinsSpec(LengthSpec):
    """A measure of a disc in pins."""

    def references(self) -> tuple[Reference, ...]:
        return (Reference(("of",), self.of, (DiscInPinsSpec,)),)


class LeastGapSpec(InPinsSpec):
    """The smallest gap between the disc and a pin."""

    kind: Literal["least_gap"]


class SlideSpec(InPinsSpec):
    """Slide of the disc along x: the play that even pins and odd pins, two load paths, both leave."""

    kind: Literal["slide"]
