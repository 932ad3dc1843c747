"""A robot's arm, at the end of a train."""

from collections.abc import Mapping
from typing import ClassVar, Literal

from pydantic import Field

from tol3d.gearing.grammar.parts.shaft_reference import ShaftReference
from tol3d.scene.name import Name
from tol3d.scene.part import Length, PartSpec
from tol3d.scene.reference import Reference
from tol3d.scene.vector import Vector


class ArmSpec(PartSpec):
    """An arm: it turns with its shaft, and says where the points are that measures ask for."""

    words: ClassVar[str] = "an arm"

    kind: Literal["arm"]
    shaft: Name = Field(description="the shaft, or the gear that is its own")
    points: Mapping[Name, Vector] = Field(
        min_length=1, description="[x, y, z] in the frame of the shaft, the train's first shaft at 0 deg"
    )
    centre_of_mass: Vector | None = Field(
        default=None, description="[x, y, z] in that frame, where gravity pulls; the last point if not given"
    )
    diameter: Length | None = Field(default=None, description="of its tube; for pictures and CAD only")

    def references(self) -> tuple[Reference, ...]:
        """The shaft."""
        return (ShaftReference(("shaft",), self.shaft),)
