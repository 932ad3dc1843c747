"""Tilt of the discs."""

from typing import ClassVar, Literal

from pydantic import Field

from tol3d.cycloid.grammar.parts.cycloid_disc import CycloidDiscSpec
from tol3d.scene.name import Name
from tol3d.scene.reference import Reference
from tol3d.scene.tolerance import ToleranceSpec
from tol3d.units import Dimension


class DiscTiltSpec(ToleranceSpec):
    """An angle: each disc leans by it about an axis in its plane, in a random direction that turns with the disc.

    Pins are upright, so that a face of the disc touches first, or what lies between its faces.
    """

    words: ClassVar[str] = "tilt of discs"
    dimensions: ClassVar[tuple[Dimension, ...]] = ("angle",)

    kind: Literal["disc_tilt"]
    of: Name = Field(description="the disc, whose width counts")
    each: Literal["disc"] = Field(default="disc", description="disc: every disc deviates by itself")

    def references(self) -> tuple[Reference, ...]:
        """What it is a tolerance of."""
        return (Reference(("of",), self.of, (CycloidDiscSpec,)),)
