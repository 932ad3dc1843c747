"""A ring with ears in which balls sit."""

from collections.abc import Mapping
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from tol3d.assembly.grammar.builders.builder_spec import BuilderSpec
from tol3d.assembly.grammar.feature_name import OwnName
from tol3d.scene.part import Length
from tol3d.solids.linkage_parts import ThrustRing
from tol3d.strict import Strict
from tol3d.units import Of, Quantity


class EarSpec(Strict):
    """An ear with a seat in its bottom."""

    angle: Annotated[Quantity, Of("angle")] = Field(description="of its middle, from +x towards +y")


class ThrustRingSpec(BuilderSpec):
    """A ring about z; its part's origin is the middle of its bottom, in whose plane the balls' centres lie."""

    words: ClassVar[str] = "a thrust ring"

    kind: Literal["thrust_ring"]
    inner_diameter: Length = Field(description="of its bore")
    outer_diameter: Length = Field(description="without the ears")
    thickness: Length = Field(description="along z, of the ears as well")
    radius: Length = Field(description="of the circle on which the centres of the seats lie")
    ear_width: Length = Field(description="of all ears")
    ball_diameter: Length = Field(description="of all seats")
    ears: Mapping[OwnName, EarSpec] = Field(min_length=1, description="by name, all alike")

    @property
    def shape(self) -> ThrustRing:
        """See BuilderSpec."""
        return ThrustRing(
            self.inner_diameter.internal,
            self.outer_diameter.internal,
            self.thickness.internal,
            self.radius.internal,
            self.ear_width.internal,
            self.ball_diameter.internal,
            tuple((name, ear.angle.internal) for name, ear in self.ears.items()),
        )
