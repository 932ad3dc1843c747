"""What every kind of measure has in common: of what it is, how much of it is taken, its limits."""

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from typing import Annotated, ClassVar, Literal, Self

from pydantic import Field, model_validator

from tol3d.scene.move import MoveSpec
from tol3d.scene.name import Name
from tol3d.scene.part import PartSpec
from tol3d.scene.reference import Contradiction, Reference
from tol3d.strict import Strict, refused
from tol3d.units import Dimension, Of, Quantity

MOST_POSITIONS = 1000

Take = Literal["value", "min", "max", "range", "curve"]
LengthLimit = Annotated[Quantity, Of("length")]
AngleLimit = Annotated[Quantity, Of("angle")]


class MeasureSpec(Strict, ABC):
    """A measure as a scene writes it: a number a trial, or a curve.

    Each kind says by `take` what it takes of its positions.
    """

    dimension: ClassVar[Dimension]

    kind: str
    lower_limit: Quantity | None
    upper_limit: Quantity | None
    of: Name = Field(description="the move that it is read on")
    description: str = Field(default="", description="the user's own words, shown in reports")

    @property
    @abstractmethod
    def several_positions(self) -> bool:
        """Whether a trial is read at several positions."""

    @abstractmethod
    def references(self) -> tuple[Reference, ...]:
        """Every name that the measure uses."""

    def contradictions(self, parts: Mapping[str, PartSpec], moves: Mapping[str, MoveSpec]) -> Iterator[Contradiction]:
        """What does not fit the parts and moves that it names; asked only when every name exists."""
        return iter(())

    @model_validator(mode="after")
    def _refuse_reversed_limits(self) -> Self:
        lower, upper = self.lower_limit, self.upper_limit
        if lower is not None and upper is not None and not lower.internal < upper.internal:
            raise refused("lower_limit", f"less than the upper_limit ({upper})", lower)
        return self
