"""A box with holes and slots in any of its faces, and pins."""

from collections.abc import Mapping
from typing import ClassVar, Literal

from pydantic import Field

from tol3d.assembly.grammar.builders.builder_spec import BuilderSpec
from tol3d.assembly.grammar.builders.details import HoleSpec, PinSpec, SlotSpec
from tol3d.assembly.grammar.feature_name import OwnName
from tol3d.scene.part import Length
from tol3d.solids.machined import Block

Face = Literal["top", "bottom", "left", "right", "front", "back"]


class BlockHoleSpec(HoleSpec):
    """A hole in a face."""

    face: Face = Field(default="top", description="that it is drilled into")


class BlockSlotSpec(SlotSpec):
    """A slot in a face."""

    face: Face = Field(default="top", description="that it is milled into")


class BlockSpec(BuilderSpec):
    """A box; its part's origin is the middle of its bottom."""

    words: ClassVar[str] = "a block"

    kind: Literal["block"]
    length: Length = Field(description="along x")
    width: Length = Field(description="along y")
    height: Length = Field(description="along z")
    holes: Mapping[OwnName, BlockHoleSpec] = Field(default_factory=dict, description="in its faces")
    slots: Mapping[OwnName, BlockSlotSpec] = Field(default_factory=dict, description="in its faces")
    pins: Mapping[OwnName, PinSpec] = Field(default_factory=dict, description="on its top")

    @property
    def shape(self) -> Block:
        """See BuilderSpec."""
        return Block(
            self.length.internal,
            self.width.internal,
            self.height.internal,
            tuple(hole.named(name, hole.face) for name, hole in self.holes.items()),
            tuple(slot.named(name, slot.face) for name, slot in self.slots.items()),
            tuple(pin.named(name) for name, pin in self.pins.items()),
        )
