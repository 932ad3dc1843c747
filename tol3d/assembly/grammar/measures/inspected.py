"""Inspection of a feature, as by a measuring machine, in the datum frame of the same trial."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Annotated, ClassVar, Final, Literal, Self

from pydantic import Field, model_validator

from tol3d.assembly.grammar.datums import Datums, DatumSpec
from tol3d.assembly.grammar.feature_name import FeatureName, part_of
from tol3d.assembly.grammar.features.feature_spec import AXES
from tol3d.assembly.grammar.measures.assembly_measure import FeatureMeasureSpec
from tol3d.assembly.grammar.measures.clearance import MOST_HOLES
from tol3d.assembly.model.datum_frame import Modifier
from tol3d.assembly.model.measures import PLACING, TORSORS, Gauge, Measured, Reading, SetGauge
from tol3d.scene.bases import Length
from tol3d.scene.listed import listed
from tol3d.scene.place import KeyPath
from tol3d.scene.vector import Direction
from tol3d.strict import refused
from tol3d.units import Of, Quantity

INSPECTED_SETS: Final = "tol3d.assembly.placing.inspected_sets", "tol3d.assembly.torsors.inspected_sets"
MOST_OF_A_SET: Final = 64  # features; four places each are that many cones


class InspectedSpec(FeatureMeasureSpec):
    """A measure of one feature in a datum frame."""

    of: FeatureName = Field(description="the feature")
    datums: Datums | None = Field(default=None, description="default: the part's frame")

    @property
    def named_datums(self) -> tuple[DatumSpec, ...]:
        return self.datums or ()

    def named(self) -> Sequence[tuple[KeyPath, FeatureName, tuple[str, ...]]]:
        return ((("of",), self.of, ()),)


class InspectedPositionSpec(InspectedSpec):
    """Twice the largest distance from nominal in the datum frame of the trial.

    Of an axis across it, of a point `across` a direction or in space; with a `modifier` less the bonus; `projected`
    over such a length beyond the axis's end.
    """

    reads: ClassVar[Reading] = Reading(
        "position", f"{PLACING}:position", f"{TORSORS}:position", of_part=True, worse="high", of_drawing=True
    )

    kind: Literal["inspected_position"]
    across: Direction | None = Field(default=None, description="of a point: the direction that does not count")
    projected: Length | None = Field(
        default=None, description="of an axis: over such a length beyond its end along +z instead of over itself"
    )
    modifier: Modifier | None = Field(
        default=None, description="mmc or lmc: less the bonus of the feature's size, so that it counts against t0"
    )

    @property
    def along(self) -> Direction | None:
        return self.across

    def named(self) -> Sequence[tuple[KeyPath, FeatureName, tuple[str, ...]]]:
        kinds = ("cylinder", "slot") if self.modifier is not None else () if self.across is None else ("point",)
        if self.projected is not None:
            kinds = ("cylinder",) if self.modifier is not None else ("axis", "cylinder")
        return ((("of",), self.of, kinds),)


class InspectedOrientationSpec(InspectedSpec):
    """Width of the narrowest zone, oriented as drawn, that holds the feature; `projected` over such a length.

    Of an axis it is round, or between planes across a `direction`.
    """

    reads: ClassVar[Reading] = Reading(
        "orientation", f"{PLACING}:orientation", f"{TORSORS}:orientation", of_part=True, worse="high", of_drawing=True
    )

    kind: Literal["inspected_orientation"]
    projected: Length | None = Field(default=None, description="of an axis: over such a length instead of its own")
    direction: Direction | None = Field(
        default=None, description="of an axis: the one direction in which its lean counts, in the part's frame"
    )

    @property
    def along(self) -> Direction | None:
        return self.direction

    def named(self) -> Sequence[tuple[KeyPath, FeatureName, tuple[str, ...]]]:
        kinds = AXES if self.direction is not None else ("plane", "slot", *AXES)
        return ((("of",), self.of, ("axis", "cylinder") if self.projected is not None else kinds),)


class InspectedFlatnessSpec(FeatureMeasureSpec):
    """Flatness of 4 or more `points` of one part: the distance of two parallel planes that contain them."""

    reads: ClassVar[Reading] = Reading(
        "flatness", f"{PLACING}:flatness", f"{TORSORS}:flatness", of_part=True, worse="high", of_drawing=True
    )

    kind: Literal["inspected_flatness"]
    points: Annotated[tuple[FeatureName, ...], listed("points", 4)] = Field(description="of one part")
    normal: Direction = Field(description="of the nominal plane, in that part's frame")

    @property
    def along(self) -> Direction | None:
        return self.normal

    @model_validator(mode="after")
    def _refuse_several_parts(self) -> Self:
        parts = sorted({part_of(name) for name in self.points})
        if len(parts) > 1:
            raise refused("points", "points of one part", f"points of {', '.join(map(repr, parts))}")
        return self

    def named(self) -> Sequence[tuple[KeyPath, FeatureName, tuple[str, ...]]]:
        return tuple((("points", k), name, ("point",)) for k, name in enumerate(self.points))


def _refuse_other_features(names: Sequence[str]) -> None:
    """Refuse features of several parts, or one that is named twice."""
    parts = sorted({part_of(name) for name in names})
    if len(parts) > 1:
        raise refused("of", "features of one part", f"features of {', '.join(map(repr, parts))}")
    for k, name in enumerate(names):
        if name in names[:k]:
            raise refused("of", "each feature once", repr(name))


class InspectedPatternSpec(FeatureMeasureSpec):
    """The largest position of 2 to 8 parallel features, where nominal places may move to make it least.

    They may `shift`, or `shift_and_turn`; with a `modifier` each position is less its bonus.
    """

    reads: ClassVar[Reading] = Reading(
        "pattern", "tol3d.assembly.placing.measuring:pattern", f"{TORSORS}:pattern", worse="high", of_drawing=True
    )

    kind: Literal["inspected_pattern"]
    features: Annotated[tuple[FeatureName, ...], listed("features", 2, MOST_HOLES)] = Field(
        alias="of", description="parallel holes or pins of one part"
    )
    free: Gauge = Field(description="how the gauge finds its pose, across the first feature's axis")
    datums: Datums | None = Field(default=None, description="what orients the gauge; default: the part's frame")
    modifier: Modifier | None = Field(
        default=None, description="mmc or lmc: each less the bonus of its size, so that all count against t0"
    )

    @property
    def named_datums(self) -> tuple[DatumSpec, ...]:
        return self.datums or ()

    @model_validator(mode="after")
    def _refuse_contradictions(self) -> Self:
        _refuse_other_features(self.features)
        if len(self.named_datums) > 1:
            raise refused("datums", "one at most, which orients the gauge: it finds its place by the features", "more")
        return self

    def named(self) -> Sequence[tuple[KeyPath, FeatureName, tuple[str, ...]]]:
        kinds = ("cylinder",) if self.modifier is not None else AXES
        return tuple((("of", k), name, kinds) for k, name in enumerate(self.features))


class InspectedSetSpec(FeatureMeasureSpec):
    """Twice the largest distance of a set of features from where it lies nominally in the datum frame.

    The set is `held` by the frame, or only `oriented`: then it lies where that is least, shifted and turned as far as
    its datums leave turns. Round `surfaces` count with their size. A round face is judged at 24 points of its rim.
    """

    reads: ClassVar[Reading] = Reading(
        "set",
        f"{INSPECTED_SETS[0]}:inspected_set",
        f"{INSPECTED_SETS[1]}:inspected_set",
        of_part=True,
        worse="high",
        of_drawing=True,
    )

    kind: Literal["inspected_set"]
    features: Annotated[tuple[FeatureName, ...], listed("features", 1, MOST_OF_A_SET)] = Field(
        alias="of",
        description="features of one part; of an oriented set no points and balls, and no cones by their surfaces",
    )
    free: SetGauge = Field(default="held", description="held by its datums, or only oriented")
    surfaces: bool = Field(default=False, description="whether what is round counts by its surface, not by its middle")
    middle: Annotated[Quantity, Of("length")] | None = Field(
        default=None, description="of an unequal profile: how far the middle of its zone lies out of the material"
    )
    datums: Datums | None = Field(default=None, description="default: the part's frame")
    modifier: Modifier | None = Field(
        default=None, description="mmc or lmc: each less the bonus of its size, so that all count against t0"
    )

    @property
    def named_datums(self) -> tuple[DatumSpec, ...]:
        return self.datums or ()

    @model_validator(mode="after")
    def _refuse_contradictions(self) -> Self:
        _refuse_other_features(self.features)
        if self.modifier is not None and self.surfaces:
            raise refused("modifier", "none of surfaces, which count with their size", self.modifier)
        if (
            own := next((named_datum for named_datum in self.named_datums if named_datum.gauge is not None), None)
        ) is not None:
            raise refused("datums", "datums regardless of size, for an inspected set takes no gauge", own.key)
        return self

    def named(self) -> Sequence[tuple[KeyPath, FeatureName, tuple[str, ...]]]:
        axes = ("cylinder", "axis") if self.surfaces else AXES  # a cone's surface is judged along its axis too
        kinds: tuple[str, ...] = (*axes, "slot", "plane") if self.free == "oriented" else ()
        if self.modifier is not None:
            kinds = ("cylinder", "slot")
        return tuple((("of", k), name, kinds) for k, name in enumerate(self.features))

    def measured(self, moves: Sequence[str]) -> Measured:
        middle = 0.0 if self.middle is None else self.middle.internal
        return replace(super().measured(moves), gauge=self.free, surfaces=self.surfaces, middle=middle)


class InspectedTogetherSpec(FeatureMeasureSpec):
    """The largest position less its zone of 2 to 8 features of one frame: together they are within their `zones` at 0.

    Gauges of datums with `mmb: least` (or `lmb`) take one place for all of them, as simultaneous requirements say; with
    a `modifier` each is less the bonus of its size as well.
    """

    reads: ClassVar[Reading] = Reading(
        "together", f"{PLACING}:together", f"{TORSORS}:together", of_part=True, worse="high", of_drawing=True
    )

    kind: Literal["inspected_together"]
    features: Annotated[tuple[FeatureName, ...], listed("features", 2, MOST_HOLES)] = Field(
        alias="of", description="holes, pins, slots and flat faces of one part"
    )
    zones: Annotated[tuple[Length, ...], listed("lengths", 2, MOST_HOLES)] = Field(
        description="diameter or width of the zone of each, in their order"
    )
    datums: Datums | None = Field(default=None, description="of all of them; default: the part's frame")
    modifier: Modifier | None = Field(
        default=None, description="mmc or lmc: each less the bonus of its size; default: regardless of sizes"
    )

    @property
    def named_datums(self) -> tuple[DatumSpec, ...]:
        return self.datums or ()

    @model_validator(mode="after")
    def _refuse_contradictions(self) -> Self:
        _refuse_other_features(self.features)
        if len(self.zones) != len(self.features):
            raise refused("zones", f"one of each feature, {len(self.features)}", len(self.zones))
        return self

    def named(self) -> Sequence[tuple[KeyPath, FeatureName, tuple[str, ...]]]:
        kinds = ("cylinder", "slot") if self.modifier is not None else (*AXES, "slot", "plane")
        return tuple((("of", k), name, kinds) for k, name in enumerate(self.features))


class InspectedSizeSpec(FeatureMeasureSpec):
    """The diameter, of a cone at its middle, or the width of a slot."""

    reads: ClassVar[Reading] = Reading("size", f"{PLACING}:size", f"{TORSORS}:size", is_linear=True, of_part=True)

    kind: Literal["inspected_size"]
    of: FeatureName = Field(description="the feature")

    def named(self) -> Sequence[tuple[KeyPath, FeatureName, tuple[str, ...]]]:
        return ((("of",), self.of, ("cylinder", "cone", "slot", "sphere")),)
