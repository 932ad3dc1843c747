"""Tolerances of the relative position of a mesh's axes."""

import math
from collections.abc import Mapping
from typing import Any, ClassVar, Literal

from pydantic import Field
from typing_extensions import override

from tol3d.gearing.effects import AxesOffset, AxisOffset, AxisTilt
from tol3d.gearing.grammar.moves import BevelMeshSpec
from tol3d.gearing.grammar.tolerances.gearing_tolerance import Meaning, MeshToleranceSpec, Nominal
from tol3d.scene.entry import Entry
from tol3d.units import Dimension, Quantity


class CentreDistanceSpec(MeshToleranceSpec):
    """f_a, a length: added to the centre distance; positive opens, but closes a pair with an internal gear."""

    displaces: ClassVar[bool] = True

    kind: Literal["centre_distance"]

    @override
    def nominal_size(self, parts: Mapping[str, Any], moves: Mapping[str, Any]) -> Quantity | None:
        stated: Quantity | None = getattr(moves[self.of], "centre_distance", None)
        return super().nominal_size(parts, moves) or stated

    def meaning(self, nominal: Nominal) -> Meaning:
        """The driven axis lies further from the driver's."""
        mesh = nominal.meshes[self.of]
        onwards = 1.0 if mesh.pair.wheel_origin[0] > 0.0 else -1.0
        return Meaning(AxisOffset(mesh.driven, (onwards, 0.0, 0.0), mesh=self.of))


class AxisInPlaneSpec(MeshToleranceSpec):
    """f_delta, in the plane of the axes: the driven axis turns about +y, about its face centre.

    An angle, or a length over the smaller face width. Source: ISO/TR 10064-3.
    """

    dimensions: ClassVar[tuple[Dimension, ...]] = ("length", "angle")

    kind: Literal["axis_in_plane"]

    nominal: ClassVar[str] = ""  # axes are drawn parallel

    def meaning(self, nominal: Nominal) -> Meaning:
        """The driven axis turns about y."""
        per_length = 1.0 if self.unit == "mrad" else 1.0 / nominal.smaller_face_width(self.of)
        return Meaning(AxisTilt(nominal.meshes[self.of].driven, (0.0, 1.0, 0.0), per_length=per_length, mesh=self.of))


class AxisOutOfPlaneSpec(MeshToleranceSpec):
    """f_beta, out of the plane of the axes: the driven axis turns about +x, about its face centre.

    An angle, or a length over the smaller face width. Source: ISO/TR 10064-3.
    """

    dimensions: ClassVar[tuple[Dimension, ...]] = ("length", "angle")

    kind: Literal["axis_out_of_plane"]

    nominal: ClassVar[str] = ""  # axes are drawn parallel

    def meaning(self, nominal: Nominal) -> Meaning:
        """The driven axis turns about x."""
        per_length = 1.0 if self.unit == "mrad" else 1.0 / nominal.smaller_face_width(self.of)
        return Meaning(AxisTilt(nominal.meshes[self.of].driven, (1.0, 0.0, 0.0), per_length=per_length, mesh=self.of))


class AxesOffsetSpec(MeshToleranceSpec):
    """f_a, a length: the axes pass each other by it; the driven one lies at +y of the mesh's world."""

    displaces: ClassVar[bool] = True
    applies_to: ClassVar[tuple[type[Entry], ...]] = (BevelMeshSpec,)

    kind: Literal["axes_offset"]

    def meaning(self, nominal: Nominal) -> Meaning:
        """The driven axis lies at +y of the mesh."""
        return Meaning(AxesOffset(nominal.meshes[self.of].driven, self.of))


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

    def meaning(self, nominal: Nominal) -> Meaning:
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
