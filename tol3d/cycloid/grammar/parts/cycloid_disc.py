"""A cycloid disc."""

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from tol3d.scene.part import Length, PartSpec
from tol3d.units import Of, Quantity

NO_LENGTH = Quantity(0.0, "um")
NO_ANGLE = Quantity(0.0, "deg")


class CycloidDiscSpec(PartSpec):
    """A disc whose profile is the equidistant of a shortened epitrochoid, with what is ground off it for clearance."""

    words: ClassVar[str] = "a cycloid disc"

    kind: Literal["cycloid_disc"]
    lobes: int = Field(ge=3, le=400, description="number of lobes, one fewer than the pins")
    shift: Annotated[Quantity, Of("length")] = Field(
        default=NO_LENGTH,
        description="of the pin circle's radius that the profile is ground for; negative takes material off",
        json_schema_extra={"default": "0 um"},
    )
    offset: Annotated[Quantity, Of("length")] = Field(
        default=NO_LENGTH,
        description="of the pins' radius that it is ground for; positive takes material off",
        json_schema_extra={"default": "0 um"},
    )
    rotation: Annotated[Quantity, Of("angle")] = Field(
        default=NO_ANGLE,
        description="of either flank towards the middle of its lobe; positive takes material off",
        json_schema_extra={"default": "0 deg"},
    )
    width: Length | None = Field(default=None, description="of the disc: shown, and read where discs tilt")
    hole: Length | None = Field(default=None, description="diameter of the holes for the cranks, where it is shown")
