"""Form: what a surface deviates from its own shape; it takes from the room of a location zone."""

from typing import ClassVar, Literal

from pydantic import Field

from tol3d.assembly.grammar.tolerances.feature_tolerance import FeatureTolerance
from tol3d.assembly.grammar.zone import LawUnion, ZoneSpec


class FormSpec(FeatureTolerance):
    """A zone for the form of a feature; where it touches at a point, that point lies off by up to half of it."""

    zone: ZoneSpec
    law: LawUnion | None = Field(
        default=None, description="of the points that touch; they lie on the shape if not given"
    )


class FlatnessSpec(FormSpec):
    """Of a plane."""

    words: ClassVar[str] = "a flatness tolerance"
    applies_to: ClassVar[tuple[str, ...]] = ("plane",)

    kind: Literal["flatness"]


class StraightnessSpec(FormSpec):
    """Of an axis."""

    words: ClassVar[str] = "a straightness tolerance"
    applies_to: ClassVar[tuple[str, ...]] = ("cylinder", "axis")

    kind: Literal["straightness"]
