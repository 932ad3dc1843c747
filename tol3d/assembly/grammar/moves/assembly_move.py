"""Common base of all moves of an assembly: what they place, what they lay it on, and the code of each.

Parts that no move places, and moves to add for them.
"""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Protocol

from pydantic import Field

from tol3d.assembly.grammar.datums import DatumSpec
from tol3d.assembly.grammar.feature_name import FeatureName, Use, part_of
from tol3d.assembly.grammar.features import FeatureUnion
from tol3d.assembly.grammar.parts import SolidSpec
from tol3d.assembly.model.move import Acts
from tol3d.import_path import is_named
from tol3d.scene.bases import MoveSpec
from tol3d.scene.entry import Reference
from tol3d.scene.name import Name
from tol3d.scene.place import KeyPath
from tol3d.scene.vector import Direction
from tol3d.strict import Strict


class DrawnFeatures(Protocol):
    """Features of a scene's drawings, see `tol3d.assembly.grammar.drawing.Drawing`."""

    @property
    def names(self) -> Collection[str]:
        """All of them."""

    def kind(self, name: str) -> FeatureUnion:
        """A feature by its name."""

    def is_sized(self, name: str) -> bool:
        """True if its size has a tolerance."""


class PairSpec(Strict):
    """A feature of the part to be placed, and its target on placed parts."""

    from_: FeatureName = Field(alias="from", description="of the part that is placed")
    to: FeatureName = Field(description="of a part that is placed already")


@dataclass(frozen=True)
class PointTouch:
    """A point of one part on a surface of another.

    Args:
        side: the feature that is touched.
        point: the feature that touches it.
        along: out of the material, in the frame of the part with the surface; None for that feature's own normal.
        lifted_for: the part that is placed, for which locators shift the point; "" where it carries the points.
    """

    side: FeatureName
    point: FeatureName
    along: Direction | None
    lifted_for: str = ""


class AssemblyMoveSpec(MoveSpec):
    """A move that places one body or several, or joins some; of any mechanism.

    A kind declares all of its own here: its fields, `acts` (its two methods), `stated_by` (its model) and, with
    contributors of its own, `drawn_by`. The latter two are import paths `package.module:function`.

    - stated_by: from the spec, the move's name and its Setting (tol3d.assembly.from_scene.setting) to the Move.
    - drawn_by: from the spec, the move's name and the scene to its own contributors, such as floats; a name that begins
      with . is hidden. "" for none.
    """

    words: ClassVar[str] = "a move that places or joins parts"
    acts: ClassVar[Acts]
    stated_by: ClassVar[str] = ""
    drawn_by: ClassVar[str] = ""

    @classmethod
    def lacking(cls) -> Iterator[str]:
        if not hasattr(cls, "acts"):
            yield "`acts`, the two methods that carry it out"
            return
        yield from cls.acts.lacking()
        for name, path in (("stated_by", cls.stated_by), ("drawn_by", cls.drawn_by)):
            if not is_named(path) and (path or name == "stated_by"):
                yield f"`{name}`: expected `package.module:function`, got {path!r}, where nothing is"

    @property
    def parts_placed(self) -> Sequence[tuple[KeyPath, str]]:
        """The parts that it places with their fields, in an order in which each lies on those before; default: none."""
        return ()

    def targets(self) -> Iterator[tuple[KeyPath, FeatureName]]:
        """Features with their fields on which it lays them: of parts that are placed, or that it places before."""
        return iter(())

    def references(self) -> tuple[Reference, ...]:
        """The parts, and those of the features on which they are laid."""
        found = [Reference(path, part, (SolidSpec,)) for path, part in (*self.parts_placed, *self.joined)]
        return (*found, *(Reference(path, part_of(feature), (SolidSpec,)) for path, feature in self.targets()))

    def paired(self) -> Iterator[tuple[KeyPath, PairSpec]]:
        """Pairs with their fields, in order, of a move that places one part against others; by default none."""
        return iter(())

    @property
    def joined(self) -> Sequence[tuple[KeyPath, str]]:
        """Placed parts with their fields that become one body, moved again by the name of the first; or none."""
        return ()

    @property
    def fixed(self) -> Sequence[str]:
        """Parts that it holds in the world where they are `placed`; by default none."""
        return ()

    @property
    def pairs_by_name(self) -> Mapping[str, tuple[KeyPath, PairSpec]]:
        """Contacts of points on planes with their fields, by the names that locators have; by default none."""
        return {}

    @property
    def seats(self) -> Sequence[tuple[str, Sequence[DatumSpec]]]:
        """Parts that it takes by datum frames of their own, each with the datums; by default none."""
        return ()

    @property
    def touches(self) -> Mapping[str, PointTouch]:
        """Surfaces that points of other parts touch, by the names that locators have; by default none."""
        return {}

    @property
    def fitted(self) -> Sequence[FeatureName]:
        """Features whose sizes, form included, decide its play; by default none."""
        return ()

    @property
    def pose_names(self) -> Sequence[str]:
        """Poses that measures may be read at; the first one is read where none is named."""
        return ()

    @property
    def path_names(self) -> Mapping[str, Sequence[str]]:
        """Paths that measures may be read over: by name the poses on them, which `stated_by` gets like others."""
        return {}

    def pose_like(self, pose: str) -> str:
        """A pose of the scene if it is one of this move's, else its first one; "" where it has none."""
        own = (*self.pose_names, *(each for poses in self.path_names.values() for each in poses))
        return pose if pose in own else next(iter(own), "")

    def problems(self, drawing: DrawnFeatures) -> Iterator[tuple[KeyPath, str]]:
        """Fields with error texts where features do not fit the move; features may be unknown. By default none."""
        return iter(())


