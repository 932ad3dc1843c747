"""Two legs that make an L, with holes."""

from collections.abc import Mapping
from typing import ClassVar, Literal

from pydantic import Field

from tol3d.assembly.grammar.builders.builder_spec import BuilderSpec
from tol3d.assembly.grammar.builders.details import HoleSpec
from tol3d.assembly.grammar.feature_name import OwnName
from tol3d.scene.part import Length
from tol3d.solids.machined import Bracket


class BracketHoleSpec(HoleSpec):
    """A hole in a leg."""

    face: Literal["base outside", "base inside", "upright outside", "upright inside"] = Field(
        description="of the leg, that it is drilled into"
    )


class BracketSpec(BuilderSpec):
    """A base along x and an upright along z; its part's origin is the middle of the outer edge that they share."""

    words: ClassVar[str] = "a bracket"

    kind: Literal["bracket"]
    length: Length = Field(description="of the base, along x")
    height: Length = Field(description="of the upright, along z")
    width: Length = Field(description="along y")
    thickness: Length = Field(description="of both legs")
    fillet: Length | None = Field(default=None, description="radius between the legs inside; none if not given")
    holes: Mapping[OwnName, BracketHoleSpec] = Field(default_factory=dict, description="in either leg")

    @property
    def shape(self) -> Bracket:
        """See BuilderSpec."""
        return Bracket(
            self.length.internal,
            self.height.internal,
            self.width.internal,
            self.thickness.internal,
            0.0 if self.fillet is None else self.fillet.internal,
            tuple(hole.named(name, hole.face) for name, hole in self.holes.items()),
        )
