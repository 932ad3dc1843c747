"""A flat face."""

from typing import Annotated, ClassVar, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from tol3d.assembly.grammar.features.feature_spec import FeatureSpec
from tol3d.assembly.grammar.features.nominal_frame import frame, is_across
from tol3d.assembly.model import Plane, RoundPlane
from tol3d.scene.listed import listed
from tol3d.scene.part import Length
from tol3d.scene.vector import Direction
from tol3d.strict import refused


class PlaneSpec(FeatureSpec):
    """A flat face, rectangular or round."""

    words: ClassVar[str] = "a plane"

    kind: Literal["plane"]
    normal: Direction = Field(description="out of the material")
    extent: Annotated[tuple[Length, Length], listed("lengths", 2, 2)] | None = Field(
        default=None, description="along x and y of the face"
    )
    radius: Length | None = Field(default=None, description="of a round face")
    along: Direction | None = Field(default=None, description="x of the face; the part's x (or y) if not given")

    @property
    def shape(self) -> Plane | RoundPlane:
        """See FeatureSpec."""
        if self.extent is not None:
            return Plane((self.extent[0].internal, self.extent[1].internal))
        if self.radius is None:
            raise ValueError("a plane has an extent or a radius")
        return RoundPlane(self.radius.internal)

    @property
    def frame(self) -> NDArray[np.float64]:
        """See FeatureSpec."""
        return frame(self.origin, self.normal, self.along)

    @model_validator(mode="after")
    def _refuse_contradictions(self) -> Self:
        if (self.extent is None) == (self.radius is None):
            got = "neither" if self.extent is None else "both"
            raise refused("extent", "either an extent such as [100 mm, 60 mm] or a radius", got)
        if self.along is not None and not is_across(self.along, self.normal):
            raise refused("along", "a direction across the normal", list(self.along))
        return self
