"""An internal involute spur gear: the ring of a pair."""

from typing import ClassVar, Literal

from pydantic import Field

from tol3d.gearing.grammar.parts.gear import GearSpec
from tol3d.scene.part import GrowingSpec, Length


class InternalGearSpec(GearSpec, GrowingSpec):
    """A ring with teeth on its inside; a tooth points inwards, its thickness is an arc at the reference circle.

    As for every gear a positive profile shift is a thicker tooth, here with its tip further in (ISO 21771).
    """

    words: ClassVar[str] = "an internal gear"

    kind: Literal["internal_gear"]
    root_fillet: Length | None = Field(
        default=None, description="radius between flank and root circle; 0.38 m (ISO 53) or the full round if not given"
    )
    outer_diameter: Length | None = Field(
        default=None, description="of the ring; that of the root circle and 5 modules if not given"
    )
