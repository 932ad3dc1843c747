"""Cylinders, and axes without a size."""

from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from tol3d.assembly.grammar.features.feature_spec import FeatureSpec
from tol3d.assembly.grammar.features.nominal_frame import frame
from tol3d.assembly.model import Axis
from tol3d.scene.part import Length
from tol3d.scene.vector import Direction


class AxisSpec(FeatureSpec):
    """A straight axis."""

    words: ClassVar[str] = "an axis"

    kind: Literal["axis"]
    axis: Direction = Field(description="which way it runs")
    length: Length = Field(description="from end to end")

    @property
    def shape(self) -> Axis:
        """See FeatureSpec."""
        return Axis(self.length.internal)

    @property
    def frame(self) -> NDArray[np.float64]:
        """See FeatureSpec."""
        return frame(self.origin, self.axis)


class CylinderSpec(FeatureSpec):
    """A hole, or a pin: an axis with a size."""

    words: ClassVar[str] = "a cylinder"

    kind: Literal["cylinder"]
    axis: Direction = Field(description="which way it runs")
    length: Length = Field(description="from end to end")
    diameter: Length = Field(description="nominal")
    hole: bool = Field(default=False, description="whether it is one, not a pin")

    @property
    def shape(self) -> Axis:
        """See FeatureSpec."""
        return Axis(self.length.internal, self.diameter.internal, self.hole)

    @property
    def frame(self) -> NDArray[np.float64]:
        """See FeatureSpec."""
        return frame(self.origin, self.axis)
