"""Circumferential backlash of a mesh."""

from typing import ClassVar, Literal

from pydantic import Field

from tol3d.gearing.grammar.measures.mesh_measure import MeshMeasureSpec
from tol3d.scene.measure import LengthLimit
from tol3d.units import Dimension


class CircumferentialBacklashSpec(MeshMeasureSpec):
    """j_wt, a length: the free arc on the working pitch circle."""

    dimension: ClassVar[Dimension] = "length"

    kind: Literal["circumferential_backlash"]
    lower_limit: LengthLimit | None = Field(default=None, description="less than this is out of limits")
    upper_limit: LengthLimit | None = Field(default=None, description="more than this is out of limits")
