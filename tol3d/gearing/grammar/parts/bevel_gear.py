"""A straight bevel gear with spherical-involute flanks."""

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from tol3d.gearing.grammar.parts.gear import BoredGearSpec
from tol3d.units import Of, Positive, Quantity


class BevelGearSpec(BoredGearSpec):
    """A straight bevel gear by the words of ISO 23509; its depth and thickness taper towards the apex."""

    words: ClassVar[str] = "a bevel gear"

    kind: Literal["bevel_gear"]
    pitch_angle: Annotated[Quantity, Of("angle"), Positive()] | None = Field(
        default=None, description="of the pitch cone; follows from the teeth and the shaft angle if not given"
    )
