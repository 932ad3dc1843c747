"""Zones for location, orientation and form of a feature; run-outs are about an axis."""

from collections.abc import Iterator
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import BeforeValidator, Field, model_validator
from typing_extensions import override

from tol3d.assembly.grammar.datums import Datums, DatumSpec
from tol3d.assembly.grammar.feature_name import FeatureName, Use, part_of
from tol3d.assembly.grammar.features.feature_spec import AXES, ROUND
from tol3d.assembly.grammar.tolerances.feature_tolerance import FeatureTolerance, Modified
from tol3d.assembly.grammar.zone import LawUnion, ProcessLawSpec, RingLawSpec, ZoneSpec, scaled_in_zone
from tol3d.files import Files
from tol3d.scene.bases import Length
from tol3d.scene.listed import listed
from tol3d.scene.place import KeyPath
from tol3d.statistics.distributions.base import Stays
from tol3d.strict import Strict, refused


class SegmentSpec(Strict):
    """The lower segment of a composite tolerance: how the features of a pattern lie to each other.

    It limits their places relative to each other, and their orientation by its datums; the upper one locates the
    pattern.
    """

    zone: ZoneSpec = Field(description="of the shape of the upper one, and narrower")
    datums: Datums | None = Field(
        default=None, description="the first ones of the upper segment, which orient the pattern; it may turn without"
    )


class LocationSpec(FeatureTolerance):
    """A zone for where a feature lies; zones of orientation and form of the same feature refine it."""

    zone: ZoneSpec = Field(description="where the feature may lie, about its nominal place")
    law: LawUnion
    datums: Datums | None = Field(default=None, description="default: the part's frame")

    @model_validator(mode="before")
    @classmethod
    def _refuse_no_law(cls, value: Any) -> Any:
        if isinstance(value, dict) and "law" not in value:
            laws = "{kind: uniform}, {kind: normal} or {kind: process, distribution: …}"
            raise refused("law", f"how deviations lie in the zone, which drawings leave open: {laws}", "none")
        return value

    @override
    def scaled(self, factor: float, stays: Stays, files: Files) -> Self:
        return scaled_in_zone(self, factor, stays, files)

    @property
    def named_datums(self) -> tuple[DatumSpec, ...]:
        return self.datums or ()

    def file_names(self) -> Iterator[tuple[KeyPath, str]]:
        """Those that its law reads."""
        return ((("law", *path), name) for path, name in self.law.file_names())


class Composite(LocationSpec):
    """A location that a pattern may have in two segments: of the pattern, and of its features to each other."""

    lower_segment: SegmentSpec | None = Field(
        default=None, description="of a pattern: how its features lie to each other, in a narrower zone"
    )
    rigid_with: Annotated[tuple[FeatureName, ...], listed("features", 0)] = Field(
        default=(),
        description="of a composite tolerance: further features of its part, which make one rigid set with `of`",
    )

    @property
    def all_of(self) -> tuple[str, ...]:
        return (self.of, *self.rigid_with)

    def uses(self) -> Iterator[Use]:
        yield from super().uses()
        for k, name in enumerate(self.rigid_with):
            yield Use(("rigid_with", k), name, self.applies_to)

    def scaled(self, factor: float, stays: Stays, files: Files) -> Self:
        """See ToleranceEntry: both segments."""
        own, lower = super().scaled(factor, stays, files), self.lower_segment
        if lower is None:
            return own
        return own.model_copy(update={"lower_segment": lower.model_copy(update={"zone": lower.zone.scaled(factor)})})

    @model_validator(mode="after")
    def _refuse_unfit_segments(self) -> Self:
        lower, upper = self.lower_segment, self.zone
        for name in self.rigid_with:
            if part_of(name) != part_of(self.of):
                raise refused("rigid_with", f"features of {part_of(self.of)!r}, as `of` is", repr(name))
        if len({*self.all_of}) < len(self.all_of):
            raise refused("rigid_with", "each feature once, and not that of `of`", ", ".join(self.rigid_with))
        if lower is None:
            if self.rigid_with:
                expected = "a lower_segment beside it; without one write a tolerance for each feature"
                raise refused("rigid_with", expected, "none")
            return self
        if isinstance(self.law, ProcessLawSpec | RingLawSpec):
            raise refused("law", "uniform or normal of a composite tolerance", f"{self.law.kind}")
        for field in ("diameter", "width"):
            if (getattr(lower.zone, field) is None) != (getattr(upper, field) is None):
                expected = f"a {'diameter' if upper.width is None else 'width'}, as in the upper segment"
                raise refused(
                    "lower_segment.zone", expected, f"a {'diameter' if lower.zone.width is None else 'width'}"
                )
        if lower.zone.along != upper.along:
            raise refused("lower_segment.zone.along", "that of the upper segment", "another one")
        if lower.zone.projected != upper.projected:
            raise refused("lower_segment.zone.projected", "that of the upper segment", "another one")
        if lower.zone.outward is not None:
            raise refused("lower_segment.zone.outward", "none: the upper segment's counts for both", "one")
        if lower.zone.size >= upper.size:
            expected = f"a zone narrower than {upper.stated}, that of the upper segment"
            raise refused(
                "lower_segment.zone", expected, f"{lower.zone.stated}; swap the two, or leave lower_segment out"
            )
        datums, own = self.datums or (), lower.datums or ()
        if datums[: len(own)] != own:
            words = ", ".join("-".join(datum.features) for datum in datums) or "none"
            expected = f"the first datums of the upper segment ({words}), in their order"
            raise refused("lower_segment.datums", expected, ", ".join("-".join(datum.features) for datum in own))
        return self


