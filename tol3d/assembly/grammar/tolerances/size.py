"""Size: the diameter of a cylinder or a sphere, the width of a slot or tab."""

from collections.abc import Iterator
from typing import Annotated, ClassVar, Literal, Self

from pydantic import Field, model_validator

from tol3d.assembly.grammar.feature_name import Use
from tol3d.assembly.grammar.tolerances.feature_tolerance import FeatureTolerance
from tol3d.scene.listed import listed
from tol3d.scene.place import KeyPath
from tol3d.scene.reference import Reference
from tol3d.scene.tolerance import ToleranceSpec
from tol3d.strict import refused
from tol3d.units import Of, Quantity

Deviation = Annotated[Quantity, Of("length")]


class SizeSpec(FeatureTolerance, ToleranceSpec):
    """How much larger a diameter or width is than nominal."""

    words: ClassVar[str] = "a size tolerance"
    applies_to: ClassVar[tuple[str, ...]] = ("cylinder", "slot", "sphere")

    kind: Literal["size"]
    limits: Annotated[tuple[Deviation, Deviation], listed("lengths", 2, 2)] | None = Field(
        default=None,
        description="lower and upper on the drawing, as deviations from nominal, from which a bonus counts; those of "
        "the distribution if not given",
    )

    @model_validator(mode="after")
    def _refuse_limits_out_of_order(self) -> Self:
        if self.limits is not None and not self.limits[0].internal < self.limits[1].internal:
            raise refused("limits", "the lower one before the upper one", list(map(str, self.limits)))
        return self

    def references(self) -> tuple[Reference, ...]:
        """See FeatureTolerance."""
        return FeatureTolerance.references(self)

    def file_names(self) -> Iterator[tuple[KeyPath, str]]:
        """See ToleranceSpec."""
        return ToleranceSpec.file_names(self)

    def uses(self) -> Iterator[Use]:
        """See FeatureTolerance."""
        return FeatureTolerance.uses(self)
