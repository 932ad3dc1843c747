"""A cover for an opening, with a spigot that reaches into it."""

from collections.abc import Mapping
from typing import ClassVar, Literal

from pydantic import Field

from tol3d.assembly.grammar.builders.builder_spec import BuilderSpec, Place, place
from tol3d.assembly.grammar.builders.details import HoleSpec, SlotSpec
from tol3d.assembly.grammar.feature_name import OwnName
from tol3d.parts.details import Spigot
from tol3d.scene.part import Length
from tol3d.solids.machined import Cover
from tol3d.strict import Strict


class SpigotSpec(Strict):
    """A rectangular register below the seat."""

    at: Place | None = Field(default=None, description="its middle; that of the seat if not given")
    length: Length = Field(description="along x")
    width: Length = Field(description="along y")
    height: Length = Field(description="below the seat")

    @property
    def shape(self) -> Spigot:
        """By numbers."""
        at = (0.0, 0.0) if self.at is None else place(self.at)
        return Spigot(self.length.internal, self.width.internal, self.height.internal, at)


class CoverSpec(BuilderSpec):
    """A plate; its part's origin is the middle of its seat, below which its spigot is."""

    words: ClassVar[str] = "a cover"

    kind: Literal["cover"]
    length: Length = Field(description="along x")
    width: Length = Field(description="along y")
    thickness: Length = Field(description="along z, without the spigot")
    holes: Mapping[OwnName, HoleSpec] = Field(default_factory=dict, description="from its top")
    slots: Mapping[OwnName, SlotSpec] = Field(default_factory=dict, description="from its top")
    spigot: SpigotSpec | None = Field(default=None, description="none if not given")

    @property
    def shape(self) -> Cover:
        """See BuilderSpec."""
        return Cover(
            self.length.internal,
            self.width.internal,
            self.thickness.internal,
            tuple(hole.named(name) for name, hole in self.holes.items()),
            None if self.spigot is None else self.spigot.shape,
            tuple(slot.named(name) for name, slot in self.slots.items()),
        )
