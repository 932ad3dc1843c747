"""What every measure of a train has in common."""

from typing import ClassVar

from pydantic import Field

from tol3d.gearing.grammar.measures.flank_measure import FlankMeasureSpec
from tol3d.gearing.grammar.moves import TrainSpec
from tol3d.scene.measure import Take
from tol3d.scene.name import Name
from tol3d.scene.reference import Reference


class TrainMeasureSpec(FlankMeasureSpec):
    """A measure that is read on a train: a number a trial, for kinds that do not say otherwise."""

    take: ClassVar[Take] = "value"

    of: Name = Field(description="the train")

    @property
    def gives_curve(self) -> bool:
        """Whether a trial gives a value at every position instead of one."""
        return self.take == "curve"

    @property
    def several_positions(self) -> bool:
        """Whether a trial is read at several positions."""
        return self.take != "value"

    def references(self) -> tuple[Reference, ...]:
        """The train."""
        return (Reference(("of",), self.of, (TrainSpec,)),)
