"""Links that turn about each other, one after the other, from a part that is placed to the last one: a robot's arm.

The largest error of place over several poses, and over the flanks on which joints may lie.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Annotated, ClassVar, Final, Literal, Self

from pydantic import Field, model_validator

from tol3d.assembly.grammar.datums import Datums, DatumSpec
from tol3d.assembly.grammar.feature_name import FeatureName, Use, part_of
from tol3d.assembly.grammar.moves import AssemblyMoveSpec
from tol3d.assembly.grammar.parts import SolidSpec
from tol3d.assembly.model import Acts
from tol3d.gearing.grammar.moves import TrainSpec
from tol3d.scene.bases import LengthLimit, MeasureEntry
from tol3d.scene.entry import Reference
from tol3d.scene.listed import listed
from tol3d.scene.name import Name
from tol3d.scene.place import KeyPath
from tol3d.scene.vector import Direction, Vector
from tol3d.strict import Strict, refused
from tol3d.units import Dimension, Of, Quantity

AXES: Final = ("axis", "cylinder")
FLANK: Final = "flank"
"""The kind of such a contributor."""
Angle = Annotated[Quantity, Of("angle")]


def turn_name(move: str, joint: str) -> str:
    """Name of the hidden contributor of a joint's turn beyond its input; scenes cannot use such a name."""
    return f".{move}.{joint} turn"


def flank_name(joint: str) -> str:
    """The contributor of the side of its play on which a joint lies that nothing loads."""
    return f"flank of {joint}"


class RevoluteSpec(Strict):
    """Two links on one axis, which turn about it as a train does."""

    words: ClassVar[str] = "a joint"

    kind: Literal["revolute"] = "revolute"
    between: Annotated[tuple[FeatureName, ...], listed("axes", 2, 2)] = Field(
        description="the axis of the link before, such as base.bore, and that of the link after, such as link 1.pilot; "
        "as the parts are `placed` they are one line, and the input is 0"
    )
    seat: Datums | None = Field(
        default=None,
        description="datums of the link after by which it lies on the joint, such as [flange, pilot]; default: "
        "the axis",
    )
    train: Name | None = Field(
        default=None, description="the train whose output turns the link after; none: it has no play"
    )


class MassSpec(Strict):
    """A mass on a link."""

    words: ClassVar[str] = "a mass"

    of: Name = Field(description="the link")
    mass: Annotated[Quantity, Of("mass")] = Field(description="such as 30 kg")
    at: Vector = Field(description="its place, in the frame of that part")


