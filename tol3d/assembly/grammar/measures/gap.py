"""Lengths from one feature to another."""

from collections.abc import Sequence
from typing import ClassVar, Literal

from pydantic import Field

from tol3d.assembly.grammar.feature_name import FeatureName
from tol3d.assembly.grammar.measures.assembly_measure import BetweenSpec, OverPlaySpec
from tol3d.assembly.model.measures import PLACING, TORSORS, Reading
from tol3d.scene.place import KeyPath
from tol3d.scene.vector import Direction
from tol3d.units import Dimension


class DistanceSpec(BetweenSpec):
    """In space, from middle to middle, 0 or more."""

    reads: ClassVar[Reading] = Reading("distance", f"{PLACING}:distance", f"{TORSORS}:distance")

    kind: Literal["distance"]


class DirectedSpec(OverPlaySpec):
    """Distance of `to` from `from` along a direction."""

    reads: ClassVar[Reading] = Reading("gap", f"{PLACING}:gap", f"{TORSORS}:gap", is_linear=True)

    direction: Direction = Field(alias="along", description="in the frame of the part of `from`")

    @property
    def along(self) -> Direction | None:
        return self.direction


class GapSpec(DirectedSpec):
    """Signed distance of the middle of `to` from that of `from` along a direction."""

    kind: Literal["gap"]


class FlushSpec(DirectedSpec):
    """The same number: positive where the middle of `to` stands proud of that of `from`."""

    kind: Literal["flush"]


class PointPlaneSpec(OverPlaySpec):
    """Height of a point, or the middle of a feature, above the plane `to`, along the plane's actual normal."""

    reads: ClassVar[Reading] = Reading(
        "point_plane", f"{PLACING}:point_plane", f"{TORSORS}:point_plane", is_linear=True
    )

    kind: Literal["point_plane"]

    def named(self) -> Sequence[tuple[KeyPath, FeatureName, tuple[str, ...]]]:
        return ((("from",), self.from_, ()), (("to",), self.to, ("plane", "point")))


class AngleSpec(OverPlaySpec):
    """Between normals or axes, 0 to 180°; about a direction with its sign."""

    dimension: ClassVar[Dimension] = "angle"
    reads: ClassVar[Reading] = Reading("angle", f"{PLACING}:angle", f"{TORSORS}:angle")

    kind: Literal["angle"]
    about: Direction | None = Field(default=None, description="in the frame of the part of `from`")

    @property
    def along(self) -> Direction | None:
        return self.about
