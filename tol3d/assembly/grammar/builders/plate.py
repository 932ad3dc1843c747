"""A plate with holes, slots and pins."""

from collections.abc import Mapping
from typing import ClassVar, Literal

from pydantic import Field

from tol3d.assembly.grammar.builders.builder_spec import BuilderSpec
from tol3d.assembly.grammar.builders.details import HoleSpec, PinSpec, SlotSpec
from tol3d.assembly.grammar.feature_name import OwnName
from tol3d.scene.part import Length
from tol3d.solids.machined import Plate


class PlateSpec(BuilderSpec):
    """A plate; its part's origin is the middle of its bottom."""

    words: ClassVar[str] = "a plate"

    kind: Literal["plate"]
    length: Length = Field(description="along x")
    width: Length = Field(description="along y")
    thickness: Length = Field(description="along z")
    holes: Mapping[OwnName, HoleSpec] = Field(default_factory=dict, description="from its top")
    slots: Mapping[OwnName, SlotSpec] = Field(default_factory=dict, description="from its top")
    pins: Mapping[OwnName, PinSpec] = Field(default_factory=dict, description="on its top")

    @property
    def shape(self) -> Plate:
        """See BuilderSpec."""
        return Plate(
            self.length.internal,
            self.width.internal,
            self.thickness.internal,
            tuple(hole.named(name) for name, hole in self.holes.items()),
            tuple(slot.named(name) for name, slot in self.slots.items()),
            tuple(pin.named(name) for name, pin in self.pins.items()),
        )
