"""Deviation of the driven axis from parallel, out of the plane of the axes."""

from typing import TYPE_CHECKING, ClassVar, Literal

from tol3d.gearing.effects import AxisTilt
from tol3d.gearing.grammar.tolerances.gearing_tolerance import Meaning
from tol3d.gearing.grammar.tolerances.mesh_tolerance import MeshToleranceSpec
from tol3d.units import Dimension

if TYPE_CHECKING:
    from tol3d.gearing.model.nominal import Nominal


class AxisOutOfPlaneSpec(MeshToleranceSpec):
    """f_beta, out of the plane of the axes: the driven axis turns about +x, about its face centre.

    An angle, or a length over the smaller face width. Source: ISO/TR 10064-3.
    """

    dimensions: ClassVar[tuple[Dimension, ...]] = ("length", "angle")

    kind: Literal["axis_out_of_plane"]

    def meaning(self, nominal: "Nominal") -> Meaning:
        """The driven axis turns about x."""
        per_length = 1.0 if self.unit == "mrad" else 1.0 / nominal.smaller_face_width(self.of)
        return Meaning(AxisTilt(nominal.meshes[self.of].driven, (1.0, 0.0, 0.0), per_length=per_length, mesh=self.of))
