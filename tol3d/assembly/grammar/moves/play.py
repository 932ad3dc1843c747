"""Parts that pins or tabs hold with play in holes or slots: what engages, and where in its room the part lies."""

from abc import abstractmethod
from collections.abc import Iterator
from typing import Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Field, model_validator

from tol3d.assembly.grammar.feature_name import FeatureName, Use, part_of
from tol3d.assembly.grammar.moves.mate import RelationSpec
from tol3d.assembly.grammar.moves.placing_move import PairSpec, PlacingSpec
from tol3d.assembly.grammar.parts import SolidSpec
from tol3d.scene.listed import listed
from tol3d.scene.place import KeyPath
from tol3d.scene.reference import Reference
from tol3d.scene.vector import Direction
from tol3d.strict import Strict, refused
from tol3d.units import shown


class EngagementSpec(PairSpec):
    """A pin in a hole or slot, or a tab in a slot; either may be of the part that is placed."""

    over: Literal["from", "to"] | None = Field(
        default=None, description="whose ends are those of the engagement; of the stretch that both share if not given"
    )


class CentredSpec(Strict):
    """In the middle of its room."""

    kind: Literal["centred"]


class RandomSpec(Strict):
    """Anywhere in its room."""

    kind: Literal["random"]


class TowardSpec(Strict):
    """At the end of its room."""

    kind: Literal["toward"]
    along: Direction = Field(description="which way, in the frame of the part that `at` is of, as it lies nominally")
    at: FeatureName = Field(description="whose middle goes as far that way as may be")


def _no_word(value: Any) -> Any:
    if isinstance(value, str):
        raise refused("", "where in its room the part lies, such as {kind: random}", shown(value))
    return value


FloatUnion = Annotated[
    CentredSpec | RandomSpec | TowardSpec,
    Field(discriminator="kind", description="where in its room the part lies: centred, random or toward a direction"),
    BeforeValidator(_no_word),
]


class PlaySpec(PlacingSpec):
    """A part that is held with play."""

    words: ClassVar[str] = "a move with play"

    relations: Annotated[tuple[RelationSpec, ...], listed("relations", 0, 6)] = Field(
        default=(), description="as of a mate: what holds it before its pins do, such as faces that lie on each other"
    )
    floating: FloatUnion = Field(alias="float")

    @model_validator(mode="before")
    @classmethod
    def _refuse_no_float(cls, value: Any) -> Any:
        if isinstance(value, dict) and "float" not in value:
            choices = "{kind: centred}, {kind: random} or {kind: toward, along: …, at: …}"
            raise refused("float", f"where in its room the part lies, which has no default: {choices}", "none")
        return value

    @property
    @abstractmethod
    def engaged(self) -> tuple[EngagementSpec, ...]:
        """What engages, in order."""

    def paired(self) -> Iterator[tuple[KeyPath, PairSpec]]:
        """See PlacingSpec."""
        yield from ((("relations", k), pair) for k, pair in enumerate(self.relations))
        yield from ((("pairs", k), pair) for k, pair in enumerate(self.engaged))

    def references(self) -> tuple[Reference, ...]:
        """See PlacingSpec."""
        found = super().references()
        if isinstance(self.floating, TowardSpec):
            found += (Reference(("float", "at"), part_of(self.floating.at), (SolidSpec,)),)
        return found

    def uses(self) -> Iterator[Use]:
        """See PlacingSpec."""
        yield from (Use((*path, "from"), pair.from_) for path, pair in self.paired())
        yield from (Use((*path, "to"), pair.to) for path, pair in self.paired())
        if isinstance(self.floating, TowardSpec):
            yield Use(("float", "at"), self.floating.at)


class PinAndHoleSpec(PlaySpec):
    """A pin in a hole, and a second one in a hole or slot that holds the turn."""

    words: ClassVar[str] = "a pin-and-hole move"

    kind: Literal["pin_and_hole"]
    pairs: Annotated[tuple[EngagementSpec, ...], listed("pairs", 1, 2)]

    @property
    def engaged(self) -> tuple[EngagementSpec, ...]:
        """See PlaySpec."""
        return self.pairs


class PatternSpec(PlaySpec):
    """Pins and tabs that go into their holes and slots together."""

    words: ClassVar[str] = "a pattern"

    kind: Literal["pattern"]
    pairs: Annotated[tuple[EngagementSpec, ...], listed("pairs", 1)]

    @property
    def engaged(self) -> tuple[EngagementSpec, ...]:
        """See PlaySpec."""
        return self.pairs
