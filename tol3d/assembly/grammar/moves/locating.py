"""Six contacts of points on planes: 3-2-1, and six planes at once.

Parts that stay where they are nominally, and placed parts that become one body.
"""

from abc import abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from itertools import chain, islice
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from tol3d.assembly.grammar.features import FeatureUnion
from tol3d.assembly.grammar.features.feature_spec import ROUND
from tol3d.assembly.grammar.moves.assembly_move import (
    AssemblyMoveSpec,
    DrawnFeatures,
    PairSpec,
    PlacingSpec,
    PointTouch,
)
from tol3d.assembly.grammar.moves.mate import RelationSpec
from tol3d.assembly.model.move import Acts
from tol3d.assembly.model.moves import STATED_BY, Fix, Locate, PointsOn, Rest, Weld
from tol3d.scene.listed import listed
from tol3d.scene.name import Name
from tol3d.scene.place import KeyPath
from tol3d.scene.vector import Direction, Vector
from tol3d.strict import Strict


class ContactSpec(PairSpec):
    """A point on a plane, tilted as in the trial: its height is that at the actual position of the point.

    The locator's offset and the form of the face are added. The analytic method takes the nominal position.
    """

    along: Direction | None = Field(
        default=None,
        description="normal of the plane, in the frame of the part that the plane stays with; default: that "
        "feature's own normal",
    )


class LocatingSpec(PlacingSpec):
    """Six contacts."""

    acts: ClassVar[Acts] = Locate.acts
    stated_by: ClassVar[str] = f"{STATED_BY}.moves:located"

    points_on: PointsOn = Field(
        default="part",
        description="part: points ride on the part that is placed, planes stay with what it is placed on; fixture: "
        "the reverse",
    )

    @property
    @abstractmethod
    def pairs_by_name(self) -> Mapping[str, tuple[KeyPath, ContactSpec]]:
        """The contacts with their fields, by the names that locators have."""

    @property
    def touches(self) -> Mapping[str, PointTouch]:
        pairs = {name: pair for name, (_, pair) in self.pairs_by_name.items()}
        if self.points_on == "part":
            return {name: PointTouch(own.to, own.from_, own.along) for name, own in pairs.items()}
        return {name: PointTouch(own.from_, own.to, own.along, self.part) for name, own in pairs.items()}

    def paired(self) -> Iterator[tuple[KeyPath, PairSpec]]:
        return iter(self.pairs_by_name.values())

    def problems(self, drawing: DrawnFeatures) -> Iterator[tuple[KeyPath, str]]:
        """Round features on planes, of which the middle would lie there, not the surface."""
        for path, pair in self.pairs_by_name.values():
            if {pair.from_, pair.to} <= set(drawing.names):
                sides = (("from", pair.from_, pair.to), ("to", pair.to, pair.from_))
                found = ((key, self._round(own, drawing.kind(own), drawing.kind(other))) for key, own, other in sides)
                yield from (((*path, key), words) for key, words in islice(((k, w) for k, w in found if w), 1))

    def _round(self, name: str, feature_union: FeatureUnion, other: FeatureUnion) -> str:
        """Error text for a round feature; "" where it fits."""
        if feature_union.kind not in ROUND or not (self.acts.rocks or other.kind == "plane"):
            return ""
        words = f"expected a point or a plane, got {name!r}, which is {feature_union.words}: its middle would lie there"
        remedy = "name the point of its surface that touches"
        if self.acts.rocks:
            return f"{words}; {remedy}, for a rest has no round contacts"
        return (
            f"{words}; {remedy}" if feature_union.kind == "cone" else f"{words}; take a move of kind touch, or {remedy}"
        )


