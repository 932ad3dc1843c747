"""Profile slope deviations of a spur gear's flanks."""

from typing import Literal

from pydantic import Field

from tol3d.gearing.effects import SLOPE, FlankDeviation
from tol3d.gearing.grammar.tolerances.evaluation_range import Range, profile_part
from tol3d.gearing.grammar.tolerances.flank_shape import FlankShapeSpec
from tol3d.gears import SpurGear
from tol3d.gears.iso1328 import FlankTolerances


class ProfileSlopeSpec(FlankShapeSpec):
    """f_Halpha, a length: by so much more the flank stands out at its tip than where its active profile begins.

    Linear in the roll over the whole involute, 0 in the middle between both, or of a range that is stated.
    """

    kind: Literal["profile_slope"]
    range: Range | None = Field(
        default=None, description="diameters it counts between; by default from the active profile's begin to the tip"
    )

    def of_class(self, limits: FlankTolerances) -> float:
        """See FlankShapeSpec."""
        return limits.profile_slope

    def effect(self, gear: SpurGear, active_roll: float) -> FlankDeviation:
        """See FlankToleranceSpec."""
        mix = profile_part(self.range, gear, active_roll, 1.0).slope
        return FlankDeviation(self.of, SLOPE, self.places(gear), mix=mix)
