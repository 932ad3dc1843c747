"""Phases of the crankshafts."""

from typing import ClassVar, Literal

from pydantic import Field

from tol3d.cycloid.grammar.parts.crankshaft import CrankshaftSpec
from tol3d.scene.name import Name
from tol3d.scene.reference import Reference
from tol3d.scene.tolerance import ToleranceSpec
from tol3d.units import Dimension


class CrankPhaseSpec(ToleranceSpec):
    """An angle: each crankshaft is turned against its planet by it, counter-clockwise; each one's own deviation."""

    words: ClassVar[str] = "phases of crankshafts"
    dimensions: ClassVar[tuple[Dimension, ...]] = ("angle",)

    kind: Literal["crank_phase"]
    of: Name = Field(description="the crankshaft")
    each: Literal["crank"] = Field(default="crank", description="crank: every crankshaft deviates by itself")

    def references(self) -> tuple[Reference, ...]:
        """What it is a tolerance of."""
        return (Reference(("of",), self.of, (CrankshaftSpec,)),)
