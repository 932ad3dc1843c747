"""Kinds of measure: backlashes of a mesh, lost motion of a train and its effect on a tip, transmission error."""

from abc import ABC
from collections.abc import Iterator, Mapping
from typing import Annotated, ClassVar, Final, Literal, Self

from pydantic import Discriminator, Field, Tag, model_validator

from tol3d.gearing.grammar.moves import GearMeshSpec, TrainSpec
from tol3d.gearing.grammar.parts import ArmSpec, GearSpec, ShaftReference
from tol3d.scene.bases import MOST_POSITIONS, AngleLimit, LengthLimit, MeasureSpec, MoveSpec, PartSpec, Take
from tol3d.scene.direction import At, FixedAngle, RandomOrFixed, known_word, shape
from tol3d.scene.entry import Contradiction, Reference
from tol3d.scene.name import Name
from tol3d.scene.options import StudyOptions
from tol3d.strict import refused
from tol3d.units import Dimension, Of, Quantity

FEWEST_PROFILE_STEPS: Final = 8
MOST_PROFILE_STEPS: Final = 2000


class GearStudyOptions(StudyOptions):
    """Resolution of flank measurement."""

    profile_steps: int = Field(
        default=120,
        ge=FEWEST_PROFILE_STEPS,
        le=MOST_PROFILE_STEPS,
        description="flat facets along a curved profile, for engines that measure facets",
    )


class FlankMeasureSpec(MeasureSpec, ABC):
    """A measure of one mesh, or of the meshes on the path of a train."""

    read_at: Literal["mean_section", "face_contact", "face"] | None = Field(
        default=None,
        description="where on the face: contact and gap in the section in its middle (default of bevel gears), "
        "contact over the face and the gap in that section, or both over the face (default of spur gears)",
    )
    tooth: Literal["driver", "driven", "all"] = Field(
        default="all",
        description="which teeth: all that may touch, or one tooth of the driver or of the driven gear in its space, "
        "where both of its flanks are in action",
    )


FEWEST_POSITIONS = 4

Over = Annotated[
    Annotated[Literal["random", "turn", "long_period"], Tag("word")] | FixedAngle,
    Discriminator(shape),
    known_word("random", "turn", "long_period"),
]


class MeshMeasureSpec(FlankMeasureSpec):
    """A measure that is read on a mesh."""

    applies_to: ClassVar[tuple[type[MoveSpec], ...]] = (GearMeshSpec,)

    of: Name = Field(description="the mesh move")
    over: Over = Field(
        default="random",
        description="positions of the driver: random (uniform over the long period), {at: angle}, turn (one of the "
        "driver) or long_period (until the same teeth meet again)",
    )
    take: Take = Field(default="value", description="value at one position; min, max, range or curve of several")
    positions: int = Field(
        default=24, ge=FEWEST_POSITIONS, le=MOST_POSITIONS, description="positions a turn, for turn and long_period"
    )

    @property
    def gives_curve(self) -> bool:
        """True if a trial gives a value at every position instead of one."""
        return self.take == "curve"

    @property
    def several_positions(self) -> bool:
        """True if a trial is read at several positions."""
        return self.over in ("turn", "long_period")

    @model_validator(mode="after")
    def _refuse_take_without_over(self) -> Self:
        over = "{at: …}" if isinstance(self.over, At) else self.over
        if self.several_positions and self.take == "value":
            got = "take: value" if "take" in self.model_fields_set else "no take"
            raise refused("take", f"min, max, range or curve beside over: {over}", got)
        superfluous = {"take": self.take != "value", "positions": "positions" in self.model_fields_set}
        for field, given in superfluous.items():
            if given and not self.several_positions:
                raise refused(field, "over: turn or over: long_period beside it", f"over: {over}")
        return self


class NormalBacklashSpec(MeshMeasureSpec):
    """j_bn, a length: shortest distance of the non-working flanks while the working flanks touch."""

    dimension: ClassVar[Dimension] = "length"

    kind: Literal["normal_backlash"]
    lower_limit: LengthLimit | None = Field(default=None, description="less than this is out of limits")
    upper_limit: LengthLimit | None = Field(default=None, description="more than this is out of limits")


class CircumferentialBacklashSpec(MeshMeasureSpec):
    """j_wt, a length: the free arc on the working pitch circle of the nominal centre distance."""

    dimension: ClassVar[Dimension] = "length"

    kind: Literal["circumferential_backlash"]
    lower_limit: LengthLimit | None = Field(default=None, description="less than this is out of limits")
    upper_limit: LengthLimit | None = Field(default=None, description="more than this is out of limits")


class AngularBacklashSpec(MeshMeasureSpec):
    """An angle: the free turn of one gear while its mate is held."""

    dimension: ClassVar[Dimension] = "angle"

    kind: Literal["angular_backlash"]
    gear: Name | None = Field(default=None, description="the gear that turns; default: the driven one")
    lower_limit: AngleLimit | None = Field(default=None, description="less than this is out of limits")
    upper_limit: AngleLimit | None = Field(default=None, description="more than this is out of limits")

    def references(self) -> tuple[Reference, ...]:
        """The mesh, and the gear if it is given."""
        mesh = super().references()
        return mesh if self.gear is None else (*mesh, Reference(("gear",), self.gear, (GearSpec,)))

    def contradictions(self, parts: Mapping[str, PartSpec], moves: Mapping[str, MoveSpec]) -> Iterator[Contradiction]:
        """The gear takes part in the mesh."""
        mesh = moves[self.of]
        if isinstance(mesh, GearMeshSpec) and self.gear is not None and self.gear not in mesh.gears:
            yield Contradiction(("gear",), f"a gear of the mesh {self.of!r}", repr(self.gear), mesh.gears)


