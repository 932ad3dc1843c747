"""Kinds of tolerance, by their names on drawings, one file each."""

from tol3d.assembly.grammar.tolerances.feature_tolerance import FeatureTolerance
from tol3d.assembly.grammar.tolerances.form import FlatnessSpec, StraightnessSpec
from tol3d.assembly.grammar.tolerances.location import (
    CoaxialitySpec,
    LocationSpec,
    PositionSpec,
    ProfileSpec,
    SymmetrySpec,
)
from tol3d.assembly.grammar.tolerances.locator import LocatorSpec
from tol3d.assembly.grammar.tolerances.orientation import (
    AngularitySpec,
    OrientationSpec,
    ParallelismSpec,
    PerpendicularitySpec,
)
from tol3d.assembly.grammar.tolerances.plus_minus import PlusMinusSpec
from tol3d.assembly.grammar.tolerances.run_out import CircularRunOutSpec, TotalRunOutSpec
from tol3d.assembly.grammar.tolerances.size import SizeSpec

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
