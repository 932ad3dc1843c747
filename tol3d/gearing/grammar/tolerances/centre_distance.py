"""Deviation of a mesh's centre distance."""

from typing import TYPE_CHECKING, Literal

from tol3d.gearing.effects import AxisOffset
from tol3d.gearing.grammar.tolerances.gearing_tolerance import Meaning
from tol3d.gearing.grammar.tolerances.mesh_tolerance import MeshToleranceSpec

if TYPE_CHECKING:
    from tol3d.gearing.model.nominal import Nominal


class CentreDistanceSpec(MeshToleranceSpec):
    """f_a, a length: added to the centre distance, positive opens."""

    kind: Literal["centre_distance"]

    def meaning(self, nominal: "Nominal") -> Meaning:
        """The driven axis lies further along +x of the mesh."""
        return Meaning(AxisOffset(nominal.meshes[self.of].driven, (1.0, 0.0, 0.0), mesh=self.of))
