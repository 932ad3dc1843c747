"""Builders of machined parts by their numbers: blocks, plates, brackets, covers, housings."""

from collections.abc import Mapping
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from tol3d.assembly.grammar.builders.builder_spec import BuilderSpec, HoleSpec, PinSpec, Place, SlotSpec, place
from tol3d.assembly.grammar.feature_name import OwnName
from tol3d.cad.solids.numbered_parts import Block, Bracket, Cover, Housing, Plate
from tol3d.parts.details import Bore, Boss, Spigot
from tol3d.scene.bases import Length
from tol3d.scene.vector import Vector, three
from tol3d.strict import Strict

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
        return Block(
            self.length.internal,
            self.width.internal,
            self.height.internal,
            tuple(hole.named(name, hole.face) for name, hole in self.holes.items()),
            tuple(slot.named(name, slot.face) for name, slot in self.slots.items()),
            tuple(pin.named(name) for name, pin in self.pins.items()),
        )


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
        return Plate(
            self.length.internal,
            self.width.internal,
            self.thickness.internal,
            tuple(hole.named(name) for name, hole in self.holes.items()),
            tuple(slot.named(name) for name, slot in self.slots.items()),
            tuple(pin.named(name) for name, pin in self.pins.items()),
        )


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
    fillet: Length | None = Field(default=None, description="radius between the legs inside; default: none")
    holes: Mapping[OwnName, BracketHoleSpec] = Field(default_factory=dict, description="in either leg")

    @property
    def shape(self) -> Bracket:
        return Bracket(
            self.length.internal,
            self.height.internal,
            self.width.internal,
            self.thickness.internal,
            0.0 if self.fillet is None else self.fillet.internal,
            tuple(hole.named(name, hole.face) for name, hole in self.holes.items()),
        )


class SpigotSpec(Strict):
    """A rectangular register below the seat."""

    at: Place | None = Field(default=None, description="its middle; default: that of the seat")
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
    spigot: SpigotSpec | None = Field(default=None, description="default: none")

    @property
    def shape(self) -> Cover:
        return Cover(
            self.length.internal,
            self.width.internal,
            self.thickness.internal,
            tuple(hole.named(name) for name, hole in self.holes.items()),
            None if self.spigot is None else self.spigot.shape,
            tuple(slot.named(name) for name, slot in self.slots.items()),
        )


EndWall = Literal["front", "back"]


class BoreSpec(Strict):
    """A bore through an end wall, and through the boss that it lies in."""

    at: Place = Field(description="x and y of its axis")
    diameter: Length = Field(description="of the bore")
    wall: EndWall = Field(description="the one at +z is the front")


class BossSpec(Strict):
    """A round boss on the outside of an end wall."""

    at: Place = Field(description="x and y of its axis")
    diameter: Length = Field(description="of the boss")
    height: Length = Field(description="above the wall")
    wall: EndWall = Field(description="the one at +z is the front")


class HousingHoleSpec(HoleSpec):
    """A hole in the rim, or in a wall from outside."""

    face: Literal["rim", "top", "bottom", "left", "right", "front", "back"] = Field(
        default="rim", description="that it is drilled into"
    )


class HousingSpec(BuilderSpec):
    """Four walls on a floor, for shafts along z; the rim is round the opening."""

    words: ClassVar[str] = "a housing"

    kind: Literal["housing"]
    corner: Vector = Field(description="its least x, y and z, bosses and pins aside, in the frame of its part")
    size: Annotated[tuple[Length, Length, Length], three("three lengths, such as [200 mm, 150 mm, 80 mm]")] = Field(
        description="outside, along x, y and z"
    )
    opening: Literal["top", "front"] = Field(default="top", description="the top is at +y, the front at +z")
    walls: Length = Field(description="thickness of the four round the opening")
    floor: Length | None = Field(default=None, description="thickness of the floor; default: that of the walls")
    bores: Mapping[OwnName, BoreSpec] = Field(default_factory=dict, description="in its end walls")
    bosses: Mapping[OwnName, BossSpec] = Field(default_factory=dict, description="on its end walls")
    holes: Mapping[OwnName, HousingHoleSpec] = Field(default_factory=dict, description="in its rim or its walls")
    pins: Mapping[OwnName, PinSpec] = Field(default_factory=dict, description="on its rim")

    @property
    def shape(self) -> Housing:
        (x, y, z), (length, height, width) = self.corner, self.size
        return Housing(
            (x.internal, y.internal, z.internal),
            (length.internal, height.internal, width.internal),
            self.walls.internal,
            (self.walls if self.floor is None else self.floor).internal,
            tuple(Bore(name, place(own.at), own.diameter.internal, own.wall) for name, own in self.bores.items()),
            tuple(hole.named(name, hole.face) for name, hole in self.holes.items()),
            tuple(
                Boss(name, place(own.at), own.diameter.internal, own.height.internal, own.wall)
                for name, own in self.bosses.items()
            ),
            tuple(pin.named(name) for name, pin in self.pins.items()),
            self.opening,
        )
