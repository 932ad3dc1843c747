"""Kinds of tolerance, one file each."""

from typing import Annotated

from pydantic import Field

from tol3d.scene.tolerances.axes_offset import AxesOffsetSpec
from tol3d.scene.tolerances.axial_shift import AxialShiftSpec
from tol3d.scene.tolerances.axis_in_plane import AxisInPlaneSpec
from tol3d.scene.tolerances.axis_out_of_plane import AxisOutOfPlaneSpec
from tol3d.scene.tolerances.bearing_clearance import BearingClearanceSpec
from tol3d.scene.tolerances.centre_distance import CentreDistanceSpec
from tol3d.scene.tolerances.clocking import ClockingSpec
from tol3d.scene.tolerances.eccentricity import EccentricitySpec
from tol3d.scene.tolerances.mounting_face import MountingFaceSpec
from tol3d.scene.tolerances.reducer_backlash import ReducerBacklashSpec
from tol3d.scene.tolerances.run_out import RunOutSpec
from tol3d.scene.tolerances.shaft_angle import ShaftAngleSpec
from tol3d.scene.tolerances.shim import ShimSpec
from tol3d.scene.tolerances.temperature import TemperatureSpec
from tol3d.scene.tolerances.tolerance import ToleranceSpec
from tol3d.scene.tolerances.tooth_thickness import ToothThicknessSpec

ToleranceUnion = Annotated[
    ToothThicknessSpec
    | EccentricitySpec
    | RunOutSpec
    | CentreDistanceSpec
    | BearingClearanceSpec
    | ClockingSpec
    | AxisInPlaneSpec
    | AxisOutOfPlaneSpec
    | AxialShiftSpec
    | AxesOffsetSpec
    | MountingFaceSpec
    | ShaftAngleSpec
    | ShimSpec
    | TemperatureSpec
    | ReducerBacklashSpec,
    Field(discriminator="kind"),
]

__all__ = [
    "AxesOffsetSpec",
    "AxialShiftSpec",
    "AxisInPlaneSpec",
    "AxisOutOfPlaneSpec",
    "BearingClearanceSpec",
    "CentreDistanceSpec",
    "ClockingSpec",
    "EccentricitySpec",
    "MountingFaceSpec",
    "ReducerBacklashSpec",
    "RunOutSpec",
    "ShaftAngleSpec",
    "ShimSpec",
    "TemperatureSpec",
    "ToleranceSpec",
    "ToleranceUnion",
    "ToothThicknessSpec",
]
