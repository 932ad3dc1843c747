"""A dimension with its limits: how far a feature lies off along a direction."""

from collections.abc import Iterator
from typing import ClassVar, Literal

from pydantic import Field

from tol3d.assembly.grammar.datums import Datums, DatumSpec
from tol3d.assembly.grammar.feature_name import Use
from tol3d.assembly.grammar.tolerances.feature_tolerance import FeatureTolerance
from tol3d.scene.place import KeyPath
from tol3d.scene.reference import Reference
from tol3d.scene.tolerance import ToleranceSpec
from tol3d.scene.vector import Direction


class PlusMinusSpec(FeatureTolerance, ToleranceSpec):
    """How far a feature lies off along a direction; it does not tilt. A feature may have one along each direction."""

    words: ClassVar[str] = "a plus-minus tolerance"

    kind: Literal["plus_minus"]
    along: Direction | None = Field(
        default=None,
        description="in the part's frame; if not given away from the first of the datums off which the feature lies "
        "along its normal, and without datums along its normal",
    )
    datums: Datums | None = Field(default=None, description="where the dimension starts; the part's frame if not given")

    @property
    def named_datums(self) -> tuple[DatumSpec, ...]:
        """See FeatureTolerance."""
        return self.datums or ()

    def references(self) -> tuple[Reference, ...]:
        """See FeatureTolerance."""
        return FeatureTolerance.references(self)

    def file_names(self) -> Iterator[tuple[KeyPath, str]]:
        """See ToleranceSpec."""
        return ToleranceSpec.file_names(self)

    def uses(self) -> Iterator[Use]:
        """See FeatureTolerance."""
        return FeatureTolerance.uses(self)
