"""Kinds of tolerance, one file each."""

from tol3d.gearing.grammar.tolerances.axes_offset import AxesOffsetSpec
from tol3d.gearing.grammar.tolerances.axial_shift import AxialShiftSpec
from tol3d.gearing.grammar.tolerances.axis_in_plane import AxisInPlaneSpec
from tol3d.gearing.grammar.tolerances.axis_out_of_plane import AxisOutOfPlaneSpec
from tol3d.gearing.grammar.tolerances.bearing_clearance import BearingClearanceSpec
from tol3d.gearing.grammar.tolerances.centre_distance import CentreDistanceSpec
from tol3d.gearing.grammar.tolerances.clocking import ClockingSpec
from tol3d.gearing.grammar.tolerances.eccentricity import EccentricitySpec
from tol3d.gearing.grammar.tolerances.flank_tolerance import FlankToleranceSpec
from tol3d.gearing.grammar.tolerances.helix_slope import HelixSlopeSpec
from tol3d.gearing.grammar.tolerances.mounting_face import MountingFaceSpec
from tol3d.gearing.grammar.tolerances.pitch_deviation import PitchDeviationSpec
from tol3d.gearing.grammar.tolerances.profile_form import ProfileFormSpec
from tol3d.gearing.grammar.tolerances.profile_slope import ProfileSlopeSpec
from tol3d.gearing.grammar.tolerances.reducer_backlash import ReducerBacklashSpec
from tol3d.gearing.grammar.tolerances.run_out import RunOutSpec
from tol3d.gearing.grammar.tolerances.shaft_angle import ShaftAngleSpec
from tol3d.gearing.grammar.tolerances.shim import ShimSpec
from tol3d.gearing.grammar.tolerances.tooth_thickness import ToothThicknessSpec
from tol3d.scene.temperature import TemperatureSpec
from tol3d.scene.tolerance import ToleranceSpec

__all__ = [
    "AxesOffsetSpec",
    "AxialShiftSpec",
    "AxisInPlaneSpec",
    "AxisOutOfPlaneSpec",
    "BearingClearanceSpec",
    "CentreDistanceSpec",
    "ClockingSpec",
    "EccentricitySpec",
    "FlankToleranceSpec",
    "HelixSlopeSpec",
    "MountingFaceSpec",
    "PitchDeviationSpec",
    "ProfileFormSpec",
    "ProfileSlopeSpec",
    "ReducerBacklashSpec",
    "RunOutSpec",
    "ShaftAngleSpec",
    "ShimSpec",
    "TemperatureSpec",
    "ToleranceSpec",
    "ToothThicknessSpec",
]
