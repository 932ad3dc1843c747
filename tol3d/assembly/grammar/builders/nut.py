"""A nut with an ear in which a ball sits."""

from typing import ClassVar, Literal

from pydantic import Field

from tol3d.assembly.grammar.builders.builder_spec import BuilderSpec
from tol3d.scene.part import Length
from tol3d.solids.linkage_parts import Nut


class NutSpec(BuilderSpec):
    """A cylinder along z with an ear at +x; its part's origin is the middle of its bottom."""

    words: ClassVar[str] = "a nut"

    kind: Literal["nut"]
    diameter: Length = Field(description="outside")
    length: Length = Field(description="along z")
    bore: Length = Field(description="diameter; the thread is not cut")
    reach: Length = Field(description="from the axis to the centre of the seat, which is in the top of the ear")
    ear_width: Length = Field(description="along y")
    ball_diameter: Length = Field(description="of the seat")

    @property
    def shape(self) -> Nut:
        """See BuilderSpec."""
        return Nut(
            self.diameter.internal,
            self.length.internal,
            self.bore.internal,
            self.reach.internal,
            self.ear_width.internal,
            self.ball_diameter.internal,
        )