class PositionSpec(Modified, Composite):
    """Position of a feature: an axis in a `diameter`, or in a `width` along one direction; a plane in a width."""

    words: ClassVar[str] = "a position tolerance"
    applies_to: ClassVar[tuple[str, ...]] = ("point", "sphere", *AXES, "plane", "slot")

    kind: Literal["position"]


class ProfileSpec(Composite):
    """A profile of a plane, a point or a round surface: a width about where it lies nominally.

    Half of the width lies outside the material unless `outward` says else.

    That of a cylinder, a cone or a sphere holds its size, its place and its form together.
    """

    words: ClassVar[str] = "a profile tolerance"
    applies_to: ClassVar[tuple[str, ...]] = ("plane", "point", *ROUND)

    kind: Literal["profile"]


class CoaxialitySpec(Modified, LocationSpec):
    """A coaxiality: the axis of a cylinder, an axis or a cone lies in a `diameter` about the datum's axis."""

    words: ClassVar[str] = "a coaxiality tolerance"
    applies_to: ClassVar[tuple[str, ...]] = AXES

    kind: Literal["coaxiality"]
    datums: Datums = Field(description="the axis that it is coaxial to")


class SymmetrySpec(LocationSpec):
    """A symmetry: a median plane or slot, or an axis in one direction, lies in a `width` about the datum's."""

    words: ClassVar[str] = "a symmetry tolerance"
    applies_to: ClassVar[tuple[str, ...]] = ("plane", "slot", *AXES)

    kind: Literal["symmetry"]
    datums: Datums = Field(description="the median plane or axis that it is symmetric to")


class OrientationSpec(Modified, FeatureTolerance):
    """A zone for how a feature is turned."""

    applies_to: ClassVar[tuple[str, ...]] = ("plane", "slot", *AXES)

    zone: ZoneSpec = Field(description="within which the feature may lean")
    law: LawUnion | None = Field(
        default=None, description="of a feature without a location zone; else that zone's law counts"
    )
    datums: Datums

    @override
    def scaled(self, factor: float, stays: Stays, files: Files) -> Self:
        return scaled_in_zone(self, factor, stays, files)

    @property
    def named_datums(self) -> tuple[DatumSpec, ...]:
        return self.datums


class PerpendicularitySpec(OrientationSpec):
    """Square to a datum: the tilt of a plane, a slot, a cylinder, an axis or a cone.

    Beside a location of the same feature it refines that zone and has no law; alone it has a law, and tilts the feature
    about its middle.
    """

    words: ClassVar[str] = "a perpendicularity tolerance"

    kind: Literal["perpendicularity"]


class ParallelismSpec(OrientationSpec):
    """Parallel to a datum: the tilt of a plane, a slot, a cylinder, an axis or a cone.

    With or without a law as a perpendicularity.
    """

    words: ClassVar[str] = "a parallelism tolerance"

    kind: Literal["parallelism"]


class AngularitySpec(OrientationSpec):
    """At an angle to a datum, as it is nominally: the tilt of a plane, a slot, a cylinder, an axis or a cone.

    With or without a law as a perpendicularity.
    """

    words: ClassVar[str] = "an angularity tolerance"

    kind: Literal["angularity"]


