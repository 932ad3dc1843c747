"""Eccentricity of the eccentrics."""

from typing import ClassVar, Literal

from pydantic import Field

from tol3d.cycloid.grammar.parts.crankshaft import CrankshaftSpec
from tol3d.scene.name import Name
from tol3d.scene.reference import Reference
from tol3d.scene.tolerance import ToleranceSpec


class CrankEccentricitySpec(ToleranceSpec):
    """A length: an eccentric, or its bearing, lies off its place on the crankshaft, in a random direction of its own.

    Half of a run-out. `disc` takes one deviation for the eccentrics of all cranks that carry one disc; `crank` one for
    every eccentric, of which a disc follows the mean.
    """

    words: ClassVar[str] = "eccentricity of a crankshaft's eccentrics"

    kind: Literal["crank_eccentricity"]
    of: Name = Field(description="the crankshaft")
    each: Literal["crank", "disc"] = Field(
        default="crank", description="crank: every eccentric by itself; disc: alike on all cranks"
    )

    def references(self) -> tuple[Reference, ...]:
        """What it is a tolerance of."""
        return (Reference(("of",), self.of, (CrankshaftSpec,)),)
