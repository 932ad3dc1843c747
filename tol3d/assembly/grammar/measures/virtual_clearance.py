"""The largest bolt through several holes."""

from collections.abc import Sequence
from typing import Annotated, ClassVar, Literal, Self

from pydantic import Field, model_validator

from tol3d.assembly.grammar.datums import Datums, DatumSpec
from tol3d.assembly.grammar.feature_name import FeatureName
from tol3d.assembly.grammar.measures.assembly_measure import FeatureMeasureSpec
from tol3d.assembly.model.measures import TORSORS, Reading
from tol3d.scene.listed import listed
from tol3d.scene.place import KeyPath
from tol3d.strict import refused

MOST_HOLES = 8


class VirtualClearanceSpec(FeatureMeasureSpec):
    """Diameter of the largest straight bolt that passes all of 2 to 8 `holes`."""

    reads: ClassVar[Reading] = Reading(
        "virtual_clearance",
        "tol3d.assembly.placing.measuring:virtual_clearance",
        f"{TORSORS}:virtual_clearance",
    )

    kind: Literal["virtual_clearance"]
    holes: Annotated[tuple[FeatureName, ...], listed("holes", 2, MOST_HOLES)] = Field(
        description="in one line; the bolt stands along the nominal axis of the first, as its part carries it"
    )
    datums: Datums | None = Field(
        default=None, description="of the first hole's part, to which the bolt stands; its part's frame if not given"
    )

    @property
    def named_datums(self) -> tuple[DatumSpec, ...]:
        """See FeatureMeasureSpec."""
        return self.datums or ()

    @model_validator(mode="after")
    def _refuse_twice(self) -> Self:
        for k, name in enumerate(self.holes):
            if name in self.holes[:k]:
                raise refused("holes", "each hole once", repr(name))
        return self

    def named(self) -> Sequence[tuple[KeyPath, FeatureName, tuple[str, ...]]]:
        """See FeatureMeasureSpec."""
        return tuple((("holes", k), name, ("cylinder",)) for k, name in enumerate(self.holes))
