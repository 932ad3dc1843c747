"""The pins of a carrier, drawn as features of a part."""

from collections.abc import Iterator
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from tol3d.assembly.grammar.feature_name import FeatureName, Use, part_of
from tol3d.assembly.grammar.parts import SolidSpec
from tol3d.gearing.grammar.parts import TurningSpec
from tol3d.machine.grammar.shaft_in_bores import BORES
from tol3d.scene.listed import listed
from tol3d.scene.move import MoveSpec
from tol3d.scene.name import Name
from tol3d.scene.reference import Reference


class CarrierPinsSpec(MoveSpec):
    """Planets, or the cranks of an RV reducer, turn about axes of a part that is drawn: the carrier's plate.

    The part is drawn and placed anywhere, for it turns with the carrier: how far each pin lies off its place about the
    part's `axis` counts, outwards and along the circle, in the middle of the pin.
    """

    words: ClassVar[str] = "pins of a carrier"

    kind: Literal["carrier_pins"]
    carrier: Name = Field(description="the carrier of a planetary set or an RV reducer")
    axis: FeatureName = Field(description="axis about which it turns, such as plate.bearing; z as that of the train")
    pins: Annotated[tuple[FeatureName, ...], listed("pins", 1, 12)] = Field(
        description="of all planets or cranks in their order, counter-clockwise about that z, such as plate.pin 1"
    )

    def references(self) -> tuple[Reference, ...]:
        """The carrier, and the part with its pins."""
        own = ((("axis",), self.axis), *((("pins", k), name) for k, name in enumerate(self.pins)))
        parts = (Reference(path, part_of(name), (SolidSpec,)) for path, name in own)
        return (Reference(("carrier",), self.carrier, (TurningSpec,)), *parts)

    def uses(self) -> Iterator[Use]:
        """The axis and the pins."""
        yield Use(("axis",), self.axis, BORES)
        yield from (Use(("pins", k), name, BORES) for k, name in enumerate(self.pins))
