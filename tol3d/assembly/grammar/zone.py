"""Tolerance zones and the laws of deviations in them, as a scene names them."""

from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from tol3d.distributions import StatedDistribution
from tol3d.scene.part import Length
from tol3d.scene.vector import Direction
from tol3d.strict import Strict, refused
from tol3d.units import Of, Quantity, shown


class ZoneSpec(Strict):
    """How much room a drawing leaves: a diameter for an axis or a point, else a width."""

    diameter: Length | None = None
    width: Length | None = None
    along: Direction | None = Field(
        default=None, description="of a width for an axis or a point: the one direction in which it limits"
    )
    projected: Length | None = Field(
        default=None,
        description="of a location of an axis: the zone holds the axis over such a length beyond its end along +z, "
        "where what is screwed in stands out, instead of over the axis itself",
    )
    outward: Annotated[Quantity, Of("length")] | None = Field(
        default=None, description="how much of a profile's width lies outside the material; half if not given"
    )

    @property
    def size(self) -> float:
        """Diameter or width [mm]."""
        given = self.diameter or self.width
        return 0.0 if given is None else given.internal

    @model_validator(mode="after")
    def _refuse_contradictions(self) -> Self:
        if (self.diameter is None) == (self.width is None):
            raise refused("diameter", "either a diameter or a width", "neither" if self.width is None else "both")
        if self.along is not None and self.width is None:
            raise refused("along", "a width with it", "a diameter")
        return self


class UniformLawSpec(Strict):
    """Every point of the zone is as likely as any other."""

    kind: Literal["uniform"]


class NormalLawSpec(Strict):
    """The middle of the feature is normal, 3 sigma at half of the zone and cut off there; tilts in what it leaves."""

    kind: Literal["normal"]


class RingLawSpec(Strict):
    """The middle of an axis lies on the edge of its zone, at any phase, without lean: an eccentricity of one size."""

    kind: Literal["ring"]


class ProcessLawSpec(Strict):
    """A stated law of each coordinate; the zone judges only, and what lies outside stays in the trial."""

    kind: Literal["process"]
    distribution: StatedDistribution = Field(description="of each coordinate, a length at the end of the feature")


def _no_word(value: Any) -> Any:
    if isinstance(value, str):
        raise refused("", "a law such as {kind: uniform}", shown(value))
    return value


LawUnion = Annotated[
    UniformLawSpec | NormalLawSpec | RingLawSpec | ProcessLawSpec,
    Field(discriminator="kind", description="the law of deviations in the zone: uniform, normal, ring or process"),
    BeforeValidator(_no_word),
]
