"""Slots and tabs: a median plane with a width."""

from typing import Annotated, ClassVar, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from tol3d.assembly.grammar.features.feature_spec import FeatureSpec
from tol3d.assembly.grammar.features.nominal_frame import frame, is_across
from tol3d.assembly.model import Slot
from tol3d.scene.listed import listed
from tol3d.scene.part import Length
from tol3d.scene.vector import Direction
from tol3d.strict import refused


class SlotSpec(FeatureSpec):
    """A slot, or a tab: two parallel faces by the plane in their middle."""

    words: ClassVar[str] = "a slot"

    kind: Literal["slot"]
    normal: Direction = Field(description="across its width")
    extent: Annotated[tuple[Length, Length], listed("lengths", 2, 2)] = Field(
        description="of the plane in the middle, along its x and y"
    )
    width: Length = Field(description="nominal")
    along: Direction | None = Field(
        default=None, description="x of the plane in the middle; the part's x (or y) if not given"
    )
    tab: bool = Field(default=False, description="whether it is one, not a slot")

    @property
    def shape(self) -> Slot:
        """See FeatureSpec."""
        return Slot((self.extent[0].internal, self.extent[1].internal), self.width.internal, not self.tab)

    @property
    def frame(self) -> NDArray[np.float64]:
        """See FeatureSpec."""
        return frame(self.origin, self.normal, self.along)

    @model_validator(mode="after")
    def _refuse_contradictions(self) -> Self:
        if self.along is not None and not is_across(self.along, self.normal):
            raise refused("along", "a direction across the normal", list(self.along))
        return self
