"""Radial clearance of the bearing that carries a gear."""

from collections.abc import Iterator, Mapping
from typing import Annotated, Literal

from pydantic import Discriminator, Field, Tag

from tol3d.scene.direction import FixedAngle, known_word, shape
from tol3d.scene.moves import MESHES, MoveSpec
from tol3d.scene.name import Name
from tol3d.scene.parts import PartSpec
from tol3d.scene.reference import Contradiction, Reference
from tol3d.scene.tolerances.tolerance import GearToleranceSpec

WORDS = ("apart", "random", "tooth_force")


class BearingClearanceSpec(GearToleranceSpec):
    """Delta b, a length on the diameter: the gear's axis moves by Delta b / 2.

    `apart` moves it away from the mate along the line of centres (positive opens), `tooth_force` along
    the force on its working flank, `{at: angle}` at an azimuth of the gear's frame at rest, `random` anywhere.
    """

    kind: Literal["bearing_clearance"]
    mesh: Name | None = Field(default=None, description="the mesh it acts in; needed where the gear is in several")
    direction: Annotated[
        Annotated[Literal["apart", "random", "tooth_force"], Tag("word")] | FixedAngle,
        Discriminator(shape),
        known_word(*WORDS),
    ] = Field(default="apart", description="which way the axis moves")

    def references(self) -> tuple[Reference, ...]:
        """The gear, and the mesh if it is given."""
        gear = super().references()
        return gear if self.mesh is None else (*gear, Reference(("mesh",), self.mesh, MESHES))

    def contradictions(self, parts: Mapping[str, PartSpec], moves: Mapping[str, MoveSpec]) -> Iterator[Contradiction]:
        """The gear takes part in the mesh, or in one mesh only."""
        meshes = tuple(name for name, move in moves.items() if self.of in move.gears)
        if self.mesh is not None and self.mesh not in meshes:
            yield Contradiction(("mesh",), f"a mesh of the gear {self.of!r}", repr(self.mesh), meshes)
        elif self.mesh is None and len(meshes) != 1:
            yield Contradiction(
                ("of",), "a gear of one mesh (or the mesh named beside it)", f"{self.of!r}, which is in {len(meshes)}"
            )
