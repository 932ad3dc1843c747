"""A socket for a ball."""

from typing import ClassVar, Literal

from pydantic import Field

from tol3d.assembly.grammar.builders.builder_spec import BuilderSpec
from tol3d.scene.part import Length
from tol3d.solids.linkage_parts import BallSocket


class BallSocketSpec(BuilderSpec):
    """A round housing along z that opens to +z; its part's origin is the centre of its seat."""

    words: ClassVar[str] = "a socket"

    kind: Literal["ball_socket"]
    ball_diameter: Length = Field(description="of the seat")
    mouth: Length | None = Field(
        default=None, description="diameter of the opening; default: as wide as the ball, a hemisphere"
    )
    diameter: Length = Field(description="outside")
    height: Length = Field(description="from the bottom to the centre of the seat, along z")

    @property
    def shape(self) -> BallSocket:
        """See BuilderSpec."""
        mouth = self.ball_diameter if self.mouth is None else self.mouth
        return BallSocket(self.ball_diameter.internal, mouth.internal, self.diameter.internal, self.height.internal)
