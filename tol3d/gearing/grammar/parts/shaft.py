"""A shaft and the gears on it."""

from collections.abc import Iterator, Mapping
from typing import Annotated, ClassVar, Literal, Self

from pydantic import Field, model_validator

from tol3d.gearing.grammar.parts.turning import TurningSpec
from tol3d.scene.name import Name
from tol3d.scene.part import Length, PartSpec
from tol3d.scene.reference import Reference
from tol3d.scene.vector import Coordinate
from tol3d.strict import Strict, refused
from tol3d.units import Of, Quantity


class CarriedSpec(Strict):
    """How a gear sits on its shaft."""

    at: Coordinate = Field(
        default=Quantity(0.0, "mm"),
        description="where the origin of the gear's frame lies along the shaft's z: the middle of a spur gear's face, "
        "the apex of a bevel gear",
        json_schema_extra={"default": "0 mm"},
    )
    facing: Literal["forward", "backward"] = Field(
        default="forward", description="whether the gear's z goes with the shaft's or against it"
    )
    phase: Annotated[Quantity, Of("angle")] = Field(
        default=Quantity(0.0, "deg"),
        description="azimuth of the gear's tooth 0 on the shaft",
        json_schema_extra={"default": "0 deg"},
    )


class ShaftSpec(PartSpec):
    """What turns as one, with every gear on it; diameter, start and end are for pictures and CAD only."""

    words: ClassVar[str] = "a shaft"

    kind: Literal["shaft"]
    carries: Mapping[Name, CarriedSpec] = Field(
        default_factory=dict, description="gears that turn with it, and how they sit; a gear is on one shaft at most"
    )
    diameter: Length | None = Field(default=None, description="of the shaft itself")
    start: Coordinate | None = Field(default=None, description="one end of it, along its z")
    end: Coordinate | None = Field(default=None, description="the other end, along its z")

    @model_validator(mode="after")
    def _refuse_reversed_ends(self) -> Self:
        if self.start is not None and self.end is not None and not self.start.internal < self.end.internal:
            raise refused("start", f"less than the end ({self.end})", self.start)
        return self

    def references(self) -> tuple[Reference, ...]:
        """The gears that it carries."""
        return tuple(Reference(("carries", gear), gear, (TurningSpec,)) for gear in self.carries)


def gears_on(shaft: str, parts: Mapping[str, PartSpec]) -> tuple[str, ...]:
    """The gears that turn with a shaft: those that it carries, or itself where it is a gear."""
    part = parts[shaft]
    return tuple(part.carries) if isinstance(part, ShaftSpec) else (shaft,)


def carried(parts: Mapping[str, PartSpec]) -> Iterator[tuple[str, str]]:
    """Every shaft with every gear that it carries."""
    for name, part in parts.items():
        if isinstance(part, ShaftSpec):
            yield from ((name, gear) for gear in part.carries)
