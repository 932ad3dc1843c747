"""Spheres: balls and sockets."""

from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from tol3d.assembly.grammar.features.feature_spec import FeatureSpec
from tol3d.assembly.grammar.features.nominal_frame import frame
from tol3d.assembly.model import Point
from tol3d.scene.part import Length


class SphereSpec(FeatureSpec):
    """A ball, or a socket: a point with a size."""

    words: ClassVar[str] = "a sphere"

    kind: Literal["sphere"]
    diameter: Length = Field(description="nominal")
    hole: bool = Field(default=False, description="whether it is a socket, not a ball")

    @property
    def shape(self) -> Point:
        """See FeatureSpec."""
        return Point(self.diameter.internal, self.hole)

    @property
    def frame(self) -> NDArray[np.float64]:
        """See FeatureSpec; z is that of the part."""
        return frame(self.origin, (0.0, 0.0, 1.0))
