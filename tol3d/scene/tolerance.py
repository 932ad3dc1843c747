"""What every kind of tolerance has in common."""

from abc import abstractmethod
from collections.abc import Iterator
from typing import ClassVar, Self

from pydantic import Field, model_validator

from tol3d.distributions import StatedDistribution
from tol3d.scene.entry import Entry
from tol3d.scene.place import KeyPath
from tol3d.scene.reference import Reference
from tol3d.units import Dimension, refuse_dimension


class ToleranceEntry(Entry):
    """A tolerance as a scene writes it: a contributor, or what limits one, such as a tighter zone for orientation."""

    description: str = Field(default="", description="the user's own words, shown in reports")

    @abstractmethod
    def references(self) -> tuple[Reference, ...]:
        """Every name that the tolerance uses."""


class ToleranceSpec(ToleranceEntry):
    """A tolerance that is a contributor: one deviation and its distribution."""

    dimensions: ClassVar[tuple[Dimension, ...]] = ("length",)

    distribution: StatedDistribution = Field(description="the law of the deviation")

    def file_names(self) -> Iterator[tuple[KeyPath, str]]:
        """Those that its law reads."""
        return ((("distribution", field), name) for field, name in self.distribution.file_names())

    @model_validator(mode="after")
    def _refuse_other_dimensions(self) -> Self:
        expected = self.dimensions
        for field, quantity in self.distribution.quantities().items():
            refuse_dimension(quantity, expected, f"distribution.{field}")
            expected = (quantity.dimension,)  # the first decides where the kind leaves a choice
        return self
