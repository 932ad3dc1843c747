"""Size: the diameter of a cylinder."""

from collections.abc import Iterator
from typing import ClassVar, Literal

from tol3d.assembly.grammar.feature_name import Use
from tol3d.assembly.grammar.tolerances.feature_tolerance import FeatureTolerance
from tol3d.scene.place import KeyPath
from tol3d.scene.reference import Reference
from tol3d.scene.tolerance import ToleranceSpec


class SizeSpec(FeatureTolerance, ToleranceSpec):
    """How much larger a diameter is than nominal."""

    words: ClassVar[str] = "a size tolerance"
    applies_to: ClassVar[tuple[str, ...]] = ("cylinder",)

    kind: Literal["size"]

    def references(self) -> tuple[Reference, ...]:
        """See FeatureTolerance."""
        return FeatureTolerance.references(self)

    def file_names(self) -> Iterator[tuple[KeyPath, str]]:
        """See ToleranceSpec."""
        return ToleranceSpec.file_names(self)

    def uses(self) -> Iterator[Use]:
        """See FeatureTolerance."""
        return FeatureTolerance.uses(self)
