"""Inputs of a loop, their deviations, and the poses that name them."""

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import BeforeValidator, Discriminator, Field, GetJsonSchemaHandler, Tag, model_validator
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema

from tol3d.assembly.grammar.feature_name import FeatureName
from tol3d.scene.listed import listed
from tol3d.scene.name import Name
from tol3d.scene.vector import Vector, three
from tol3d.statistics.distributions import StatedDistribution
from tol3d.strict import Strict, refused
from tol3d.units import Of, Positive, Quantity, refuse_dimension

Angle = Annotated[Quantity, Of("angle")]
Amount = Annotated[Quantity, Of("length", "angle")]
Coordinate = Literal["turn", "slide", "first", "second", "x", "y"]


class InputDeviationSpec(Strict):
    """Deviation of an input."""

    words: ClassVar[str] = "a deviation of an input"

    distribution: StatedDistribution = Field(
        description="its law: as the input is measured, or an angle of the screw or gears that drive it, by `lead`"
    )
    per: Annotated[Quantity, Of("length", "angle"), Positive()] | None = Field(
        default=None,
        description="travel to which it refers, such as 300 mm of a lead error: it grows with the travel from where "
        "parts are placed, and has the sign of that travel; default: none, the same in all poses",
    )
    description: str = Field(default="", description="the user's own words, shown in reports")

    @model_validator(mode="after")
    def _refuse_other_dimensions(self) -> Self:
        expected: tuple[Any, ...] = ("length", "angle")
        for field, quantity in self.distribution.quantities().items():
            refuse_dimension(quantity, expected, f"distribution.{field}")
            expected = (quantity.dimension,)
        return self

    @property
    def is_angle(self) -> bool:
        """True if it is an angle, not a length."""
        return any(quantity.dimension == "angle" for quantity in self.distribution.quantities().values())


class InputSpec(Strict):
    """A freedom of a joint that is given."""

    words: ClassVar[str] = "an input"

    of: Name = Field(description="the joint, such as guide 1")
    coordinate: Coordinate | None = Field(
        default=None,
        description="of a joint with several freedoms: turn or slide, first or second axis, tilt x or y",
    )
    as_placed: Amount | None = Field(
        default=None, description="its value as parts are `placed`, such as the length of a leg; default: 0"
    )
    range: Annotated[tuple[Amount, Amount], listed("limits", 2, 2)] | None = Field(
        default=None, description="ends of its travel; poses beyond are refused"
    )
    lead: Annotated[Quantity, Of("length")] | None = Field(
        default=None, description="travel of a slide per turn of its drive, for deviations that are angles"
    )
    deviations: Mapping[Name, InputDeviationSpec] = Field(default_factory=dict, description="its deviations, by name")


class OutputSpec(Strict):
    """Output that poses may name instead of inputs: the direction of an axis, or the place and turn of a feature."""

    words: ClassVar[str] = "an output"

    tilt: FeatureName | None = Field(default=None, description="feature whose z tilts, such as ring.axis")
    place: FeatureName | None = Field(default=None, description="or feature that is placed, such as platform.centre")
    from_: FeatureName = Field(alias="from", description="of a placed part: z is no tilt, azimuths count from x")

    @model_validator(mode="after")
    def _refuse_both(self) -> Self:
        if (self.tilt is None) == (self.place is None):
            raise refused("", "`tilt` or `place`, one of both", "both" if self.tilt else "none")
        return self

    @property
    def of(self) -> FeatureName:
        """The feature."""
        return self.tilt or self.place or ""


class TiltPoseSpec(Strict):
    """Pose by the direction of the output."""

    tilt: Angle = Field(description="angle by which the output leans from its z")
    azimuth: Angle = Field(description="azimuth of the direction in which it leans")


class PlacePoseSpec(Strict):
    """Pose by the place of the output, in the frame from which it is read."""

    at: Vector = Field(description="place of the output [x, y, z], in the frame from which it is read")
    turned: Annotated[tuple[Angle, Angle, Angle], three("three angles: a rotation vector")] | None = Field(
        default=None, description="a rotation vector, from the frame from which it is read; default: no turn"
    )


class PathSpec(Strict):
    """Several poses, one after the other."""

    path: Annotated[tuple[Name, ...], listed("poses", 2)] = Field(description="poses that it goes through, in order")
    steps: int = Field(ge=1, le=20_000, description="number of steps between each two of them")

    @model_validator(mode="after")
    def _refuse_few(self) -> Self:
        if self.steps < len(self.path) - 1:
            raise refused("steps", f"{len(self.path) - 1} or more, one between two poses each", self.steps)
        return self


def _form(value: Any) -> str:
    """The tag of a pose; no key may be such a word, or messages would take the tag for the key."""
    keys = set(value) if isinstance(value, Mapping) else set(getattr(type(value), "model_fields", ()))
    if "path" in keys:
        return "pose:path"
    if keys & {"tilt", "azimuth"}:
        return "pose:tilt"
    return "pose:place" if keys & {"at", "turned"} else "pose:inputs"


def _a_mapping(value: Any) -> Any:
    if isinstance(value, Mapping | Strict):
        return value
    raise refused("", "inputs such as {travel 1: 10 mm}, an output, or {path: [..], steps: 40}", value)


class _AnyOf:
    """Mark of a union whose schema is `anyOf`: a value may match two schemas although a tag separates them."""

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        found = dict(handler(schema))
        if "oneOf" in found:
            found["anyOf"] = found.pop("oneOf")
        return found


PoseSpec = Annotated[
    Annotated[PathSpec, Tag("pose:path")]
    | Annotated[TiltPoseSpec, Tag("pose:tilt")]
    | Annotated[PlacePoseSpec, Tag("pose:place")]
    | Annotated[Mapping[Name, Amount], Tag("pose:inputs")],
    Discriminator(_form),
    BeforeValidator(_a_mapping),
    _AnyOf(),
]
