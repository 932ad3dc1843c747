"""Parts held with play by pins or tabs in holes or slots: engagements, and the position within the clearance."""

from abc import abstractmethod
from collections.abc import Iterator, Sequence
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from tol3d.assembly.grammar.feature_name import FeatureName, Use, part_of
from tol3d.assembly.grammar.features.feature_spec import SIZED
from tol3d.assembly.grammar.moves.assembly_move import DrawnFeatures, PairSpec, PlacingSpec
from tol3d.assembly.grammar.moves.mate import RelationSpec
from tol3d.assembly.grammar.parts import SolidSpec
from tol3d.assembly.model.move import Acts
from tol3d.assembly.model.moves import STATED_BY
from tol3d.assembly.model.play import Engage
from tol3d.scene.entry import Reference
from tol3d.scene.listed import listed
from tol3d.scene.place import KeyPath
from tol3d.scene.vector import Direction
from tol3d.statistics.distributions import StatedDistribution
from tol3d.strict import Strict, refused
from tol3d.units import Of, Quantity, refuse_dimension, shown


class EngagementSpec(PairSpec):
    """A pin in a hole or slot, or a tab in a slot; either may be of the part that is placed."""

    over: Literal["from", "to"] | None = Field(
        default=None, description="whose ends are those of the engagement; default: of the stretch that both share"
    )

    @property
    def through(self) -> "BoltSpec | None":
        """The bolt that goes through both; by default none."""
        return None

    def unfit(self, drawing: DrawnFeatures) -> str:
        """Why its features do not engage, in words; "" where they do."""
        one, other = drawing.kind(self.from_), drawing.kind(self.to)
        for name, own in ((self.from_, one), (self.to, other)):
            if own.kind not in SIZED:
                return f"expected a pin or tab and a hole or slot, got {name!r}, which is {own.words}"
        if (bolt := self.through) is not None:
            if not all(own.kind == "cylinder" and own.shape.inner for own in (one, other)):
                return f"expected two holes that the bolt goes through, got {self.from_!r} and {self.to!r}"
            shank = None if bolt.of is None or bolt.of not in drawing.names else drawing.kind(bolt.of)
            if shank is not None and shank.kind == "cylinder" and shank.hole:
                return f"expected a bolt that is a pin, got {bolt.of!r}, which is a hole"
            return ""
        if one.shape.inner == other.shape.inner:
            both = "two holes or slots" if one.shape.inner else "two pins or tabs"
            holes = one.shape.inner and (one.kind, other.kind) == ("cylinder", "cylinder")
            advice = "; a bolt that is loose in both is `bolt` of a pattern's pair" if holes else ""
            return f"expected a pin or tab and a hole or slot, got {both}, {self.from_!r} and {self.to!r}{advice}"
        inner, outer = (one, other) if one.shape.inner else (other, one)
        if (inner.kind, outer.kind) == ("cylinder", "slot"):
            return "expected a pin in a hole, a pin in a slot or a tab in a slot, got a tab in a hole"
        return ""


class BoltSpec(Strict):
    """A bolt: a diameter with the law of its deviation, or a cylinder of a part with its size tolerance."""

    words: ClassVar[str] = "a bolt"

    of: FeatureName | None = Field(default=None, description="a pin of a part, such as screw.shank, instead of both")
    diameter: Annotated[Quantity, Of("length")] | None = Field(default=None, description="nominal")
    distribution: StatedDistribution | None = Field(default=None, description="the law of its deviation")

    @model_validator(mode="after")
    def _refuse_half_a_bolt(self) -> Self:
        if (self.of is None) != (self.diameter is not None and self.distribution is not None):
            raise refused("", "a diameter with its distribution, or a pin such as screw.shank", "both, or half of it")
        if self.diameter is not None and not self.diameter.internal > 0.0:
            raise refused("diameter", "a length above 0", str(self.diameter))
        for field, quantity in self.distribution.quantities().items() if self.distribution is not None else ():
            refuse_dimension(quantity, ("length",), f"distribution.{field}")
        return self


