"""The size of a feature."""

from collections.abc import Sequence
from typing import ClassVar, Literal

from pydantic import Field

from tol3d.assembly.grammar.feature_name import FeatureName
from tol3d.assembly.grammar.measures.assembly_measure import FeatureMeasureSpec
from tol3d.assembly.model.measures import PLACING, TORSORS, Reading
from tol3d.scene.place import KeyPath


class InspectedSizeSpec(FeatureMeasureSpec):
    """The diameter, or the width of a slot."""

    reads: ClassVar[Reading] = Reading("size", f"{PLACING}:size", f"{TORSORS}:size", is_linear=True, of_part=True)

    kind: Literal["inspected_size"]
    of: FeatureName = Field(description="the feature")

    def named(self) -> Sequence[tuple[KeyPath, FeatureName, tuple[str, ...]]]:
        """See FeatureMeasureSpec."""
        return ((("of",), self.of, ("cylinder", "slot", "sphere")),)
