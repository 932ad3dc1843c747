"""Profile form deviations of a spur gear's flanks."""

from typing import Literal, Self

from pydantic import Field, model_validator

from tol3d.gearing.effects import FORM, FlankDeviation
from tol3d.gearing.grammar.tolerances.evaluation_range import FORM_SHARE, Range, profile_part
from tol3d.gearing.grammar.tolerances.flank_shape import FlankShapeSpec
from tol3d.gears import SpurGear
from tol3d.gears.iso1328 import FlankTolerances
from tol3d.strict import refused


class ProfileFormSpec(FlankShapeSpec):
    """f_falpha, a length from peak to valley of a stated shape over the whole involute; negative turns it inside out.

    With u from -1/2 to 1/2 over the evaluation range, in the roll: a barrel is 1/3 - 4 u^2 of it, waves are
    cos(2 pi waves u)/2. Both go on beyond the range.
    """

    kind: Literal["profile_form"]
    shape: Literal["barrel", "wave"] = Field(description="a barrel, or cosine waves")
    waves: int | None = Field(default=None, ge=1, le=20, description="of a wave: how many there are over the range")
    range: Range | None = Field(
        default=None,
        description="diameters it counts between; by default from the active begin 95 % of the way to the tip",
    )

    @model_validator(mode="after")
    def _refuse_stray_waves(self) -> Self:
        if (self.shape == "wave") != (self.waves is not None):
            expected, got = ("a number of waves", "none") if self.shape == "wave" else ("none of a barrel", "waves")
            raise refused("waves", expected, got)
        return self

    def of_class(self, limits: FlankTolerances) -> float:
        """See FlankShapeSpec."""
        return limits.profile_form

    def effect(self, gear: SpurGear, active_roll: float) -> FlankDeviation:
        """See FlankToleranceSpec."""
        part, places = profile_part(self.range, gear, active_roll, FORM_SHARE), self.places(gear)
        if self.waves is None:
            return FlankDeviation(self.of, FORM, places, mix=part.barrel)
        return FlankDeviation(self.of, FORM, places, float(self.waves), span=(part.begin, part.end))
