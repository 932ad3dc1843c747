"""Kinds of part of RV reducers."""

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from tol3d.gearing.grammar.parts import TurningSpec
from tol3d.scene.bases import Length, PartSpec
from tol3d.units import Of, Quantity


class CrankCarrierSpec(TurningSpec):
    """A carrier: it turns about the common axis in its main bearing and holds the crankshafts; it is the output."""

    words: ClassVar[str] = "a carrier of crankshafts"

    kind: Literal["crank_carrier"]
    radius: Length = Field(description="of the circle of the crankshafts' axes")


class CrankshaftSpec(TurningSpec):
    """A crankshaft with an eccentric for each disc, evenly around; an RV reducer has several alike."""

    words: ClassVar[str] = "a crankshaft"

    kind: Literal["crankshaft"]
    eccentricity: Length = Field(description="of the eccentrics")


NO_LENGTH = Quantity(0.0, "um")
NO_ANGLE = Quantity(0.0, "deg")


class CycloidDiscSpec(PartSpec):
    """A disc whose profile is the equidistant of a shortened epitrochoid, with its modification for clearance."""

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


class PinRingSpec(TurningSpec):
    """Pins, evenly spaced on a circle of the housing, among which cycloid discs run."""

    words: ClassVar[str] = "a pin ring"

    kind: Literal["pin_ring"]
    pins: int = Field(ge=4, le=401, description="number of pins")
    radius: Length = Field(description="of the circle of the pins' axes")
    pin_radius: Length = Field(description="of the pins")
