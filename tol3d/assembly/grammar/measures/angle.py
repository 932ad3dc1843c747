"""The angle of two features."""

from typing import ClassVar, Literal

from pydantic import Field

from tol3d.assembly.grammar.measures.assembly_measure import OverPlaySpec
from tol3d.assembly.model.measures import PLACING, TORSORS, Reading
from tol3d.scene.vector import Direction
from tol3d.units import Dimension


class AngleSpec(OverPlaySpec):
    """Between normals or axes, 0 to 180°; about a direction with its sign."""

    dimension: ClassVar[Dimension] = "angle"
    reads: ClassVar[Reading] = Reading("angle", f"{PLACING}:angle", f"{TORSORS}:angle")

    kind: Literal["angle"]
    about: Direction | None = Field(default=None, description="in the frame of the part of `from`")

    @property
    def along(self) -> Direction | None:
        """See FeatureMeasureSpec."""
        return self.about
