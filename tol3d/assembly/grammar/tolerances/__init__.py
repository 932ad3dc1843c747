"""Kinds of tolerance by their names on drawings: every class with a word is one, in whatever file it is."""

from tol3d.assembly.grammar.tolerances.feature_tolerance import FeatureTolerance
from tol3d.assembly.grammar.tolerances.location import (
    AngularitySpec,
    CircularRunOutSpec,
    CoaxialitySpec,
    FlatnessSpec,
    LocationSpec,
    OrientationSpec,
    ParallelismSpec,
    PerpendicularitySpec,
    PositionSpec,
    ProfileSpec,
    StraightnessSpec,
    SymmetrySpec,
    TotalRunOutSpec,
)
from tol3d.assembly.grammar.tolerances.plus_minus import LocatorSpec, PlusMinusSpec, SizeSpec

__all__ = [
    "AngularitySpec",
    "CircularRunOutSpec",
    "CoaxialitySpec",
    "FeatureTolerance",
    "FlatnessSpec",
    "LocationSpec",
    "LocatorSpec",
    "OrientationSpec",
    "ParallelismSpec",
    "PerpendicularitySpec",
    "PlusMinusSpec",
    "PositionSpec",
    "ProfileSpec",
    "SizeSpec",
    "StraightnessSpec",
    "SymmetrySpec",
    "TotalRunOutSpec",
]
