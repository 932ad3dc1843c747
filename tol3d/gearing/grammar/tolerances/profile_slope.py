"""Profile slope deviations of a spur gear's flanks."""

from typing import Literal

from tol3d.gearing.effects import SLOPE, FlankDeviation
from tol3d.gearing.grammar.tolerances.flank_shape import FlankShapeSpec
from tol3d.gears import SpurGear
from tol3d.gears.iso1328 import FlankTolerances


class ProfileSlopeSpec(FlankShapeSpec):
    """f_Halpha, a length: by so much more the flank stands out at its tip than where its involute begins.

    Linear in the roll over the whole involute, 0 in its middle.
    """

    kind: Literal["profile_slope"]

    def of_class(self, limits: FlankTolerances) -> float:
        """See FlankShapeSpec."""
        return limits.profile_slope

    def effect(self, gear: SpurGear) -> FlankDeviation:
        """See FlankToleranceSpec."""
        return self.deviation(gear, SLOPE)
