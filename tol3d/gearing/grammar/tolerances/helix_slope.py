"""Helix slope deviations of a spur gear's flanks."""

from typing import Literal

from tol3d.gearing.effects import HELIX, FlankDeviation
from tol3d.gearing.grammar.tolerances.flank_shape import FlankShapeSpec
from tol3d.gears import SpurGear
from tol3d.gears.iso1328 import FlankTolerances


class HelixSlopeSpec(FlankShapeSpec):
    """f_Hbeta, a length: by so much more the flank stands out at the upper end of its face than at the lower one.

    Linear in the gear's z over the whole face width, 0 in its middle.
    """

    kind: Literal["helix_slope"]

    def of_class(self, limits: FlankTolerances) -> float:
        """See FlankShapeSpec."""
        return limits.helix_slope

    def effect(self, gear: SpurGear) -> FlankDeviation:
        """See FlankToleranceSpec."""
        return self.deviation(gear, HELIX)
