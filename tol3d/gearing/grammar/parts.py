"""Kinds of part: gears, shafts, bearings, arms, housings."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal, Self

from pydantic import AfterValidator, Field, model_validator

from tol3d.gearing.raceways import DeepGroove, ObliqueContact, Raceways
from tol3d.gears.flank import LEFT_HAND, RIGHT_HAND, Hand
from tol3d.scene.bases import GrowingSpec, Length, PartSpec
from tol3d.scene.entry import Entry, Reference, Unusable
from tol3d.scene.name import Name
from tol3d.scene.vector import Coordinate, Vector
from tol3d.strict import Strict, refused
from tol3d.units import Of, Positive, Quantity


class TurningSpec(PartSpec):
    """A part with an axis of its own, about which it turns or is held: a gear, or that of another mechanism."""

    words: ClassVar[str] = "a gear"


class PinnedSpec(PartSpec):
    """A part that turns on a pin of another one, and slides along it: a planet."""


MOST_TEETH = 10_000  # far more than anyone hobs; a typing error would build for days

LEAST_FACE_WIDTH = 1e-6  # mm; a solid ten times thinner has no two sides for the CAD kernel


def _wide_enough(width: Quantity) -> Quantity:
    if width.internal < LEAST_FACE_WIDTH:
        raise refused("", f"at least {LEAST_FACE_WIDTH:g} mm", repr(str(width)))
    return width


class GearSpec(TurningSpec):
    """A gear by the words of ISO 21771-1; profile_shift, addendum and dedendum count in modules."""

    words: ClassVar[str] = "a gear"

    teeth: int = Field(ge=1, le=MOST_TEETH, description="number of teeth z")
    module: Length = Field(
        description="module m; of a helical gear the normal module m_n, of a bevel gear that at the outer end"
    )
    pressure_angle: Annotated[Quantity, Of("angle"), Positive()] = Field(
        default=Quantity(20.0, "deg"),
        description="pressure angle at the reference circle, of a helical gear in the normal section, or on the pitch "
        "cone",
        json_schema_extra={"default": "20 deg"},  # pydantic would show the Quantity's fields
    )
    face_width: Annotated[Length, AfterValidator(_wide_enough)] = Field(description="face width b")
    profile_shift: float = Field(default=0.0, description="profile shift coefficient x; positive is a thicker tooth")
    addendum: float = Field(default=1.0, gt=0.0, description="addendum factor, in modules")
    dedendum: float = Field(default=1.25, gt=0.0, description="dedendum factor, in modules")


class BoredGearSpec(GearSpec):
    """A gear that sits around its shaft."""

    bore: Length | None = Field(default=None, description="diameter of the bore; default: none")


class ExternalGearSpec(BoredGearSpec, GrowingSpec):
    """A cylindrical gear with teeth on its outside."""

    root_fillet: Length | None = Field(
        default=None, description="radius between flank and root circle; default: 0.38 m (ISO 53) or the full round"
    )


class SpurGearSpec(ExternalGearSpec):
    """A spur gear; its tooth thickness is an arc at the reference circle."""

    words: ClassVar[str] = "a spur gear"

    kind: Literal["spur_gear"]


def _not_negative(angle: Quantity) -> Quantity:
    if angle.number < 0.0:
        raise refused("", "an angle of zero or more (hand gives the sense of the helix)", repr(str(angle)))
    return angle


HelixAngle = Annotated[Quantity, Of("angle"), AfterValidator(_not_negative)]


class HelicalGearSpec(ExternalGearSpec):
    """A helical gear on a parallel axis: module, pressure angle and tooth thickness are those of the normal section.

    Profile shift, addendum and dedendum count in normal modules. Its mate has the same helix angle and the other hand,
    a ring around it the same hand.
    """

    words: ClassVar[str] = "a helical gear"

    kind: Literal["helical_gear"]
    helix_angle: HelixAngle = Field(description="helix angle beta at the reference cylinder; 0 deg is a spur gear")
    hand: Literal["right", "left"] = Field(
        description="of the helix: seen from outside, the axis upright, right-hand teeth lean to the right"
    )


class InternalGearSpec(GearSpec, GrowingSpec):
    """A ring with teeth on its inside; a tooth points inwards, its thickness is an arc at the reference circle.

    As for every gear a positive profile shift is a thicker tooth, here with its tip further in (ISO 21771). With a
    helix angle and a hand it is a helical gear; the gears in it have the same.
    """

    words: ClassVar[str] = "an internal gear"

    kind: Literal["internal_gear"]
    helix_angle: HelixAngle = Field(
        default=Quantity(0.0, "deg"),
        description="helix angle beta at the reference cylinder; default: 0 deg, a spur gear",
        json_schema_extra={"default": "0 deg"},
    )
    hand: Literal["right", "left"] | None = Field(
        default=None, description="of the helix, as of a helical gear; given with a helix_angle"
    )
    root_fillet: Length | None = Field(
        default=None, description="radius between flank and root circle; default: 0.38 m (ISO 53) or the full round"
    )
    outer_diameter: Length | None = Field(
        default=None, description="of the ring; default: that of the root circle and 5 modules"
    )

    @model_validator(mode="after")
    def _refuse_no_hand(self) -> Self:
        if self.helix_angle.number and self.hand is None:
            raise refused("hand", f"right or left beside a helix_angle of {self.helix_angle}", "none")
        return self


def helix_of(spec: PartSpec) -> tuple[float, Hand]:
    """Helix angle [rad] and hand of a gear; 0 of all but helical ones."""
    if isinstance(spec, HelicalGearSpec | InternalGearSpec):
        return spec.helix_angle.internal, LEFT_HAND if spec.hand == "left" else RIGHT_HAND
    return 0.0, RIGHT_HAND


class BevelGearSpec(BoredGearSpec):
    """A straight bevel gear by the words of ISO 23509; its depth and thickness taper towards the apex."""

    words: ClassVar[str] = "a bevel gear"

    kind: Literal["bevel_gear"]
    pitch_angle: Annotated[Quantity, Of("angle"), Positive()] | None = Field(
        default=None, description="of the pitch cone; default: follows from the teeth and the shaft angle"
    )


class CarriedSpec(Strict):
    """Seat of a gear on its shaft."""

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
    """Rigid shaft with the gears on it; diameter, start and end are for pictures and CAD only."""

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
    """The gears that turn with a shaft: those that it carries, or itself if it is a gear."""
    part = parts[shaft]
    return tuple(part.carries) if isinstance(part, ShaftSpec) else (shaft,)


def carried(parts: Mapping[str, PartSpec]) -> Iterator[tuple[str, str]]:
    """Every shaft with every gear that it carries."""
    for name, part in parts.items():
        if isinstance(part, ShaftSpec):
            yield from ((name, gear) for gear in part.carries)


@dataclass(frozen=True)
class ShaftReference(Reference):
    """The name of a shaft, or of a gear that is its own because none carries it."""

    specs: tuple[type[Entry], ...] = (ShaftSpec, TurningSpec)

    @property
    def expected(self) -> str:
        """As of any reference."""
        return "a shaft, or of a gear that none carries"

    @classmethod
    def unusable(cls, parts: Mapping[str, PartSpec]) -> Mapping[str, Unusable]:
        """Gears that a shaft carries."""
        return {gear: Unusable(f"which {shaft!r} carries", shaft) for shaft, gear in carried(parts)}


def _oblique(angle: Quantity) -> Quantity:
    if not 0.0 < angle.internal < math.pi / 2:
        raise refused("", "an angle between 0 and 90 deg", repr(str(angle)))
    return angle


class GroovesSpec(Strict):
    """Balls in deep grooves, which touch both of them before the shaft has slid far."""

    ball: Length = Field(description="diameter D_w of the balls")
    radii: float = Field(
        gt=1.0,
        lt=2.0,
        description="radii of both grooves together over the balls' diameter, such as 1.04: 0.52 D_w each",
    )


class BearingSpec(PartSpec):
    """A bearing: its clearance lets the shaft, with every gear on it, move across its axis.

    One with a contact_angle, or grooves, holds the shaft along its axis too, with the same clearance.
    """

    words: ClassVar[str] = "a bearing"

    kind: Literal["bearing"]
    shaft: Name = Field(description="the shaft, or the gear that is its own")
    at: Coordinate = Field(
        default=Quantity(0.0, "mm"),
        description="its middle, along the shaft's z",
        json_schema_extra={"default": "0 mm"},
    )
    contact_angle: Annotated[Quantity, Of("angle"), AfterValidator(_oblique)] | None = Field(
        default=None, description="of angular contact balls or tapered rollers, against a plane across the axis"
    )
    grooves: GroovesSpec | None = Field(default=None, description="of deep groove balls")

    @model_validator(mode="after")
    def _refuse_both(self) -> Self:
        if self.contact_angle is not None and self.grooves is not None:
            raise refused("grooves", "contact_angle or grooves", "both")
        return self

    @property
    def raceways(self) -> Raceways | None:
        """How its clearance shows along the axis; None where that is not known."""
        if self.contact_angle is not None:
            return ObliqueContact(self.contact_angle.internal)
        if self.grooves is not None:
            return DeepGroove((self.grooves.radii - 1.0) * self.grooves.ball.internal)
        return None

    def references(self) -> tuple[Reference, ...]:
        """The shaft."""
        return (ShaftReference(("shaft",), self.shaft),)


class ArmSpec(PartSpec):
    """An arm: it turns with its shaft, and defines points for measures."""

    words: ClassVar[str] = "an arm"

    kind: Literal["arm"]
    shaft: Name = Field(description="the shaft, or the gear that is its own")
    points: Mapping[Name, Vector] = Field(
        min_length=1, description="[x, y, z] in the frame of the shaft, the train's first shaft at 0 deg"
    )
    centre_of_mass: Vector | None = Field(
        default=None, description="[x, y, z] in that frame, where gravity pulls; default: the last point"
    )
    diameter: Length | None = Field(default=None, description="of its tube; for pictures and CAD only")

    def references(self) -> tuple[Reference, ...]:
        """The shaft."""
        return (ShaftReference(("shaft",), self.shaft),)


class HousingSpec(GrowingSpec):
    """A housing: its expansion changes the centre distance of the meshes that name it."""

    words: ClassVar[str] = "a housing"

    kind: Literal["housing"]
