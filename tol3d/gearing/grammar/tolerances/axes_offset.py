"""Offset of the axes of a bevel mesh."""

from typing import TYPE_CHECKING, ClassVar, Literal

from tol3d.gearing.effects import AxesOffset
from tol3d.gearing.grammar.moves import BevelMeshSpec
from tol3d.gearing.grammar.tolerances.gearing_tolerance import Meaning
from tol3d.gearing.grammar.tolerances.mesh_tolerance import MeshToleranceSpec
from tol3d.scene.entry import Entry

if TYPE_CHECKING:
    from tol3d.gearing.model.nominal import Nominal


class AxesOffsetSpec(MeshToleranceSpec):
    """f_a, a length: the axes pass each other by it; the driven one lies at +y of the mesh's world."""

    applies_to: ClassVar[tuple[type[Entry], ...]] = (BevelMeshSpec,)

    kind: Literal["axes_offset"]

    def meaning(self, nominal: "Nominal") -> Meaning:
        """The driven axis lies at +y of the mesh."""
        return Meaning(AxesOffset(nominal.meshes[self.of].driven, self.of))
