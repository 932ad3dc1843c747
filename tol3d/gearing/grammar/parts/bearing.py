"""A bearing on a shaft."""

from typing import ClassVar, Literal

from pydantic import Field

from tol3d.gearing.grammar.parts.shaft_reference import ShaftReference
from tol3d.scene.name import Name
from tol3d.scene.part import PartSpec
from tol3d.scene.reference import Reference
from tol3d.scene.vector import Coordinate
from tol3d.units import Quantity


class BearingSpec(PartSpec):
    """A bearing: its clearance lets the shaft, with every gear on it, move across its axis."""

    words: ClassVar[str] = "a bearing"

    kind: Literal["bearing"]
    shaft: Name = Field(description="the shaft, or the gear that is its own")
    at: Coordinate = Field(
        default=Quantity(0.0, "mm"),
        description="its middle, along the shaft's z",
        json_schema_extra={"default": "0 mm"},
    )

    def references(self) -> tuple[Reference, ...]:
        """The shaft."""
        return (ShaftReference(("shaft",), self.shaft),)
