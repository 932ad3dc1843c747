"""A gearbox's housing: a box open at its top or its front, with bores for shafts along z."""

from collections.abc import Mapping
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from tol3d.assembly.grammar.builders.builder_spec import BuilderSpec, Place, place
from tol3d.assembly.grammar.builders.details import HoleSpec, PinSpec
from tol3d.assembly.grammar.feature_name import OwnName
from tol3d.parts.details import Bore, Boss
from tol3d.scene.part import Length
from tol3d.scene.vector import Vector, three
from tol3d.solids.machined import Housing
from tol3d.strict import Strict

EndWall = Literal["front", "back"]


class BoreSpec(Strict):
    """A bore through an end wall, and through the boss that it lies in."""

    at: Place = Field(description="x and y of its axis")
    diameter: Length
    wall: EndWall = Field(description="the one at +z is the front")


class BossSpec(Strict):
    """A round boss on the outside of an end wall."""

    at: Place = Field(description="x and y of its axis")
    diameter: Length
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
    floor: Length | None = Field(default=None, description="thickness of the floor; that of the walls if not given")
    bores: Mapping[OwnName, BoreSpec] = Field(default_factory=dict, description="in its end walls")
    bosses: Mapping[OwnName, BossSpec] = Field(default_factory=dict, description="on its end walls")
    holes: Mapping[OwnName, HousingHoleSpec] = Field(default_factory=dict, description="in its rim or its walls")
    pins: Mapping[OwnName, PinSpec] = Field(default_factory=dict, description="on its rim")

    @property
    def shape(self) -> Housing:
        """See BuilderSpec."""
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
