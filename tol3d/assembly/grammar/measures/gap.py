"""Lengths from one feature to another."""

from collections.abc import Sequence
from typing import ClassVar, Literal

from pydantic import Field

from tol3d.assembly.grammar.feature_name import FeatureName
from tol3d.assembly.grammar.measures.assembly_measure import BetweenSpec, OverPlaySpec
from tol3d.assembly.model.measures import MeasureKind
from tol3d.scene.place import KeyPath
from tol3d.scene.vector import Direction


class DistanceSpec(BetweenSpec):
    """The distance of two points in space, 0 or more."""

    reads: ClassVar[MeasureKind] = "distance"

    kind: Literal["distance"]


class DirectedSpec(OverPlaySpec):
    """How far `to` lies from `from` along a direction."""

    reads: ClassVar[MeasureKind] = "gap"

    direction: Direction = Field(alias="along", description="in the frame of the part of `from`")

    @property
    def along(self) -> Direction | None:
        """See FeatureMeasureSpec."""
        return self.direction


class GapSpec(DirectedSpec):
    """A gap at a section."""

    kind: Literal["gap"]


class FlushSpec(DirectedSpec):
    """How far `to` stands proud of `from` at a section."""

    kind: Literal["flush"]


class PointPlaneSpec(OverPlaySpec):
    """How far a point lies above a plane, along its normal."""

    reads: ClassVar[MeasureKind] = "point_plane"

    kind: Literal["point_plane"]

    def named(self) -> Sequence[tuple[KeyPath, FeatureName, tuple[str, ...]]]:
        """See FeatureMeasureSpec."""
        return ((("from",), self.from_, ()), (("to",), self.to, ("plane", "point")))