class ThreeTwoOneSpec(LocatingSpec):
    """Three contacts, two, one, each along its own normal: tilted faces are touched as tilted.

    On an inclined wall a part that is lifted also slides sideways.
    """

    words: ClassVar[str] = "a 3-2-1 move"

    kind: Literal["three_two_one"]
    primary: Annotated[tuple[ContactSpec, ...], listed("pairs", 3, 3)] = Field(description="three contacts")
    secondary: Annotated[tuple[ContactSpec, ...], listed("pairs", 2, 2)] = Field(description="two contacts")
    tertiary: Annotated[tuple[ContactSpec, ...], listed("pairs", 1, 1)] = Field(description="one contact")

    @property
    def pairs_by_name(self) -> Mapping[str, tuple[KeyPath, ContactSpec]]:
        groups = {"primary": self.primary, "secondary": self.secondary, "tertiary": self.tertiary}
        return {
            f"{group} {k + 1}": ((group, k), pair) for group, pairs in groups.items() for k, pair in enumerate(pairs)
        }


class SixPlaneSpec(LocatingSpec):
    """Six contacts at once, each along its own normal."""

    words: ClassVar[str] = "a six-plane move"

    kind: Literal["six_plane"]
    pairs: Annotated[tuple[ContactSpec, ...], listed("pairs", 6, 6)] = Field(
        description="six contacts that together hold all freedoms"
    )

    @property
    def pairs_by_name(self) -> Mapping[str, tuple[KeyPath, ContactSpec]]:
        return {str(k + 1): (("pairs", k), pair) for k, pair in enumerate(self.pairs)}


class ForceSpec(Strict):
    """A force on the part; how large it is does not matter."""

    direction: Direction = Field(description="in the world; gravity is [0, 0, -1] where z points up")
    at: Vector = Field(description="a point on its line, in the frame of the part; of its weight the centre of gravity")


class RestSpec(LocatingSpec):
    """One-sided contacts, of which a force chooses those that carry; without friction."""

    words: ClassVar[str] = "a rest"
    acts: ClassVar[Acts] = Rest.acts
    stated_by: ClassVar[str] = f"{STATED_BY}.moves:rested"

    kind: Literal["rest"]
    contacts: Annotated[tuple[ContactSpec, ...], listed("contacts", 1)] = Field(
        description="pairs of features that may touch"
    )
    force: ForceSpec = Field(description="what presses the part on")
    relations: Annotated[tuple[RelationSpec, ...], listed("relations", 1, 6)] = Field(
        default=(), description="as of a mate, kept while the force moves what they leave free"
    )

    @property
    def pairs_by_name(self) -> Mapping[str, tuple[KeyPath, ContactSpec]]:
        return {str(k + 1): (("contacts", k), pair) for k, pair in enumerate(self.contacts)}

    def paired(self) -> Iterator[tuple[KeyPath, PairSpec]]:
        """Contacts, then relations."""
        return chain(super().paired(), ((("relations", k), pair) for k, pair in enumerate(self.relations)))


class FixSpec(PlacingSpec):
    """A part stays where it is nominally: the first of an assembly, or a fixture."""

    words: ClassVar[str] = "a fixed part"
    acts: ClassVar[Acts] = Fix.acts
    stated_by: ClassVar[str] = f"{STATED_BY}.moves:fixed"

    kind: Literal["fix"]

    @property
    def fixed(self) -> Sequence[str]:
        return (self.part,)


class WeldSpec(AssemblyMoveSpec):
    """Placed parts become one body, which may be moved again by the name of its first part."""

    words: ClassVar[str] = "a weld"
    acts: ClassVar[Acts] = Weld.acts
    stated_by: ClassVar[str] = f"{STATED_BY}.moves:welded"

    kind: Literal["weld"]
    part: Name = Field(description="by whose name the body is moved again")
    to: Annotated[tuple[Name, ...], listed("parts")] = Field(description="what it is welded to")

    @property
    def joined(self) -> Sequence[tuple[KeyPath, str]]:
        return [(("part",), self.part), *((("to", k), name) for k, name in enumerate(self.to))]
