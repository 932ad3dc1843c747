"""Common base of every kind of part.

Common base of every kind of assembly move.

Common base of every kind of measure: its subject, the value taken, its limits.

Common base of every kind of tolerance.
"""

from abc import abstractmethod
from collections.abc import Iterator, Mapping
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import Field, model_validator
from typing_extensions import override

from tol3d.errors import InputError
from tol3d.files import Files
from tol3d.scene.entry import AboutOne, Entry, Reference
from tol3d.scene.name import Name
from tol3d.scene.place import KeyPath
from tol3d.statistics.distributions import Distribution, DistributionSpec, StatedDistribution
from tol3d.statistics.distributions.base import Stays
from tol3d.statistics.distributions.drawn import in_class, restated, tolerated_size
from tol3d.statistics.distributions.unsized import UnsizedSpec
from tol3d.strict import Strict, refused
from tol3d.units import Dimension, Of, Positive, Quantity, refuse_dimension

Length = Annotated[Quantity, Of("length"), Positive()]


class PartSpec(Entry):
    """A part as a scene writes it."""

    origin_field: ClassVar[KeyPath] = ()
    """The field that states the place of its origin in the world; () if there is none."""

    expansion: Annotated[Quantity, Of("expansion")] | None = Field(
        default=None, description="coefficient of linear thermal expansion"
    )

    @property
    def has_solid(self) -> bool:
        """True if a solid has to be built before all that the scene says of it is known."""
        return False


class GrowingSpec(PartSpec):
    """A part that grows with temperature; kinds of part with relevant sizes are subclasses."""

    words: ClassVar[str] = "a part that grows with temperature"


class MoveSpec(Entry):
    """An assembly step as a scene writes it."""

    @abstractmethod
    def references(self) -> tuple[Reference, ...]:
        """Every name that the move uses."""


MOST_POSITIONS = 1000

Take = Literal["value", "min", "max", "range", "harmonic", "curve"]
LengthLimit = Annotated[Quantity, Of("length")]
AngleLimit = Annotated[Quantity, Of("angle")]
CountLimit = Annotated[Quantity, Of("count")]


class MeasureEntry(Entry):
    """A measure as a scene writes it: a number a trial, or a curve."""

    dimension: ClassVar[Dimension]

    lower_limit: Quantity | None
    upper_limit: Quantity | None
    description: str = Field(default="", description="the user's own words, shown in reports")

    @property
    @abstractmethod
    def gives_curve(self) -> bool:
        """True if a trial gives a value at every position instead of one."""

    @property
    @abstractmethod
    def several_positions(self) -> bool:
        """True if a trial is read at several positions."""

    @abstractmethod
    def references(self) -> tuple[Reference, ...]:
        """Every name that the measure uses."""

    @model_validator(mode="after")
    def _refuse_reversed_limits(self) -> Self:
        lower, upper = self.lower_limit, self.upper_limit
        if lower is not None and upper is not None and not lower.internal < upper.internal:
            raise refused("lower_limit", f"less than the upper_limit ({upper})", lower)
        return self


class MeasureSpec(AboutOne, MeasureEntry):
    """A measure that is read on a move."""

    of: Name = Field(description="the move that it is read on")


class AngleSpec(MeasureSpec):
    """An angle that is read on a move."""

    dimension: ClassVar[Dimension] = "angle"

    lower_limit: AngleLimit | None = Field(default=None, description="less than this is out of limits")
    upper_limit: AngleLimit | None = Field(default=None, description="more than this is out of limits")


def scaled_law(spec: DistributionSpec, factor: float, stays: Stays, files: Files) -> DistributionSpec:
    """A stated law of a multiple of the width.

    Raises:
        InputError: it cannot be scaled, or no numbers state it.
    """
    return restated(spec, spec.resolve(files).scaled_at(factor, stays))


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

    def with_law(self, law: Distribution) -> Self:
        """The tolerance as a scene writes it, by another law of its kind [mm, rad or K].

        Raises:
            InputError: the scene states no law of it, or none by numbers.
        """
        raise InputError("expected a tolerance whose law the scene states; change its width by a factor")

    def sized(self, parts: Mapping[str, Any], moves: Mapping[str, Any]) -> Self:
        """The tolerance with the law of a class, such as `{din_3967: cd25}`, at the size of what it is of.

        Args:
            parts, moves: of the scene; names may be wrong.
        """
        return self

    def in_numbers(self, draw: Any) -> Self:
        """The tolerance with limits in numbers where the scene states a class of limits.

        Args:
            draw: how its deviations are drawn, see study/system/draw.py.
        """
        return self


class ToleranceSpec(ToleranceEntry):
    """A tolerance that is a contributor: one deviation and its distribution."""

    distribution: StatedDistribution = Field(description="the law of the deviation")

    @property
    @override
    def nominal(self) -> str:
        return "nominal"

    def nominal_size(self, parts: Mapping[str, Any], moves: Mapping[str, Any]) -> Quantity | None:
        """The size that is tolerated, at which classes of ISO 286 are read; None where the scene states none.

        Args:
            parts, moves: of the scene.
        """
        return tolerated_size(self.distribution.drawn)

    def of_class(self, tolerance_class: str, size: Quantity) -> Self:
        """The tolerance as a scene writes it, by a class, such as H7; its law is stated by limits on a drawing."""
        return self.model_copy(update={"distribution": in_class(self.distribution, tolerance_class, size)})

    def file_names(self) -> Iterator[tuple[KeyPath, str]]:
        """Files that its law reads."""
        return ((("distribution", field), name) for field, name in self.distribution.file_names())

    def size(self, standard: str, parts: Mapping[str, Any], moves: Mapping[str, Any]) -> float | None:
        """Size by which a standard of STANDARDS gives the deviation limits [mm]; None where it gives it none.

        Raises:
            InputError: it has no such size.
        """
        return None

    @override
    def sized(self, parts: Mapping[str, Any], moves: Mapping[str, Any]) -> Self:
        law = self.distribution
        if not isinstance(law, UnsizedSpec):
            return self
        try:
            size = self.size(law.standard, parts, moves)
            return self if size is None else self.model_copy(update={"distribution": law.of(size)})
        except InputError:  # `loose_ends` says why
            return self

    @override
    def scaled(self, factor: float, stays: Stays, files: Files) -> Self:
        return self.model_copy(update={"distribution": scaled_law(self.distribution, factor, stays, files)})

    @override
    def with_law(self, law: Distribution) -> Self:
        return self.model_copy(update={"distribution": restated(self.distribution, law)})

    @model_validator(mode="after")
    def _refuse_other_dimensions(self) -> Self:
        expected = self.dimensions
        for field, quantity in self.distribution.quantities().items():
            refuse_dimension(quantity, expected, f"distribution.{field}")
            expected = (quantity.dimension,)  # the first decides where the kind leaves a choice
        return self
