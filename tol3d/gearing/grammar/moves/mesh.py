"""Two spur gears on parallel axes."""

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from tol3d.gearing.grammar.moves.gear_mesh import GearMeshSpec
from tol3d.gearing.grammar.parts import GearSpec, HousingSpec, SpurGearSpec
from tol3d.scene.name import Name
from tol3d.scene.reference import Reference
from tol3d.units import Of, Positive, Quantity


class MeshSpec(GearMeshSpec):
    """A mesh: its world has the driver's axis as z and the driven axis at +x, at the centre distance."""

    words: ClassVar[str] = "a mesh of spur gears"
    gear_specs: ClassVar[tuple[type[GearSpec], ...]] = (SpurGearSpec,)

    kind: Literal["mesh"]
    centre_distance: Annotated[Quantity, Of("length"), Positive()] | None = Field(
        default=None,
        description="nominal distance of the axes; left out only where both shafts lie in bores, from which it follows",
    )
    housing: Name | None = Field(default=None, description="the housing whose expansion changes the centre distance")

    def references(self) -> tuple[Reference, ...]:
        """Two gears, and the housing if there is one."""
        gears = super().references()
        return gears if self.housing is None else (*gears, Reference(("housing",), self.housing, (HousingSpec,)))
