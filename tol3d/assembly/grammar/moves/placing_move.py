"""Common base of all moves that place a part."""

from abc import abstractmethod
from collections.abc import Iterator
from typing import ClassVar

from pydantic import Field

from tol3d.assembly.grammar.feature_name import FeatureName, Use, part_of
from tol3d.assembly.grammar.parts import SolidSpec
from tol3d.scene.move import MoveSpec
from tol3d.scene.name import Name
from tol3d.scene.place import KeyPath
from tol3d.scene.reference import Reference
from tol3d.strict import Strict


class PairSpec(Strict):
    """A feature of the part to be placed, and its target on placed parts."""

    from_: FeatureName = Field(alias="from", description="of the part that is placed")
    to: FeatureName = Field(description="of a part that is placed already")


class PlacingSpec(MoveSpec):
    """A move that places a part, and what is welded to it."""

    words: ClassVar[str] = "a move that places a part"

    part: Name = Field(description="the part that is placed")

    @abstractmethod
    def paired(self) -> Iterator[tuple[KeyPath, PairSpec]]:
        """Its pairs with their fields, in order."""

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