def _bolt(value: Any) -> Any:
    """`screw.shank` as a BoltSpec's fields."""
    if isinstance(value, str):
        return {"of": value}
    if isinstance(value, BoltSpec | dict):
        return value
    raise refused("", "a pin such as screw.shank, or {diameter: 8 mm, distribution: {..}}", shown(value))


class PatternPairSpec(EngagementSpec):
    """Engagement in a pattern; it may also be two holes with a bolt through both."""

    bolt: Annotated[BoltSpec, BeforeValidator(_bolt, json_schema_input_type=str | BoltSpec)] | None = Field(
        default=None, description="that goes through two holes, loose in both: a pin of a part, or its diameter and law"
    )

    @property
    def through(self) -> BoltSpec | None:
        return self.bolt

    @model_validator(mode="after")
    def _refuse_over(self) -> Self:
        if self.bolt is not None and self.over is not None:
            raise refused("over", "none beside a bolt, which both holes hold at all their ends", self.over)
        return self


class CentredSpec(Strict):
    """Centred within its play."""

    kind: Literal["centred"]


class RandomSpec(Strict):
    """Anywhere within its play."""

    kind: Literal["random"]


class TowardSpec(Strict):
    """At one end of its play."""

    kind: Literal["toward"]
    along: Direction = Field(description="which way, in the frame of the part that `at` is of, as it lies nominally")
    at: FeatureName = Field(description="whose middle goes as far that way as may be")


def _no_word(value: Any) -> Any:
    if isinstance(value, str):
        raise refused("", "the position of the part within its play, such as {kind: random}", shown(value))
    return value


FloatUnion = Annotated[
    CentredSpec | RandomSpec | TowardSpec,
    Field(discriminator="kind", description="position within the play: centred, random or toward a direction"),
    BeforeValidator(_no_word),
]


NO_SIZE = "a size that does not vary is {kind: size, ..., distribution: {kind: constant, value: 0 mm}}"


class PlaySpec(PlacingSpec):
    """A part that is held with play."""

    words: ClassVar[str] = "a move with play"
    acts: ClassVar[Acts] = Engage.acts
    stated_by: ClassVar[str] = f"{STATED_BY}.play:engaged"
    drawn_by: ClassVar[str] = f"{STATED_BY}.play:contributors_of"

    relations: Annotated[tuple[RelationSpec, ...], listed("relations", 0, 6)] = Field(
        default=(), description="as of a mate: what holds it before its pins do, such as faces that lie on each other"
    )
    floating: FloatUnion = Field(alias="float")

    @model_validator(mode="before")
    @classmethod
    def _refuse_no_float(cls, value: Any) -> Any:
        if isinstance(value, dict) and "float" not in value:
            choices = "{kind: centred}, {kind: random} or {kind: toward, along: …, at: …}"
            raise refused("float", f"the position of the part within its play (no default): {choices}", "none")
        return value

    @property
    @abstractmethod
    def engaged(self) -> tuple[EngagementSpec, ...]:
        """Engagements, in order."""

    @property
    def fitted(self) -> Sequence[FeatureName]:
        bolts = (pair.through.of for pair in self.engaged if pair.through is not None)
        return [*(own for pair in self.engaged for own in (pair.from_, pair.to)), *(bolt for bolt in bolts if bolt)]

    def floats_by_pairs(self, drawing: DrawnFeatures) -> bool:
        """True if a random float draws each pin in its own clearance, not the part in the room of all."""
        return False

    def problems(self, drawing: DrawnFeatures) -> Iterator[tuple[KeyPath, str]]:
        """Pairs that do not engage, or whose sizes have no tolerance."""
        for k, pair in enumerate(self.engaged):
            here: KeyPath = ("pairs", k)
            if not all(own in drawing.names for own in (pair.from_, pair.to)):
                continue  # unknown, reported already
            if problem := pair.unfit(drawing) or self._unfit_place(k, pair, drawing):
                yield here, problem
                continue
            sized = [("from", pair.from_), ("to", pair.to)]
            sized += [("bolt", pair.through.of)] if pair.through is not None and pair.through.of is not None else []
            for end, own in sized:
                if not drawing.is_sized(own):
                    words = f"expected a size tolerance of {own!r}, because the play depends on it, got none"
                    yield (*here, end), f"{words}; {NO_SIZE}"

    def _unfit_place(self, k: int, pair: EngagementSpec, drawing: DrawnFeatures) -> str:
        """Why a pair does not fit its place among the pairs, in words; "" where it does."""
        return ""

    def paired(self) -> Iterator[tuple[KeyPath, PairSpec]]:
        yield from ((("relations", k), pair) for k, pair in enumerate(self.relations))
        yield from ((("pairs", k), pair) for k, pair in enumerate(self.engaged))

    def references(self) -> tuple[Reference, ...]:
        found = super().references()
        if isinstance(self.floating, TowardSpec):
            found += (Reference(("float", "at"), part_of(self.floating.at), (SolidSpec,)),)
        return found

    def uses(self) -> Iterator[Use]:
        yield from (Use((*path, "from"), pair.from_) for path, pair in self.paired())
        yield from (Use((*path, "to"), pair.to) for path, pair in self.paired())
        if isinstance(self.floating, TowardSpec):
            yield Use(("float", "at"), self.floating.at)


