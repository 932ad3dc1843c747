"""Deviation of the shaft angle of a bevel mesh."""

import math
from typing import TYPE_CHECKING, ClassVar, Literal

from pydantic import Field

from tol3d.gearing.effects import AxisTilt
from tol3d.gearing.grammar.moves import BevelMeshSpec
from tol3d.gearing.grammar.tolerances.gearing_tolerance import Meaning
from tol3d.gearing.grammar.tolerances.mesh_tolerance import MeshToleranceSpec
from tol3d.scene.entry import Entry
from tol3d.units import Dimension

if TYPE_CHECKING:
    from tol3d.gearing.model.nominal import Nominal


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

    def meaning(self, nominal: "Nominal") -> Meaning:
        """Each gear sees the other one's axis on its +x side, so a turn about its -y opens the angle."""
        mesh, pair = nominal.meshes[self.of], nominal.bevel_pair(self.of)
        part, gear = (mesh.driver, pair.pinion) if self.tilts == "driver" else (mesh.driven, pair.wheel)
        tilt = AxisTilt(
            part,
            (0.0, -1.0, 0.0),
            per_length=1.0 if self.unit == "mrad" else 1.0 / pair.mean_cone_distance,
            pivot=0.0 if self.pivot == "apex" else gear.mean_cone_distance * math.cos(gear.pitch_angle),
            mesh=self.of,
        )
        return Meaning(tilt)
