"""Two spur gears on parallel axes, or one inside an internal gear."""

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from tol3d.gearing.grammar.moves.gear_mesh import GearMeshSpec
from tol3d.gearing.grammar.parts import GearSpec, HousingSpec, InternalGearSpec, SpurGearSpec
from tol3d.scene.name import Name
from tol3d.scene.reference import Reference
from tol3d.units import Of, Positive, Quantity


class MeshSpec(GearMeshSpec):
    """A mesh: its world has the driver's axis as z, and the teeth meet at +x.

    The driven axis lies at the centre distance, at +x; that of a driven internal gear at -x, for it is around its mate.
    """

    words: ClassVar[str] = "a mesh of spur gears"
    gear_specs: ClassVar[tuple[type[GearSpec], ...]] = (SpurGearSpec, InternalGearSpec)

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
