"""How far a feature lies from where it is nominally, and how it is turned against that, as another part sees it."""

from collections.abc import Iterator, Sequence
from typing import ClassVar, Literal

from pydantic import Field

from tol3d.assembly.grammar.feature_name import FeatureName, Use, part_of
from tol3d.assembly.grammar.measures.assembly_measure import TimedSpec
from tol3d.assembly.grammar.parts import SolidSpec
from tol3d.scene.name import Name
from tol3d.scene.reference import Reference
from tol3d.units import Dimension

Component = Literal["x", "y", "z", "size"]


class PoseErrorSpec(TimedSpec):
    """A feature against its nominal place, in the frame of a part."""

    words: ClassVar[str] = "an error of place or turn"

    of: FeatureName = Field(description="the feature, such as link 6.flange")
    from_: Name = Field(alias="from", description="the part that sees it, such as base")
    component: Component = Field(
        default="size", description="along, or about, x, y or z of that part; or the size of all three"
    )

    @property
    def parts_read(self) -> Sequence[str]:
        """See TimedSpec."""
        return (self.from_, part_of(self.of))

    def references(self) -> tuple[Reference, ...]:
        """Both parts, and the move after which it is read."""
        parts = (Reference(("of",), part_of(self.of), (SolidSpec,)), Reference(("from",), self.from_, (SolidSpec,)))
        return (*parts, *self.timing)

    def uses(self) -> Iterator[Use]:
        """The feature."""
        yield Use(("of",), self.of)


class PositionErrorSpec(PoseErrorSpec):
    """The place of a feature's origin less its nominal one."""

    kind: Literal["position_error"]


class OrientationErrorSpec(PoseErrorSpec):
    """The rotation vector that turns a feature's nominal frame into that of the trial."""

    dimension: ClassVar[Dimension] = "angle"

    kind: Literal["orientation_error"]
