"""Normal backlash of a mesh."""

from typing import ClassVar, Literal

from pydantic import Field

from tol3d.gearing.grammar.measures.mesh_measure import MeshMeasureSpec
from tol3d.scene.measure import LengthLimit
from tol3d.units import Dimension


class NormalBacklashSpec(MeshMeasureSpec):
    """j_bn, a length: shortest distance of the non-working flanks while the working flanks touch."""

    dimension: ClassVar[Dimension] = "length"

    kind: Literal["normal_backlash"]
    lower_limit: LengthLimit | None = Field(default=None, description="less than this is out of limits")
    upper_limit: LengthLimit | None = Field(default=None, description="more than this is out of limits")
