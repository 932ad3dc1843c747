"""A shaft in the bores of parts that are placed.

The pins of a carrier, drawn as features of a part.
"""

from collections.abc import Iterator
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from tol3d.assembly.grammar.feature_name import FeatureName, Use, part_of
from tol3d.assembly.grammar.parts import SolidSpec
from tol3d.gearing.grammar.parts import ShaftReference, TurningSpec
from tol3d.scene.bases import MoveSpec
from tol3d.scene.entry import Reference
from tol3d.scene.listed import listed
from tol3d.scene.name import Name
from tol3d.scene.vector import Coordinate

BORES = ("axis", "cylinder")


class ShaftInBoresSpec(MoveSpec):
    """The axis of a shaft is the line through the middles of two bores as they lie in the trial, or a long bore's own.

    Centre distances, azimuths and tilts of the meshes on such shafts follow from their bores. What bearings leave free
    is a tolerance of its own, `bearing_clearance`.
    """

    words: ClassVar[str] = "a shaft in bores"

    kind: Literal["shaft_in_bores"]
    shaft: Name = Field(description="the shaft, or the gear that is its own")
    in_: Annotated[tuple[FeatureName, ...], listed("bores", 1, 2)] = Field(
        alias="in", description="two bores, or one that is long enough to hold the shaft alone, such as housing.bore 1"
    )
    at: Coordinate | None = Field(
        default=None,
        description="where the shaft's origin lies, from the middle of the first bore towards the other one, or along "
        "the z of a single one; 0 mm of a train's first shaft, else it follows from the meshes",
    )

    def references(self) -> tuple[Reference, ...]:
        """The shaft, and the parts with its bores."""
        parts = (Reference(("in", k), part_of(name), (SolidSpec,)) for k, name in enumerate(self.in_))
        return (ShaftReference(("shaft",), self.shaft), *parts)

    def uses(self) -> Iterator[Use]:
        """The bores."""
        return (Use(("in", k), name, BORES) for k, name in enumerate(self.in_))


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
