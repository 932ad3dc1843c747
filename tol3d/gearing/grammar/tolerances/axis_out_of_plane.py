"""Deviation of the driven axis from parallel, out of the plane of the axes."""

from typing import ClassVar, Literal

from tol3d.gearing.grammar.tolerances.mesh_tolerance import MeshToleranceSpec
from tol3d.units import Dimension


class AxisOutOfPlaneSpec(MeshToleranceSpec):
    """f_beta, out of the plane of the axes: the driven axis turns about +x, about its face centre.

    An angle, or a length over the smaller face width. Source: ISO/TR 10064-3.
    """

    dimensions: ClassVar[tuple[Dimension, ...]] = ("length", "angle")

    kind: Literal["axis_out_of_plane"]
