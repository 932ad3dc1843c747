"""Position tolerance of the bores of a carrier, as a drawing states it."""

from collections.abc import Iterator
from typing import ClassVar, Literal

from pydantic import Field

from tol3d.assembly.grammar.zone import LawUnion
from tol3d.planetary.grammar.parts.carrier import CarrierSpec
from tol3d.scene.name import Name
from tol3d.scene.part import Length
from tol3d.scene.place import KeyPath
from tol3d.scene.reference import Reference
from tol3d.scene.tolerance import ToleranceEntry
from tol3d.strict import Strict


class RoundZoneSpec(Strict):
    """A cylinder about where an axis should be."""

    diameter: Length = Field(description="of the cylinder: ⌀ in the frame of the drawing")


class BorePositionSpec(ToleranceEntry):
    """A true position of the bores for the pins, to the carrier's own axis: each bore's axis lies in its cylinder.

    Axes stay parallel to the set's. Laws are those of position tolerances of general parts.
    """

    words: ClassVar[str] = "a position tolerance of bores"

    kind: Literal["bore_position"]
    of: Name = Field(description="the carrier")
    each: Literal["planet"] = Field(default="planet", description="planet: every bore deviates by itself")
    zone: RoundZoneSpec = Field(description="how much room the drawing leaves: a diameter")
    law: LawUnion

    def references(self) -> tuple[Reference, ...]:
        """The carrier."""
        return (Reference(("of",), self.of, (CarrierSpec,)),)

    def file_names(self) -> Iterator[tuple[KeyPath, str]]:
        """Those that its law reads."""
        return ((("law", *path), name) for path, name in self.law.file_names())
