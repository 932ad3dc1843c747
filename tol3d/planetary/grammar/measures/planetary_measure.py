"""What every measure of a planetary set has in common."""

from typing import ClassVar, Literal

from pydantic import Field

from tol3d.planetary.grammar.moves.planetary import PlanetarySpec
from tol3d.scene.direction import RandomOrFixed
from tol3d.scene.measure import AngleSpec
from tol3d.scene.name import Name
from tol3d.scene.reference import Reference


class PlanetaryMeasureSpec(AngleSpec):
    """An angle that is read on a planetary set."""

    of: Name = Field(description="the planetary set")

    def references(self) -> tuple[Reference, ...]:
        """The set."""
        return (Reference(("of",), self.of, (PlanetarySpec,)),)


class PlanetaryFreeTurnSpec(PlanetaryMeasureSpec):
    """A free turn of a shaft at one position, or a part of it."""

    gives_curve: ClassVar[bool] = False
    several_positions: ClassVar[bool] = False

    at: Literal["output", "input"] = Field(default="output", description="the shaft that turns: output or input")
    over: RandomOrFixed = Field(default="random", description="position of the output: random or {at: angle}")
