"""The angle of two features."""

from typing import ClassVar, Literal

from pydantic import Field

from tol3d.assembly.grammar.measures.assembly_measure import OverPlaySpec
from tol3d.assembly.model.measures import MeasureKind
from tol3d.scene.vector import Direction
from tol3d.units import Dimension


class AngleSpec(OverPlaySpec):
    """The angle from one normal or axis to another, 0 to 180 degrees; about a direction with its sign."""

    dimension: ClassVar[Dimension] = "angle"
    reads: ClassVar[MeasureKind] = "angle"

    kind: Literal["angle"]
    about: Direction | None = Field(default=None, description="in the frame of the part of `from`")

    @property
    def along(self) -> Direction | None:
        """See FeatureMeasureSpec."""
        return self.about
