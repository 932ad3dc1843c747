"""Kinds of measure, one file each."""

from tol3d.assembly.grammar.measures.assembly_measure import AssemblyMeasureSpec
from tol3d.assembly.grammar.measures.clearance import ClearanceSpec, SlackSpec, VirtualClearanceSpec
from tol3d.assembly.grammar.measures.contact import ContactAngleSpec, SurfaceGapSpec
from tol3d.assembly.grammar.measures.gap import AngleSpec, DistanceSpec, FlushSpec, GapSpec, PointPlaneSpec
from tol3d.assembly.grammar.measures.inspected import (
    InspectedFlatnessSpec,
    InspectedOrientationSpec,
    InspectedPatternSpec,
    InspectedPositionSpec,
    InspectedSizeSpec,
)
from tol3d.assembly.grammar.measures.pose_errors import (
    DifferenceSpec,
    DirectionErrorSpec,
    OrientationErrorSpec,
    PoseErrorSpec,
    PositionErrorSpec,
)

__all__ = [
    "AngleSpec",
    "AssemblyMeasureSpec",
    "ClearanceSpec",
    "ContactAngleSpec",
    "DifferenceSpec",
    "DirectionErrorSpec",
    "DistanceSpec",
    "FlushSpec",
    "GapSpec",
    "InspectedFlatnessSpec",
    "InspectedOrientationSpec",
    "InspectedPatternSpec",
    "InspectedPositionSpec",
    "InspectedSizeSpec",
    "OrientationErrorSpec",
    "PointPlaneSpec",
    "PoseErrorSpec",
    "PositionErrorSpec",
    "SlackSpec",
    "SurfaceGapSpec",
    "VirtualClearanceSpec",
]
