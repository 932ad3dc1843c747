"""Deviation of the driven axis from parallel, in the plane of the axes."""

from typing import ClassVar, Literal

from tol3d.gearing.grammar.tolerances.mesh_tolerance import MeshToleranceSpec
from tol3d.units import Dimension


class AxisInPlaneSpec(MeshToleranceSpec):
    """f_delta, in the plane of the axes: the driven axis turns about +y, about its face centre.

    An angle, or a length over the smaller face width. Source: ISO/TR 10064-3.
    """

    dimensions: ClassVar[tuple[Dimension, ...]] = ("length", "angle")

    kind: Literal["axis_in_plane"]
