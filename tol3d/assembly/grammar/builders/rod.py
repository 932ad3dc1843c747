"""A rod between two balls."""

from typing import ClassVar, Literal

from pydantic import Field

from tol3d.assembly.grammar.builders.builder_spec import BuilderSpec
from tol3d.scene.part import Length
from tol3d.solids.linkage_parts import Rod


class RodSpec(BuilderSpec):
    """A round rod along z; its part's origin is the centre of its bottom ball."""

    words: ClassVar[str] = "a rod"

    kind: Literal["rod"]
    length: Length = Field(description="between the centres of both balls, along z")
    diameter: Length = Field(description="of the rod")
    ball_diameter: Length = Field(description="of both balls")

    @property
    def shape(self) -> Rod:
        """See BuilderSpec."""
        return Rod(self.length.internal, self.diameter.internal, self.ball_diameter.internal)