class TrainMeasureSpec(FlankMeasureSpec):
    """A measure that is read on a train; by default one number per trial."""

    applies_to: ClassVar[tuple[type[MoveSpec], ...]] = (TrainSpec,)
    take: ClassVar[Take] = "value"

    of: Name = Field(description="the train")

    @property
    def gives_curve(self) -> bool:
        """True if a trial gives a value at every position instead of one."""
        return self.take == "curve"

    @property
    def several_positions(self) -> bool:
        """True if a trial is read at several positions."""
        return self.take != "value"


class LostMotionSpec(TrainMeasureSpec):
    """An angle: the free turn of a shaft while the train's held shaft stands.

    The angular backlashes of the links between the two, each at its driven shaft, over the ratios behind it.
    """

    dimension: ClassVar[Dimension] = "angle"

    kind: Literal["lost_motion"]
    shaft: Name | None = Field(default=None, description="the shaft that turns; default: the train's output")
    over: RandomOrFixed = Field(
        default="random", description="position of the train's driven shaft: random or {at: angle}"
    )
    lower_limit: AngleLimit | None = Field(default=None, description="less than this is out of limits")
    upper_limit: AngleLimit | None = Field(default=None, description="more than this is out of limits")

    def references(self) -> tuple[Reference, ...]:
        """The train, and the shaft if it is given."""
        train = super().references()
        return train if self.shaft is None else (*train, ShaftReference(("shaft",), self.shaft))


class TipMeasureSpec(TrainMeasureSpec):
    """A length at a point of an arm."""

    dimension: ClassVar[Dimension] = "length"

    arm: Name = Field(description="the arm")
    point: Name = Field(description="one of the arm's points")
    lower_limit: LengthLimit | None = Field(default=None, description="less than this is out of limits")
    upper_limit: LengthLimit | None = Field(default=None, description="more than this is out of limits")

    def references(self) -> tuple[Reference, ...]:
        """The train and the arm."""
        return (*super().references(), Reference(("arm",), self.arm, (ArmSpec,)))

    def contradictions(self, parts: Mapping[str, PartSpec], moves: Mapping[str, MoveSpec]) -> Iterator[Contradiction]:
        """The arm has the point."""
        arm = parts[self.arm]
        if isinstance(arm, ArmSpec) and self.point not in arm.points:
            yield Contradiction(("point",), f"a point of the arm {self.arm!r}", repr(self.point), tuple(arm.points))


class TipDisplacementSpec(TipMeasureSpec):
    """A length: how far the point goes from one end of the lost motion to the other."""

    kind: Literal["tip_displacement"]
    over: RandomOrFixed = Field(
        default="random", description="position of the train's driven shaft: random or {at: angle}"
    )


FEWEST_SWING_POSITIONS = 2  # start and end


class TipErrorSpec(TipMeasureSpec):
    """A curve of lengths: the error of the point at positions of the train's output, from start to end."""

    take: ClassVar[Take] = "curve"

    kind: Literal["tip_error"]
    start: Annotated[Quantity, Of("angle")] = Field(description="of the train's output, the first position")
    end: Annotated[Quantity, Of("angle")] = Field(description="of the train's output, the last position")
    positions: int = Field(
        default=25, ge=FEWEST_SWING_POSITIONS, le=MOST_POSITIONS, description="from start to end, both counted"
    )

    @model_validator(mode="after")
    def _refuse_reversed_swing(self) -> Self:
        if not self.start.internal < self.end.internal:
            raise refused("start", f"less than the end ({self.end})", self.start)
        return self


MOST_TURN_POSITIONS: Final = 32_000
"""A turn: 16 a tooth of 2000 teeth."""


class TransmissionErrorSpec(FlankMeasureSpec):
    """An angle: how far the driven gear leads its nominal position while one side of the teeth touches.

    Counted in the sense in which the working flank of the driver pushes the driven gear, 0 at the first position.
    """

    applies_to: ClassVar[tuple[type[MoveSpec], ...]] = (GearMeshSpec, TrainSpec)
    dimension: ClassVar[Dimension] = "angle"

    kind: Literal["transmission_error"]
    of: Name = Field(description="the mesh move, or the train: from its driven shaft to its output")
    flank: Literal["drive", "back"] = Field(
        default="drive", description="the driver's flanks that touch: drive, its working ones, or back, the others"
    )
    over: Literal["turn", "long_period"] = Field(
        default="long_period",
        description="positions of the driver: turn (one of it) or long_period (until the same teeth meet again)",
    )
    take: Literal["min", "max", "range", "curve"] = Field(
        default="range", description="min, max, range (peak to peak) or curve of these positions"
    )
    positions: int = Field(
        default=72,
        ge=FEWEST_POSITIONS,
        le=MOST_TURN_POSITIONS,
        description="positions a turn of the driver; at least 16 a tooth where single teeth deviate",
    )
    lower_limit: AngleLimit | None = Field(default=None, description="less than this is out of limits")
    upper_limit: AngleLimit | None = Field(default=None, description="more than this is out of limits")

    @property
    def gives_curve(self) -> bool:
        """True if a trial gives a value at every position instead of one."""
        return self.take == "curve"

    @property
    def several_positions(self) -> bool:
        """Always."""
        return True