class PinAndHoleSpec(PlaySpec):
    """A pin in a hole, and a second one in a hole or slot that holds the turn."""

    words: ClassVar[str] = "a pin-and-hole move"

    kind: Literal["pin_and_hole"]
    pairs: Annotated[tuple[EngagementSpec, ...], listed("pairs", 1, 2)] = Field(
        description="one or two pins in holes or slots"
    )

    @property
    def engaged(self) -> tuple[EngagementSpec, ...]:
        return self.pairs

    def floats_by_pairs(self, drawing: DrawnFeatures) -> bool:
        """Unless both share their clearance: two round holes."""
        kinds = [drawing.kind(name).kind for pair in self.engaged for name in (pair.from_, pair.to)]
        return len(self.engaged) != 2 or "slot" in kinds

    def _unfit_place(self, k: int, pair: EngagementSpec, drawing: DrawnFeatures) -> str:
        """The first pin holds both shifts."""
        if k == 0 and {drawing.kind(name).kind for name in (pair.from_, pair.to)} != {"cylinder"}:
            return (
                "expected a pin in a hole first, which holds both shifts, got a slot; put it second, or take a pattern"
            )
        return ""


class PatternSpec(PlaySpec):
    """Pins and tabs that go into their holes and slots together, and holes that bolts go through."""

    words: ClassVar[str] = "a pattern"

    kind: Literal["pattern"]
    pairs: Annotated[tuple[PatternPairSpec, ...], listed("pairs", 1)] = Field(description="what engages, all at once")

    @property
    def engaged(self) -> tuple[EngagementSpec, ...]:
        return self.pairs

    def references(self) -> tuple[Reference, ...]:
        bolts = [(path, own) for path, own in self._bolts() if own.of is not None]
        return super().references() + tuple(
            Reference(path, part_of(own.of), (SolidSpec,)) for path, own in bolts if own.of is not None
        )

    def uses(self) -> Iterator[Use]:
        yield from super().uses()
        for path, own in self._bolts():
            if own.of is not None:
                yield Use(path, own.of, ("cylinder",))

    def file_names(self) -> Iterator[tuple[KeyPath, str]]:
        """Those that laws of bolts read."""
        yield from super().file_names()
        for path, own in self._bolts():
            if own.distribution is not None:
                yield from (((*path, "distribution", field), name) for field, name in own.distribution.file_names())

    def _bolts(self) -> Iterator[tuple[KeyPath, BoltSpec]]:
        yield from ((("pairs", k, "bolt"), pair.bolt) for k, pair in enumerate(self.pairs) if pair.bolt is not None)
