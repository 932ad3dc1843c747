"""Deviation of the shaft angle of a bevel mesh."""

from typing import ClassVar, Literal

from pydantic import Field

from tol3d.gearing.grammar.moves import BevelMeshSpec
from tol3d.gearing.grammar.tolerances.mesh_tolerance import MeshToleranceSpec
from tol3d.scene.entry import Entry
from tol3d.units import Dimension


class ShaftAngleSpec(MeshToleranceSpec):
    """E_Sigma: positive is a larger angle. An angle, or a length: its arc at the mean cone distance.

    One gear's axis turns in the plane of the axes, about the common apex or about the middle of its own face.
    """

    applies_to: ClassVar[tuple[type[Entry], ...]] = (BevelMeshSpec,)
    dimensions: ClassVar[tuple[Dimension, ...]] = ("length", "angle")

    kind: Literal["shaft_angle"]
    tilts: Literal["driver", "driven"] = Field(default="driven", description="the gear whose axis turns")
    pivot: Literal["apex", "mean_plane"] = Field(
        default="apex", description="about the apex, or the point of the axis in the middle of the gear's face"
    )
