"""The largest error of place over several poses, and over the flanks on which joints may lie."""

from collections.abc import Iterator
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from tol3d.assembly.grammar.feature_name import FeatureName, Use, part_of
from tol3d.assembly.grammar.parts import SolidSpec
from tol3d.scene.listed import listed
from tol3d.scene.measure import LengthLimit, MeasureEntry
from tol3d.scene.name import Name
from tol3d.scene.reference import Reference
from tol3d.units import Dimension


class WorstPositionErrorSpec(MeasureEntry):
    """The size of a position error in the pose of the trial in which it is largest."""

    words: ClassVar[str] = "a worst error of place"
    dimension: ClassVar[Dimension] = "length"
    gives_curve: ClassVar[bool] = False
    several_positions: ClassVar[bool] = False

    kind: Literal["worst_position_error"]
    of: FeatureName = Field(description="the feature, such as link 6.flange")
    from_: Name = Field(alias="from", description="the part that sees it, such as base")
    poses: Annotated[tuple[Name, ...], listed("poses")] | None = Field(
        default=None, description="over which; default: all that the scene's moves have"
    )
    flanks: Literal["loaded", "any"] = Field(
        default="loaded",
        description="loaded: each joint on the flank on which gravity lays it; any: on those that make it largest",
    )
    lower_limit: LengthLimit | None = Field(default=None, description="less than this is out of limits")
    upper_limit: LengthLimit | None = Field(default=None, description="more than this is out of limits")

    def references(self) -> tuple[Reference, ...]:
        """Both parts."""
        return (
            Reference(("of",), part_of(self.of), (SolidSpec,)),
            Reference(("from",), self.from_, (SolidSpec,)),
        )

    def uses(self) -> Iterator[Use]:
        """The feature."""
        yield Use(("of",), self.of)
