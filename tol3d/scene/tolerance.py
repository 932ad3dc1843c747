"""What every kind of tolerance has in common."""

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from typing import ClassVar, Self

from pydantic import Field, model_validator

from tol3d.distributions import DistributionUnion
from tol3d.scene.move import MoveSpec
from tol3d.scene.part import PartSpec
from tol3d.scene.reference import Contradiction, Reference
from tol3d.strict import Strict
from tol3d.units import Dimension, refuse_dimension


class ToleranceSpec(Strict, ABC):
    """A tolerance (a contributor) as a scene writes it: one deviation and its distribution."""

    dimensions: ClassVar[tuple[Dimension, ...]] = ("length",)

    kind: str
    distribution: DistributionUnion = Field(description="the law of the deviation")
    description: str = Field(default="", description="the user's own words, shown in reports")

    @abstractmethod
    def references(self) -> tuple[Reference, ...]:
        """Every name that the tolerance uses."""

    def contradictions(self, parts: Mapping[str, PartSpec], moves: Mapping[str, MoveSpec]) -> Iterator[Contradiction]:
        """What does not fit the parts and moves that it names; asked only when every name exists."""
        return iter(())

    @model_validator(mode="after")
    def _refuse_other_dimensions(self) -> Self:
        expected = self.dimensions
        for field, quantity in self.distribution.quantities().items():
            refuse_dimension(quantity, expected, f"distribution.{field}")
            expected = (quantity.dimension,)  # the first decides where the kind leaves a choice
        return self
