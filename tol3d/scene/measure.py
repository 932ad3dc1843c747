"""Common base of every kind of measure: its subject, the value taken, its limits."""

from abc import abstractmethod
from typing import Annotated, ClassVar, Literal, Self

from pydantic import Field, model_validator

from tol3d.scene.entry import AboutOne, Entry
from tol3d.scene.name import Name
from tol3d.scene.reference import Reference
from tol3d.strict import refused
from tol3d.units import Dimension, Of, Quantity

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
