"""Eccentricity of the discs."""

from typing import ClassVar, Literal

from pydantic import Field

from tol3d.cycloid.grammar.parts.cycloid_disc import CycloidDiscSpec
from tol3d.scene.name import Name
from tol3d.scene.reference import Reference
from tol3d.scene.tolerance import ToleranceSpec


class DiscEccentricitySpec(ToleranceSpec):
    """A length: the profile's centre lies off that of the crank holes, in a random direction that turns with the disc.

    Half of a run-out.
    """

    words: ClassVar[str] = "eccentricity of discs"

    kind: Literal["disc_eccentricity"]
    of: Name = Field(description="the disc")
    each: Literal["disc"] = Field(default="disc", description="disc: every disc deviates by itself")

    def references(self) -> tuple[Reference, ...]:
        """What it is a tolerance of."""
        return (Reference(("of",), self.of, (CycloidDiscSpec,)),)
