"""Angular backlash of a mesh, the lost motion of one of its gears."""

from collections.abc import Iterator, Mapping
from typing import ClassVar, Literal

from pydantic import Field

from tol3d.gearing.grammar.measures.mesh_measure import MeshMeasureSpec
from tol3d.gearing.grammar.moves import GearMeshSpec
from tol3d.gearing.grammar.parts import GearSpec
from tol3d.scene.measure import AngleLimit
from tol3d.scene.move import MoveSpec
from tol3d.scene.name import Name
from tol3d.scene.part import PartSpec
from tol3d.scene.reference import Contradiction, Reference
from tol3d.units import Dimension


class AngularBacklashSpec(MeshMeasureSpec):
    """An angle: the free turn of one gear while its mate is held."""

    dimension: ClassVar[Dimension] = "angle"

    kind: Literal["angular_backlash"]
    gear: Name | None = Field(default=None, description="the gear that turns; the driven one if not given")
    lower_limit: AngleLimit | None = Field(default=None, description="less than this is out of limits")
    upper_limit: AngleLimit | None = Field(default=None, description="more than this is out of limits")

    def references(self) -> tuple[Reference, ...]:
        """The mesh, and the gear if it is given."""
        mesh = super().references()
        return mesh if self.gear is None else (*mesh, Reference(("gear",), self.gear, (GearSpec,)))

    def contradictions(self, parts: Mapping[str, PartSpec], moves: Mapping[str, MoveSpec]) -> Iterator[Contradiction]:
        """The gear takes part in the mesh."""
        mesh = moves[self.of]
        if isinstance(mesh, GearMeshSpec) and self.gear is not None and self.gear not in mesh.gears:
            yield Contradiction(("gear",), f"a gear of the mesh {self.of!r}", repr(self.gear), mesh.gears)
