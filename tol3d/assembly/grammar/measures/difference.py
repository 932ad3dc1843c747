"""The difference of two measures in one trial."""

from collections.abc import Iterator, Sequence
from typing import ClassVar, Literal

from pydantic import Field

from tol3d.assembly.grammar.measures.assembly_measure import AssemblyMeasureSpec, FeatureMeasureSpec
from tol3d.assembly.grammar.measures.pose_errors import PoseErrorSpec
from tol3d.assembly.model.measures import Measured
from tol3d.scene.name import Name
from tol3d.scene.reference import Reference


class DifferenceSpec(AssemblyMeasureSpec):
    """One measure less another in the same trial, such as the taper of a gap."""

    words: ClassVar[str] = "a difference"

    kind: Literal["difference"]
    of: Name = Field(description="the measure")
    minus: Name = Field(description="the one that is subtracted")

    @classmethod
    def lacking(cls) -> Iterator[str]:
        """Nothing: both measures have their readings."""
        return iter(())

    @property
    def of_what(self) -> Sequence[str]:
        """Both measures."""
        return (self.of, self.minus)

    def measured(self, moves: Sequence[str]) -> Measured:
        """Nothing by itself."""
        raise TypeError("a difference is read as its measures are")

    def references(self) -> tuple[Reference, ...]:
        """Both measures; those of lengths."""
        specs = (FeatureMeasureSpec, PoseErrorSpec)
        return Reference(("of",), self.of, specs), Reference(("minus",), self.minus, specs)
