"""Helix slope deviations of a spur gear's flanks."""

from typing import Literal

from pydantic import Field

from tol3d.gearing.effects import HELIX, FlankDeviation
from tol3d.gearing.grammar.tolerances.evaluation_range import Range, face_part
from tol3d.gearing.grammar.tolerances.flank_shape import FlankShapeSpec
from tol3d.gears import SpurGear
from tol3d.gears.iso1328 import FlankTolerances


class HelixSlopeSpec(FlankShapeSpec):
    """f_Hbeta, a length: by so much more the flank stands out at the upper end of its face than at the lower one.

    Linear in the gear's z over the whole face width, 0 in its middle, or in that of a range that is stated.
    """

    kind: Literal["helix_slope"]
    range: Range | None = Field(
        default=None, description="heights over the lower end of the face it counts between; by default the whole face"
    )

    def of_class(self, limits: FlankTolerances) -> float:
        """See FlankShapeSpec."""
        return limits.helix_slope

    def effect(self, gear: SpurGear, active_roll: float) -> FlankDeviation:
        """See FlankToleranceSpec."""
        level, times = face_part(self.range, gear).slope
        return FlankDeviation(self.of, HELIX, self.places(gear), mix=(level, 0.0, 0.0, times))
