"""The difference of two measures in one trial."""

from typing import ClassVar, Literal

from pydantic import Field

from tol3d.assembly.grammar.measures.assembly_measure import AssemblyMeasureSpec, FeatureMeasureSpec
from tol3d.assembly.grammar.measures.pose_errors import PoseErrorSpec
from tol3d.scene.name import Name
from tol3d.scene.reference import Reference


class DifferenceSpec(AssemblyMeasureSpec):
    """One measure less another, such as the taper of a gap."""

    words: ClassVar[str] = "a difference"

    kind: Literal["difference"]
    of: Name = Field(description="the measure")
    minus: Name = Field(description="the one that is subtracted")

    def references(self) -> tuple[Reference, ...]:
        """Both measures; those of lengths."""
        specs = (FeatureMeasureSpec, PoseErrorSpec)
        return Reference(("of",), self.of, specs), Reference(("minus",), self.minus, specs)
