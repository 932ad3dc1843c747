"""A point."""

from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from tol3d.assembly.grammar.features.feature_spec import FeatureSpec
from tol3d.assembly.grammar.features.nominal_frame import frame
from tol3d.assembly.model import Point
from tol3d.scene.vector import Direction


class PointSpec(FeatureSpec):
    """A point of a surface, or the centre of something."""

    words: ClassVar[str] = "a point"

    kind: Literal["point"]
    normal: Direction | None = Field(default=None, description="out of the material, of a point of a surface")

    @property
    def shape(self) -> Point:
        """See FeatureSpec."""
        return Point()

    @property
    def frame(self) -> NDArray[np.float64]:
        """See FeatureSpec; z along the normal, or the part's z."""
        return frame(self.origin, self.normal or (0.0, 0.0, 1.0))