class AxialRunOutSpec(OrientationSpec):
    """Axial run-out of a round face about an axis: how far it wobbles in a turn, on a circle of the `radius`.

    2 · `radius` · tilt, plus the face's form, is within the `width`.
    """

    words: ClassVar[str] = "an axial run-out tolerance"
    applies_to: ClassVar[tuple[str, ...]] = ("plane",)

    kind: Literal["axial_run_out"]
    radius: Length | None = Field(default=None, description="of the circle that is read; default: that of the face")


class FormSpec(FeatureTolerance):
    """A zone for the form of a feature; where it touches at a point, that point lies off by up to half of it."""

    zone: ZoneSpec = Field(description="width within which the surface or line lies")
    law: LawUnion | None = Field(default=None, description="of the points that touch; default: they lie on the shape")

    @override
    def scaled(self, factor: float, stays: Stays, files: Files) -> Self:
        return scaled_in_zone(self, factor, stays, files)


def _area(value: Any) -> tuple[Any, ...]:
    """The sides of a rectangular piece, or the diameter of a round one by itself."""
    if not isinstance(value, list | tuple):
        return (value,)
    if len(value) != 2:
        raise refused("", "a length, the diameter of a round piece, or two: along x and y", f"a list of {len(value)}")
    return tuple(value)


class FlatnessSpec(FormSpec):
    """Flatness of a plane or of the median plane of a slot, or of every piece of it `per` an area.

    It reduces the width of a location zone. With a law every contact point deviates independently by up to half of it,
    and a tab or slot with play has less clearance.
    """

    words: ClassVar[str] = "a flatness tolerance"
    applies_to: ClassVar[tuple[str, ...]] = ("plane", "slot")

    kind: Literal["flatness"]
    per: (
        Annotated[tuple[Length, ...], BeforeValidator(_area, json_schema_input_type=Length | tuple[Length, Length])]
        | None
    ) = Field(
        default=None,
        description="every round piece of that diameter, or every one so long along x and y of the face; "
        "default: the whole face",
    )


class StraightnessSpec(FormSpec):
    """Straightness of an axis in a diameter, of surface lines in a width; of the whole, or of pieces `per` a length.

    An axis may also be straight in a width `along` a direction; of a plane `lines` are stated. It reduces the width of
    the location zone. With a law contact points deviate, and a pin or hole with play has less clearance.
    """

    words: ClassVar[str] = "a straightness tolerance"
    applies_to: ClassVar[tuple[str, ...]] = (*AXES, "plane")

    kind: Literal["straightness"]
    per: Length | None = Field(default=None, description="every piece of that length; default: the whole")
    lines: Literal["x", "y"] | None = Field(default=None, description="of a plane: along which of its axes lines run")


class RoundnessSpec(FormSpec):
    """Roundness of every section of a cylinder, a cone or a sphere, between two circles with one centre.

    It reduces the width of run-outs.
    """

    words: ClassVar[str] = "a roundness tolerance"
    applies_to: ClassVar[tuple[str, ...]] = ROUND

    kind: Literal["roundness"]


class CylindricitySpec(FormSpec):
    """Cylindricity: a cylinder lies between two cylinders with one axis.

    It reduces the width of run-outs and of the zone of the axis.
    """

    words: ClassVar[str] = "a cylindricity tolerance"
    applies_to: ClassVar[tuple[str, ...]] = ("cylinder",)

    kind: Literal["cylindricity"]


class CircularRunOutSpec(LocationSpec):
    """Radial run-out at the middle section of a cylinder, an axis or a cone.

    Twice the eccentricity is within the `width` less the form of the section.
    """

    words: ClassVar[str] = "a circular run-out tolerance"
    applies_to: ClassVar[tuple[str, ...]] = AXES

    kind: Literal["circular_run_out"]
    datums: Datums = Field(description="the axis that it turns about")


class TotalRunOutSpec(LocationSpec):
    """Radial run-out of a whole cylinder, axis or cone.

    At both ends twice the eccentricity is within the `width` less the form of the whole.
    """

    words: ClassVar[str] = "a total run-out tolerance"
    applies_to: ClassVar[tuple[str, ...]] = AXES

    kind: Literal["total_run_out"]
    datums: Datums = Field(description="the axis that it turns about")


def is_of_round_surface(spec: FeatureTolerance, kind: str) -> bool:
    """True if a tolerance of a kind of feature holds a size and a place together: a profile of what is round."""
    return isinstance(spec, ProfileSpec) and kind in ROUND
