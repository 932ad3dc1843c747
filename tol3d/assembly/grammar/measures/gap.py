"""Lengths from one feature to another, and at round ones that touch: gap of surfaces, angle of the contact normal."""

from collections.abc import Sequence
from typing import ClassVar, Literal, Self

from pydantic import Field, model_validator

from tol3d.assembly.grammar.feature_name import FeatureName
from tol3d.assembly.grammar.measures.assembly_measure import BetweenSpec, OverPlaySpec
from tol3d.assembly.grammar.moves.mate import SURFACES
from tol3d.assembly.model.measures import PLACING, TORSORS, Reading
from tol3d.scene.place import KeyPath
from tol3d.scene.vector import Direction
from tol3d.strict import refused
from tol3d.units import Dimension


class SurfaceGapSpec(BetweenSpec):
    """Least gap between two surfaces, at least one of them round, over the length that both have in common.

    Surfaces have the sizes of the trial; the gap is negative if they overlap.
    """

    reads: ClassVar[Reading] = Reading("surface_gap", f"{PLACING}:surface_gap", f"{TORSORS}:surface_gap")

    kind: Literal["surface_gap"]

    def named(self) -> Sequence[tuple[KeyPath, FeatureName, tuple[str, ...]]]:
        return ((("from",), self.from_, SURFACES), (("to",), self.to, SURFACES))


class ContactAngleSpec(BetweenSpec):
    """Angle of a contact normal, which points from the middle or plane of `from` to that of `to`, 0 to 180°.

    The normal of parallel cylinders is read at the middle of `to`. The angle is measured to the normal of a plane or
    to an axis, `against`, or to a direction, `along`; give one of the two.
    """

    dimension: ClassVar[Dimension] = "angle"
    reads: ClassVar[Reading] = Reading("contact_angle", f"{PLACING}:contact_angle", f"{TORSORS}:contact_angle")

    kind: Literal["contact_angle"]
    against: FeatureName | None = Field(default=None, description="a plane or an axis; or a direction `along`")
    direction: Direction | None = Field(default=None, alias="along", description="in the frame of the part of `from`")

    @property
    def along(self) -> Direction | None:
        return self.direction

    def named(self) -> Sequence[tuple[KeyPath, FeatureName, tuple[str, ...]]]:
        sides = ((("from",), self.from_, SURFACES), (("to",), self.to, SURFACES))
        return sides if self.against is None else (*sides, (("against",), self.against, ("plane", "cylinder", "axis")))

    @model_validator(mode="after")
    def _refuse_contradictions(self) -> Self:
        if (self.against is None) == (self.direction is None):
            got = "neither" if self.against is None else "both"
            raise refused("against", "either a plane or an axis `against`, or a direction `along`", got)
        return self


class DistanceSpec(BetweenSpec):
    """Distance in space from middle to middle, 0 or more."""

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
    """Height along a direction by which the middle of `to` stands proud of that of `from`; the number of a `gap`."""

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
    """Angle between normals or axes, 0 to 180°; about a direction, with its sign."""

    dimension: ClassVar[Dimension] = "angle"
    reads: ClassVar[Reading] = Reading("angle", f"{PLACING}:angle", f"{TORSORS}:angle")

    kind: Literal["angle"]
    about: Direction | None = Field(default=None, description="in the frame of the part of `from`")

    @property
    def along(self) -> Direction | None:
        return self.about
