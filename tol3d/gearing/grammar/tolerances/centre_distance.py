"""Deviation of a mesh's centre distance."""

from typing import TYPE_CHECKING, Literal

from tol3d.gearing.effects import AxisOffset
from tol3d.gearing.grammar.tolerances.gearing_tolerance import Meaning
from tol3d.gearing.grammar.tolerances.mesh_tolerance import MeshToleranceSpec

if TYPE_CHECKING:
    from tol3d.gearing.model.nominal import Nominal


class CentreDistanceSpec(MeshToleranceSpec):
    """f_a, a length: added to the centre distance; positive opens, but closes a pair with an internal gear."""

    kind: Literal["centre_distance"]

    def meaning(self, nominal: "Nominal") -> Meaning:
        """The driven axis lies further from the driver's."""
        mesh = nominal.meshes[self.of]
        onwards = 1.0 if mesh.pair.wheel_origin[0] > 0.0 else -1.0
        return Meaning(AxisOffset(mesh.driven, (onwards, 0.0, 0.0), mesh=self.of))
