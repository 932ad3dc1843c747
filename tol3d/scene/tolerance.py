"""Common base of every kind of tolerance."""

from abc import abstractmethod
from collections.abc import Iterator
from typing import Any, ClassVar, Self

from pydantic import Field, model_validator

from tol3d.distributions import DistributionSpec, StatedDistribution
from tol3d.distributions.base import Stays
from tol3d.errors import InputError
from tol3d.files import Files
from tol3d.scene.entry import Entry
from tol3d.scene.place import KeyPath
from tol3d.scene.reference import Reference
from tol3d.strict import Strict
from tol3d.units import Dimension, refuse_dimension


def scaled_law(spec: DistributionSpec, factor: float, stays: Stays, files: Files) -> DistributionSpec:
    """A stated law of a multiple of the width.

    Raises:
        InputError: it cannot be scaled, or no numbers state it.
    """
    return spec.stating(spec.resolve(files).scaled_at(factor, stays))


def laws_in(value: Any) -> Iterator[DistributionSpec]:
    """The distributions that an entry states, however deep."""
    if isinstance(value, DistributionSpec):
        yield value
    elif isinstance(value, Strict):
        for each in vars(value).values():
            yield from laws_in(each)
    elif isinstance(value, list | tuple):
        for each in value:
            yield from laws_in(each)


class ToleranceEntry(Entry):
    """A tolerance as a scene writes it: a contributor, or a limit of one, such as a tighter zone for orientation."""

    dimensions: ClassVar[tuple[Dimension, ...]] = ("length",)

    description: str = Field(default="", description="the user's own words, shown in reports")

    @property
    def nominal(self) -> str:
        """Word of a drawing for what moves the mean of the deviation; "" where it has nothing to be moved."""
        return ""

    @abstractmethod
    def references(self) -> tuple[Reference, ...]:
        """Every name that the tolerance uses."""

    def scaled(self, factor: float, stays: Stays, files: Files) -> Self:
        """The tolerance as a scene writes it, of a multiple of the width.

        Args:
            factor: above 0.
            stays: its middle, or one of its limits.
            files: those that its law reads.

        Raises:
            InputError: no numbers in the scene say how wide it is.
        """
        raise InputError("expected a tolerance whose width the scene states in numbers")


class ToleranceSpec(ToleranceEntry):
    """A tolerance that is a contributor: one deviation and its distribution."""

    distribution: StatedDistribution = Field(description="the law of the deviation")

    @property
    def nominal(self) -> str:
        """See ToleranceEntry."""
        return "nominal"

    def file_names(self) -> Iterator[tuple[KeyPath, str]]:
        """Files that its law reads."""
        return ((("distribution", field), name) for field, name in self.distribution.file_names())

    def scaled(self, factor: float, stays: Stays, files: Files) -> Self:
        """See ToleranceEntry."""
        return self.model_copy(update={"distribution": scaled_law(self.distribution, factor, stays, files)})

    @model_validator(mode="after")
    def _refuse_other_dimensions(self) -> Self:
        expected = self.dimensions
        for field, quantity in self.distribution.quantities().items():
            refuse_dimension(quantity, expected, f"distribution.{field}")
            expected = (quantity.dimension,)  # the first decides where the kind leaves a choice
        return self
