"""Kinds of tolerance of planetary sets."""

from collections.abc import Iterator
from typing import ClassVar, Literal, Self

from pydantic import Field
from typing_extensions import override

from tol3d.assembly.grammar.zone import LawUnion, scaled_in_zone
from tol3d.files import Files
from tol3d.gearing.planetary.grammar.parts import CarrierSpec
from tol3d.scene.bases import Length, PartSpec, ToleranceEntry, ToleranceSpec
from tol3d.scene.entry import AboutOne
from tol3d.scene.name import Name
from tol3d.scene.place import KeyPath
from tol3d.statistics.distributions.base import Stays
from tol3d.strict import Strict


class RoundZoneSpec(Strict):
    """A cylinder about where an axis should be."""

    diameter: Length = Field(description="of the cylinder: ⌀ in the frame of the drawing")

    def scaled(self, factor: float) -> Self:
        """Tolerance of a multiple of the width."""
        return self.model_copy(update={"diameter": self.diameter.like(factor * self.diameter.internal)})


class BorePositionSpec(AboutOne, ToleranceEntry):
    """A true position of the bores for the pins, to the carrier's own axis: each bore's axis lies in its cylinder.

    Axes stay parallel to the set's. Laws are those of position tolerances of general parts.
    """

    words: ClassVar[str] = "a position tolerance of bores"
    applies_to: ClassVar[tuple[type[PartSpec], ...]] = (CarrierSpec,)

    kind: Literal["bore_position"]
    of: Name = Field(description="the carrier")
    each: Literal["planet"] = Field(default="planet", description="planet: every bore deviates by itself")
    zone: RoundZoneSpec = Field(description="zone of the drawing: a diameter")
    law: LawUnion

    @override
    def scaled(self, factor: float, stays: Stays, files: Files) -> Self:
        return scaled_in_zone(self, factor, stays, files)

    def file_names(self) -> Iterator[tuple[KeyPath, str]]:
        """Files that its law reads."""
        return ((("law", *path), name) for path, name in self.law.file_names())


class PlanetPinSpec(AboutOne, ToleranceSpec):
    """A length: each pin, or the bore of the carrier that holds it, lies off its place; each one's own deviation.

    `radial` is positive outwards, `tangential` counter-clockwise; `random` takes the law for the distance from the
    place, in any direction, as the axis of a bore within a round position zone.
    """

    words: ClassVar[str] = "places of pins"
    applies_to: ClassVar[tuple[type[PartSpec], ...]] = (CarrierSpec,)

    kind: Literal["planet_pin"]
    of: Name = Field(description="the carrier")
    each: Literal["planet"] = Field(default="planet", description="planet: every pin deviates by itself")
    direction: Literal["radial", "tangential", "random"] = Field(description="radial, tangential or random")
