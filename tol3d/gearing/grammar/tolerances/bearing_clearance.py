"""Radial clearance of a bearing."""

from collections.abc import Iterator, Mapping
from typing import Annotated, ClassVar, Literal

from pydantic import Discriminator, Field, Tag

from tol3d.gearing.grammar.moves import GearMeshSpec, meshes_of
from tol3d.gearing.grammar.parts import BearingSpec, GearSpec, gears_on
from tol3d.gearing.grammar.tolerances.gear_tolerance import GearToleranceSpec
from tol3d.scene.direction import FixedAngle, known_word, shape
from tol3d.scene.entry import Entry
from tol3d.scene.move import MoveSpec
from tol3d.scene.name import Name
from tol3d.scene.part import PartSpec
from tol3d.scene.reference import Contradiction, Reference

WORDS = ("apart", "random", "tooth_force")


class BearingClearanceSpec(GearToleranceSpec):
    """Delta b, a length on the diameter: the axis of the gear, or of the bearing's shaft, moves by Delta b / 2.

    `apart` moves it away from the mate along the line of centres (positive opens), `tooth_force` along
    the force on its working flank, `{at: angle}` at an azimuth of the frame of gear or shaft at rest, `random`
    anywhere. Of a bearing, the first two are those of the gear on its shaft that the mesh is of.
    """

    applies_to: ClassVar[tuple[type[Entry], ...]] = (GearSpec, BearingSpec)

    kind: Literal["bearing_clearance"]
    of: Name = Field(description="the gear that the bearing carries, or a bearing")
    mesh: Name | None = Field(
        default=None,
        description="the mesh whose line of centres or tooth force tells the direction; needed where the gear is in "
        "several, and for a bearing whose direction is apart or tooth_force",
    )
    direction: Annotated[
        Annotated[Literal["apart", "random", "tooth_force"], Tag("word")] | FixedAngle,
        Discriminator(shape),
        known_word(*WORDS),
    ] = Field(default="apart", description="which way the axis moves")

    def references(self) -> tuple[Reference, ...]:
        """The gear or bearing, and the mesh if it is given."""
        carried = super().references()
        return carried if self.mesh is None else (*carried, Reference(("mesh",), self.mesh, (GearMeshSpec,)))

    def contradictions(self, parts: Mapping[str, PartSpec], moves: Mapping[str, MoveSpec]) -> Iterator[Contradiction]:
        """The gear takes part in the mesh, or in one mesh only; so does a gear on the bearing's shaft."""
        part = parts[self.of]
        return self._of_bearing(part, parts, moves) if isinstance(part, BearingSpec) else self._of_gear(moves)

    def _of_gear(self, moves: Mapping[str, MoveSpec]) -> Iterator[Contradiction]:
        meshes = meshes_of(self.of, moves)
        if self.mesh is not None and self.mesh not in meshes:
            yield Contradiction(("mesh",), f"a mesh of the gear {self.of!r}", repr(self.mesh), meshes)
        elif self.mesh is None and len(meshes) != 1:
            yield Contradiction(
                ("of",), "a gear of one mesh (or the mesh named beside it)", f"{self.of!r}, which is in {len(meshes)}"
            )

    def _of_bearing(
        self, bearing: BearingSpec, parts: Mapping[str, PartSpec], moves: Mapping[str, MoveSpec]
    ) -> Iterator[Contradiction]:
        gears = gears_on(bearing.shaft, parts)
        through = {mesh for gear in gears for mesh in meshes_of(gear, moves)}
        meshes = tuple(name for name in moves if name in through)
        if self.mesh is not None and self.mesh not in meshes:
            yield Contradiction(("mesh",), f"a mesh of a gear on {bearing.shaft!r}", repr(self.mesh), meshes)
        elif self.mesh is None and self.direction in ("apart", "tooth_force"):
            yield Contradiction(
                ("mesh",), f"the mesh that a bearing's direction: {self.direction} is of", "none", meshes
            )
