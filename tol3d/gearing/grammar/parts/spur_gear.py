"""An external involute spur gear."""

from typing import ClassVar, Literal

from pydantic import Field

from tol3d.gearing.grammar.parts.gear import BoredGearSpec
from tol3d.scene.part import GrowingSpec, Length


class SpurGearSpec(BoredGearSpec, GrowingSpec):
    """A spur gear; its tooth thickness is an arc at the reference circle."""

    words: ClassVar[str] = "a spur gear"

    kind: Literal["spur_gear"]
    root_fillet: Length | None = Field(
        default=None, description="radius between flank and root circle; 0.38 m (ISO 53) or the full round if not given"
    )
