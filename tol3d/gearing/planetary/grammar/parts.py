"""Kinds of part of planetary sets."""

from collections.abc import Iterator
from typing import Annotated, ClassVar, Final, Literal, Self

from pydantic import AfterValidator, Field, model_validator

from tol3d.gearing.grammar.parts import GearSpec, PinnedSpec, TurningSpec
from tol3d.scene import Scene
from tol3d.scene.entry import Reference
from tol3d.scene.listed import listed
from tol3d.scene.name import Name
from tol3d.scene.place import KeyPath
from tol3d.strict import refused
from tol3d.units import Of, Positive, Quantity


class CarrierSpec(TurningSpec):
    """A carrier: it turns about the common axis and holds the pins of the planets."""

    words: ClassVar[str] = "a planet carrier"


def _not_negative(quantity: Quantity) -> Quantity:
    if quantity.internal < 0.0:
        raise refused("", "a length of zero or more", quantity)
    return quantity


Force = Annotated[Quantity, Of("force"), Positive()]
Stiffness = Annotated[Quantity, Of("stiffness"), Positive()]
Pair = Annotated[tuple[int, int], listed("planets", 2, 2)]


class FlexibleCarrierSpec(CarrierSpec):
    """A carrier of parts between which springs turn planets apart about the common axis.

    Of each pair the first planet is pushed counter-clockwise and the second clockwise, along the circle of the pins. A
    spring pushes as far as the meshes let it, or planets are displaced as an adjustment sets them.
    """

    words: ClassVar[str] = "a flexible planet carrier"

    kind: Literal["flexible_carrier"]
    pairs: Annotated[tuple[Pair, ...], listed("pairs")] = Field(
        description="planets that are pushed apart, such as [1, 2]; counted counter-clockwise from 1"
    )
    springs: Literal["one", "each"] = Field(
        default="one", description="one: one spring moves all pairs alike; each: every pair has its own"
    )
    adjustment: Annotated[Quantity, Of("length"), AfterValidator(_not_negative)] | None = Field(
        default=None, description="of the screw; default: the springs push as far as they can"
    )
    displacement: float = Field(
        default=1.0, gt=0.0, description="travel of each planet per unit of the adjustment, such as 0.54"
    )

    force: Force | None = Field(
        default=None,
        description="of the spring against each planet's displacement where contacts stop it; default: no torques",
    )
    stiffness: Stiffness | None = Field(default=None, description="of the spring against that displacement; 0 if none")
    friction: Force | None = Field(
        default=None, description="between the parts of the carrier, against that displacement; 0 if none"
    )

    @model_validator(mode="after")
    def _refuse_idle_forces(self) -> Self:
        given = [name for name in ("force", "stiffness", "friction") if getattr(self, name) is not None]
        if given and (self.adjustment is not None or self.springs == "each"):
            other = "an adjustment" if self.adjustment is not None else "springs: each"
            raise refused(given[0], f"none beside {other}: torques are those of one spring that presses", "one")
        if given and self.force is None:
            raise refused(given[0], "a force of the spring beside it", "none")
        if self.force is not None and self.friction is not None and self.friction.internal >= self.force.internal:
            raise refused(
                "friction", f"less than the force of {self.force}, or planets stay wherever they are", self.friction
            )
        return self

    @model_validator(mode="after")
    def _refuse_repeated_planets(self) -> Self:
        known = [planet for pair in self.pairs for planet in pair]
        if len(set(known)) < len(known):
            raise refused("pairs", "every planet once at most", known)
        return self


class PlanetSpec(PinnedSpec):
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


class PlanetCarrierSpec(CarrierSpec):
    """A rigid carrier."""

    kind: Literal["planet_carrier"]


STRONGEST: Final = 1e6  # N; a spring between planets holds hundreds


def implausible_springs(scene: Scene) -> Iterator[tuple[KeyPath, str]]:
    """Springs of flexible carriers as strong as a press."""
    for name, carrier in scene.of(FlexibleCarrierSpec).items():
        if carrier.force is not None and carrier.force.internal > STRONGEST:
            yield ("parts", name, "force"), f"expected at most 1000 kN, got {carrier.force}; check the unit"