class OpenChainSpec(AssemblyMoveSpec):
    """Links in series, each turned against the one before by its input and, in its play, by its load.

    A joint that gravity loads lies at that end of its play to which its torque turns it; one that nothing loads lies at
    either end, by a draw of its own. The middle of the play is at the input.
    """

    words: ClassVar[str] = "a chain of links"
    acts: ClassVar[Acts] = Acts(
        "together", "carried by", "tol3d.gearing.machine.chain:turning", "tol3d.gearing.machine.chain:displaced"
    )
    stated_by: ClassVar[str] = "tol3d.gearing.machine.open_chains:chain_of"
    drawn_by: ClassVar[str] = "tol3d.gearing.machine.open_chains:contributors_of"

    kind: Literal["open_chain"]
    joints: Mapping[Name, RevoluteSpec] = Field(min_length=1, description="from the placed part on, in order")
    poses: Mapping[Name, Mapping[Name, Angle]] = Field(
        min_length=1, description="by name, the input of every joint; measures are read `at` one of them"
    )
    gravity: Direction | None = Field(default=None, description="its direction in the world; none loads no joint")
    masses: Annotated[tuple[MassSpec, ...], listed("masses", 0, 100)] = Field(
        default=(), description="masses that it pulls at; a payload belongs to the last link"
    )

    @property
    def links(self) -> Sequence[str]:
        """The parts that are placed, in order."""
        return [part_of(joint.between[1]) for joint in self.joints.values()]

    @property
    def parts_placed(self) -> Sequence[tuple[KeyPath, str]]:
        return [(("joints", name, "between", 1), part_of(own.between[1])) for name, own in self.joints.items()]

    def targets(self) -> Iterator[tuple[KeyPath, FeatureName]]:
        return ((("joints", name, "between", 0), own.between[0]) for name, own in self.joints.items())

    @property
    def seats(self) -> Sequence[tuple[str, Sequence[DatumSpec]]]:
        return [(part_of(joint.between[1]), joint.seat) for joint in self.joints.values() if joint.seat]

    @property
    def pose_names(self) -> Sequence[str]:
        return tuple(self.poses)

    def references(self) -> tuple[Reference, ...]:
        """Links, trains, and loaded parts."""
        found = []
        for name, joint in self.joints.items():
            for k, feature in enumerate(joint.between):
                found.append(Reference(("joints", name, "between", k), part_of(feature), (SolidSpec,)))
            if joint.train is not None:
                found.append(Reference(("joints", name, "train"), joint.train, (TrainSpec,)))
        found += [Reference(("masses", k, "of"), own.of, (SolidSpec,)) for k, own in enumerate(self.masses)]
        return tuple(found)

    def uses(self) -> Iterator[Use]:
        """The axes, and the datums of seats."""
        for name, joint in self.joints.items():
            for k, feature in enumerate(joint.between):
                yield Use(("joints", name, "between", k), feature, AXES)
            for k, datum in enumerate(joint.seat or ()):
                for own in datum.features:
                    path = ("joints", name, "seat", k)
                    yield Use(path, f"{part_of(joint.between[1])}.{own}", datum.kinds)

    @model_validator(mode="after")
    def _refuse_contradictions(self) -> Self:
        if len(set(self.links)) < len(self.links):
            twice = next(link for k, link in enumerate(self.links) if link in self.links[:k])
            raise refused("joints", "another link after each joint", f"{twice!r} after two")
        for k, (name, own) in enumerate(self.joints.items()):
            if (before := part_of(own.between[0])) in self.links[k:]:
                raise refused(f"joints.{name}.between", "a link that joints before it have placed", repr(before))
        for pose, inputs in self.poses.items():
            lacking = [joint for joint in self.joints if joint not in inputs]
            if lacking:
                raise refused(
                    f"poses.{pose}",
                    f"an input of each of the {len(self.joints)} joints",
                    f"none of {', '.join(map(repr, lacking))}",
                )
            for joint in inputs:
                if joint not in self.joints:
                    raise refused(f"poses.{pose}.{joint}", f"a joint of {', '.join(self.joints)}", repr(joint))
        for k, mass in enumerate(self.masses):
            if mass.of not in self.links:
                raise refused(f"masses.{k}.of", f"a link of the chain: {', '.join(self.links)}", repr(mass.of))
        if self.masses and self.gravity is None:
            raise refused("gravity", "its direction beside masses, such as [0, 0, -1]", "none")
        return self


class WorstPositionErrorSpec(MeasureEntry):
    """The size of a position error in the pose of the trial in which it is largest."""

    words: ClassVar[str] = "a worst error of place"
    dimension: ClassVar[Dimension] = "length"
    gives_curve: ClassVar[bool] = False
    several_positions: ClassVar[bool] = False

    kind: Literal["worst_position_error"]
    of: FeatureName = Field(description="the feature, such as link 6.flange")
    from_: Name = Field(alias="from", description="the part that sees it, such as base")
    poses: Annotated[tuple[Name, ...], listed("poses")] | None = Field(
        default=None, description="over which; default: all that the scene's moves have"
    )
    flanks: Literal["loaded", "any"] = Field(
        default="loaded",
        description="loaded: each joint on the flank on which gravity lays it; any: on those that make it largest",
    )
    lower_limit: LengthLimit | None = Field(default=None, description="less than this is out of limits")
    upper_limit: LengthLimit | None = Field(default=None, description="more than this is out of limits")

    def references(self) -> tuple[Reference, ...]:
        """Both parts."""
        return (
            Reference(("of",), part_of(self.of), (SolidSpec,)),
            Reference(("from",), self.from_, (SolidSpec,)),
        )

    def uses(self) -> Iterator[Use]:
        """The feature."""
        yield Use(("of",), self.of)
