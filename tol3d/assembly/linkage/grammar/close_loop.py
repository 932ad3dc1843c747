"""Bodies that joints hold together in closed loops, and that are placed at once."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Annotated, ClassVar, Final, Literal, Self

from pydantic import Field, model_validator
from typing_extensions import override

from tol3d.assembly.grammar.feature_name import FeatureName, Use, part_of
from tol3d.assembly.grammar.moves import AssemblyMoveSpec
from tol3d.assembly.grammar.parts import SolidSpec
from tol3d.assembly.linkage.grammar.inputs import InputSpec, OutputSpec, PathSpec, PlacePoseSpec, PoseSpec, TiltPoseSpec
from tol3d.assembly.linkage.grammar.joints import JointUnion, Length, RollingSpec
from tol3d.assembly.model import Acts
from tol3d.scene.entry import Reference
from tol3d.scene.listed import listed
from tol3d.scene.name import Name
from tol3d.scene.nearest import hint
from tol3d.scene.place import KeyPath
from tol3d.strict import refused
from tol3d.units import Quantity, refuse_dimension

STEP: Final = "|"
"""Between a path and the number of a position on it; names have none."""

COORDINATES: Final[Mapping[str, tuple[str, ...]]] = {
    "revolute": ("turn",),
    "prismatic": ("slide",),
    "cylindrical": ("turn", "slide"),
    "universal": ("first", "second"),
    "swing": ("x", "y"),
    "screw": ("turn",),
    "ball": (),
    "rolling": (),
}
"""Coordinates of a joint that may be inputs."""


class CloseLoopSpec(AssemblyMoveSpec):
    """Bodies between placed ones, held by joints and moved by inputs.

    The branch is that in which the parts are `placed`. A freedom that moves no joint, such as the spin of a rod between
    two balls, stays as it is.
    """

    words: ClassVar[str] = "a closed loop"
    acts: ClassVar[Acts] = Acts(
        "together",
        "carried by",
        "tol3d.assembly.linkage.loop:closing",
        "tol3d.assembly.linkage.loop:displaced",
        presents="tol3d.assembly.linkage.presenting.tables:loop_blocks",
        workspace="tol3d.assembly.linkage.presenting.workspace_picture:workspace_map",
        closes_loops=True,
    )
    stated_by: ClassVar[str] = "tol3d.assembly.linkage.from_scene:loop_of"
    drawn_by: ClassVar[str] = "tol3d.assembly.linkage.from_scene:contributors_of"

    kind: Literal["close_loop"]
    bodies: Annotated[tuple[Name, ...], listed("bodies")] = Field(description="the parts that it places")
    joints: Mapping[Name, JointUnion] = Field(min_length=1, description="by name: between them, and to placed parts")
    inputs: Mapping[Name, InputSpec] = Field(default_factory=dict, description="by name: freedoms that are given")
    output: OutputSpec | None = Field(default=None, description="output that poses may name instead of inputs")
    poses: Mapping[Name, PoseSpec] = Field(
        default_factory=dict, description="by name: inputs, or the output, or a path; as parts are `placed` if none"
    )
    scale: Length | None = Field(
        default=None, description="length by which angles are lengths where poses are judged singular; the loop's own"
    )

    @property
    @override
    def parts_placed(self) -> Sequence[tuple[KeyPath, str]]:
        return [(("bodies", k), body) for k, body in enumerate(self.bodies)]

    @override
    def targets(self) -> Iterator[tuple[KeyPath, FeatureName]]:
        yield from self._named()

    @property
    @override
    def pose_names(self) -> Sequence[str]:
        return tuple(name for name, own in self.poses.items() if not isinstance(own, PathSpec))

    @property
    @override
    def path_names(self) -> Mapping[str, Sequence[str]]:
        paths = ((name, own) for name, own in self.poses.items() if isinstance(own, PathSpec))
        return {name: [f"{name}{STEP}{k}" for k in range(own.steps + 1)] for name, own in paths}

    def _named(self) -> Iterator[tuple[KeyPath, FeatureName]]:
        for name, joint in self.joints.items():
            yield from ((("joints", name, *path), feature) for path, feature in joint.features)

    def references(self) -> tuple[Reference, ...]:
        """The bodies, and the parts of all features."""
        found = [Reference(("bodies", k), body, (SolidSpec,)) for k, body in enumerate(self.bodies)]
        found += [Reference(path, part_of(feature), (SolidSpec,)) for path, feature in self._named()]
        for name, joint in self.joints.items():
            if isinstance(joint, RollingSpec) and "." not in joint.carrier:
                found.append(Reference(("joints", name, "carrier"), joint.carrier, (SolidSpec,)))
        if self.output is not None:
            key = "tilt" if self.output.tilt else "place"
            found.append(Reference(("output", key), part_of(self.output.of), (SolidSpec,)))
            found.append(Reference(("output", "from"), part_of(self.output.from_), (SolidSpec,)))
        return tuple(found)

    def uses(self) -> Iterator[Use]:
        """All features."""
        for name, joint in self.joints.items():
            for path, feature in joint.features:
                kinds = joint.feature_kinds if path[0] == "between" else ()
                yield Use(("joints", name, *path), feature, kinds)
        if self.output is not None:
            yield Use(("output", "tilt" if self.output.tilt else "place"), self.output.of)
            yield Use(("output", "from"), self.output.from_)

    def file_names(self) -> Iterator[tuple[KeyPath, str]]:
        """Files that laws read."""
        yield from super().file_names()
        for name, own in self.inputs.items():
            for key, each in own.deviations.items():
                path = ("inputs", name, "deviations", key, "distribution")
                yield from (((*path, field), file) for field, file in each.distribution.file_names())
        for name, joint in self.joints.items():
            law = joint.room.distribution if joint.room is not None else None
            if law is not None:
                room = ("joints", name, "clearance" if joint.kind == "ball" else "play", "distribution")
                yield from (((*room, field), file) for field, file in law.file_names())

    @model_validator(mode="after")
    def _refuse_contradictions(self) -> Self:
        if len(set(self.bodies)) < len(self.bodies):
            twice = next(body for k, body in enumerate(self.bodies) if body in self.bodies[:k])
            raise refused("bodies", "each body once", f"{twice!r} twice")
        pairs: dict[frozenset[str], str] = {}
        for name, joint in self.joints.items():
            ends = [part_of(feature) for feature in joint.between]
            if not set(ends) & set(self.bodies):
                words = f"a feature of one of the bodies {', '.join(self.bodies)}"
                raise refused(f"joints.{name}.between", words, " and ".join(joint.between))
            if other := pairs.get(frozenset(joint.between)):
                words = f"features that no other joint is between, for {other!r} is"
                raise refused(f"joints.{name}.between", words, " and ".join(joint.between))
            pairs[frozenset(joint.between)] = name
        for body in self.bodies:
            if not any(part_of(feature) == body for joint in self.joints.values() for feature in joint.between):
                raise refused("joints", f"a joint that holds {body!r}", "none")
        self._refuse_unfit_inputs()
        self._refuse_unfit_poses()
        return self

    def _refuse_unfit_inputs(self) -> None:
        taken: dict[tuple[str, str], str] = {}
        for name, own in self.inputs.items():
            if own.of not in self.joints:
                got = f"{own.of!r}{hint(own.of, self.joints)}"
                raise refused(f"inputs.{name}.of", f"a joint of {', '.join(self.joints)}", got)
            joint = self.joints[own.of]
            words = COORDINATES[joint.kind]
            if not words:
                raise refused(
                    f"inputs.{name}.of", "a joint with an axis, or a swing", f"{own.of!r}, a {joint.kind} one"
                )
            if own.coordinate is None and len(words) > 1:
                raise refused(f"inputs.{name}.coordinate", f"{' or '.join(words)}, of a {joint.kind} joint", "none")
            if own.coordinate is not None and own.coordinate not in words:
                raise refused(f"inputs.{name}.coordinate", " or ".join(words), own.coordinate)
            which = own.of, self.coordinate_of(name)
            if which in taken:
                raise refused(f"inputs.{name}.of", f"a freedom that {taken[which]!r} does not give", repr(own.of))
            taken[which] = name
            dimension = self.dimension_of(name)
            if own.as_placed is not None:
                refuse_dimension(own.as_placed, (dimension,), f"inputs.{name}.as_placed")
            for limit in own.range or ():
                if limit.dimension != dimension:
                    raise refused(f"inputs.{name}.range", f"two {dimension}s", str(limit))
            if own.range is not None and not own.range[0].internal < own.range[1].internal:
                raise refused(f"inputs.{name}.range", "the lower limit first", f"{own.range[0]}, {own.range[1]}")
            for key, each in own.deviations.items():
                at = f"inputs.{name}.deviations.{key}"
                if each.per is not None:
                    refuse_dimension(each.per, (dimension,), f"{at}.per")
                if each.is_angle and dimension == "length" and own.lead is None:
                    raise refused(f"{at}.distribution", "lengths, or the `lead` of the input beside angles", "angles")
                if not each.is_angle and dimension == "angle":
                    raise refused(f"{at}.distribution", "angles, as the input is", "lengths")

    def coordinate_of(self, name: str) -> str:
        """Freedom of its joint that is an input."""
        own = self.inputs[name]
        return own.coordinate or COORDINATES[self.joints[own.of].kind][0]

    def dimension_of(self, name: str) -> Literal["length", "angle"]:
        """Dimension of an input."""
        return "length" if self.coordinate_of(name) == "slide" else "angle"

    def _refuse_unfit_poses(self) -> None:
        for name, pose in self.poses.items():
            at = f"poses.{name}"
            if isinstance(pose, PathSpec):
                for own in pose.path:
                    if own not in self.pose_names:
                        got = f"{own!r}{hint(own, self.pose_names)}"
                        raise refused(f"{at}.path", f"poses of {', '.join(self.pose_names)}", got)
            elif isinstance(pose, TiltPoseSpec):
                if self.output is None or self.output.tilt is None:
                    raise refused(at, "inputs, for the move has no `output: {tilt: …}`", "a tilt")
            elif isinstance(pose, PlacePoseSpec):
                if self.output is None or self.output.place is None:
                    raise refused(at, "inputs, for the move has no `output: {place: …}`", "a place")
            else:
                self._refuse_unfit_values(at, pose)

    def _refuse_unfit_values(self, at: str, pose: Mapping[str, Quantity]) -> None:
        lacking = [own for own in self.inputs if own not in pose]
        for own in pose:
            if own not in self.inputs:
                got = f"{own!r}{hint(own, self.inputs)}"
                raise refused(f"{at}.{own}", f"an input: {', '.join(self.inputs) or 'none'}", got)
        if lacking:
            words = f"a value of each of the {len(self.inputs)} inputs"
            raise refused(at, words, f"none of {', '.join(map(repr, lacking))}")
        for own, value in pose.items():
            refuse_dimension(value, (self.dimension_of(own),), f"{at}.{own}")
