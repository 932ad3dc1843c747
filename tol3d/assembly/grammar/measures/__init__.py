"""Kinds of measure, one file each."""

from tol3d.assembly.grammar.measures.angle import AngleSpec
from tol3d.assembly.grammar.measures.assembly_measure import AssemblyMeasureSpec
from tol3d.assembly.grammar.measures.clearance import ClearanceSpec
from tol3d.assembly.grammar.measures.contact import ContactAngleSpec, SurfaceGapSpec
from tol3d.assembly.grammar.measures.difference import DifferenceSpec
from tol3d.assembly.grammar.measures.gap import DistanceSpec, FlushSpec, GapSpec, PointPlaneSpec
from tol3d.assembly.grammar.measures.inspected import (
    InspectedFlatnessSpec,
    InspectedOrientationSpec,
    InspectedPositionSpec,
)
from tol3d.assembly.grammar.measures.inspected_pattern import InspectedPatternSpec
from tol3d.assembly.grammar.measures.inspected_size import InspectedSizeSpec
from tol3d.assembly.grammar.measures.pose_errors import (
    DirectionErrorSpec,
    OrientationErrorSpec,
    PoseErrorSpec,
    PositionErrorSpec,
)
from tol3d.assembly.grammar.measures.slack import SlackSpec
from tol3d.assembly.grammar.measures.virtual_clearance import VirtualClearanceSpec

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