class PlacingSpec(AssemblyMoveSpec):
    """A move that places a part, and what is welded to it, by pairs of features."""

    part: Name = Field(description="the part that is placed")

    @property
    def parts_placed(self) -> Sequence[tuple[KeyPath, str]]:
        return [(("part",), self.part)]

    def targets(self) -> Iterator[tuple[KeyPath, FeatureName]]:
        """Features that its pairs are laid on."""
        return (((*path, "to"), pair.to) for path, pair in self.paired())

    def references(self) -> tuple[Reference, ...]:
        """The part, and those of the features."""
        found = [Reference(("part",), self.part, (SolidSpec,))]
        for path, pair in self.paired():
            found.append(Reference((*path, "from"), part_of(pair.from_), (SolidSpec,)))
            found.append(Reference((*path, "to"), part_of(pair.to), (SolidSpec,)))
        return tuple(found)

    def uses(self) -> Iterator[Use]:
        """The features of the pairs."""
        for path, pair in self.paired():
            yield Use((*path, "from"), pair.from_)
            yield Use((*path, "to"), pair.to)


def fixed_parts(moves: Mapping[str, Any]) -> Sequence[str]:
    """Parts that moves of a scene hold in the world."""
    return [part for move in moves.values() if isinstance(move, AssemblyMoveSpec) for part in move.fixed]


class MoveReference(Reference):
    """A move that an entry names."""

    def advice(self, parts: Mapping[str, Any], moves: Mapping[str, Any]) -> str:
        """See Reference: parts that no move places, for one of their moves may have been forgotten."""
        own = [move for move in moves.values() if isinstance(move, AssemblyMoveSpec)]
        placed = {part for move in own for _, part in (*move.parts_placed, *move.joined)}
        lacking = [name for name, part in parts.items() if isinstance(part, SolidSpec) and name not in placed]
        if not lacking:
            return ""
        return f"; no move places {lacking[0]!r}: {how_to_place(lacking[0], moves)}"


def how_to_place(part: str, moves: Mapping[str, Any]) -> str:
    """The move to add for a part: the first one is fixed, others are laid on it."""
    if not fixed_parts(moves):
        return f"add one, such as {{kind: fix, part: {part}}}"
    kinds = "three_two_one, six_plane, best_fit, mate, touch, rest, pin_and_hole or pattern"
    return f"add one of part: {part}, of kind {kinds}, or fix where it stays as it is `placed`"
