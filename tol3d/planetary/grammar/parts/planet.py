"""A planet: gears that turn as one on a pin of the carrier."""

from typing import Annotated, ClassVar, Literal, Self

from pydantic import Field, model_validator

from tol3d.gearing.grammar.parts.gear import GearSpec
from tol3d.scene.listed import listed
from tol3d.scene.name import Name
from tol3d.scene.part import PartSpec
from tol3d.scene.reference import Reference
from tol3d.strict import refused


class PlanetSpec(PartSpec):
    """A planet with one gear, or a compound one with several; tooth 0 of all of them points outwards.

    A set has several alike. A tolerance of one of these gears is a deviation that each planet has of its own.
    """

    words: ClassVar[str] = "a planet"

    kind: Literal["planet"]
    gears: Annotated[tuple[Name, ...], listed("gears")] = Field(description="the gears that it is made of")

    @model_validator(mode="after")
    def _refuse_repeated_gears(self) -> Self:
        if len(set(self.gears)) < len(self.gears):
            raise refused("gears", "every gear once", list(self.gears))
        return self

    def references(self) -> tuple[Reference, ...]:
        """The gears."""
        return tuple(Reference(("gears", k), name, (GearSpec,)) for k, name in enumerate(self.gears))
