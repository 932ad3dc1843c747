"""A ring-involute spherical gear."""

import math
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from tol3d.assembly.grammar.builders.builder_spec import BuilderSpec
from tol3d.scene.part import Length
from tol3d.solids.linkage_parts import SphericalGear
from tol3d.strict import Strict
from tol3d.units import Of, Quantity

Angle = Annotated[Quantity, Of("angle")]
USUAL_PRESSURE_ANGLE = math.radians(20)


class BlindBoreSpec(Strict):
    """A hole from the bottom along z."""

    diameter: Length = Field(description="of the bore")
    depth: Length = Field(description="from the bottom")


class SphericalGearSpec(BuilderSpec):
    """The profile of a spur gear turned about its pole at +z; its part's origin is its centre."""

    words: ClassVar[str] = "a spherical gear"

    kind: Literal["spherical_gear"]
    teeth: int = Field(ge=3, description="of the spur gear; half of them would be rings all the way round")
    module: Length = Field(description="by which the pitch sphere has a diameter of module times teeth")
    pole: Literal["tooth", "space"] = Field(description="what is at the pole; two gears mesh if it differs")
    reach: Angle = Field(description="from the pole to the edge of its flat bottom; what rings end before it are there")
    pressure_angle: Angle | None = Field(default=None, description="default: 20 deg")
    thinned: Length | None = Field(
        default=None,
        description="by how much a tooth is thinner than half the pitch, on the pitch sphere; default: not at all",
    )
    bore: BlindBoreSpec | None = Field(default=None, description="default: none")

    @property
    def shape(self) -> SphericalGear:
        """See BuilderSpec."""
        return SphericalGear(
            self.teeth,
            self.module.internal,
            USUAL_PRESSURE_ANGLE if self.pressure_angle is None else self.pressure_angle.internal,
            self.reach.internal,
            self.pole == "tooth",
            0.0 if self.thinned is None else self.thinned.internal,
            None if self.bore is None else (self.bore.diameter.internal, self.bore.depth.internal),
        )
