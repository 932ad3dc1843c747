"""How far a feature lies from where it is nominally, and how it is turned against that, as another part sees it."""

from collections.abc import Iterator, Sequence
from typing import ClassVar, Literal

import numpy as np
from pydantic import Field

from tol3d.assembly.grammar.feature_name import FeatureName, Use, part_of
from tol3d.assembly.grammar.measures.assembly_measure import TimedSpec
from tol3d.assembly.grammar.measures.gap import DistanceSpec, GapSpec
from tol3d.assembly.grammar.parts import SolidSpec
from tol3d.assembly.model.measures import PLACING, TORSORS, Measured, Reading
from tol3d.scene.name import Name
from tol3d.scene.reference import Reference
from tol3d.units import Dimension

Component = Literal["x", "y", "z", "size"]
AXES = dict(zip("xyz", np.eye(3), strict=True))


class PoseErrorSpec(TimedSpec):
    """A feature against its nominal place, in the frame of a part."""

    words: ClassVar[str] = "an error of place or turn"
    reads_along: ClassVar[Reading]  # along a component; `reads` is of the size

    of: FeatureName = Field(description="the feature, such as link 6.flange")
    from_: Name = Field(alias="from", description="the part that sees it, such as base")
    component: Component = Field(
        default="size", description="along, or about, x, y or z of that part; or the size of all three"
    )

    @property
    def of_what(self) -> Sequence[str]:
        """The feature, and the part that sees it."""
        return (self.of, self.from_)

    @property
    def twin(self) -> FeatureName:
        """The feature that lies nominally where its own one does, on the part that sees it."""
        return f"{self.of} nominal in {self.from_}"

    def measured(self, moves: Sequence[str]) -> Measured:
        """From its twin to its own feature."""
        return Measured(
            self.reads_along if self.component in AXES else self.reads, (self.twin, self.of), AXES.get(self.component)
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
    """Where the feature lies less where it lies nominally, as the part `from` sees it.

    Along `x`, `y` or `z` of that part, or the `size` of all three.
    """

    reads: ClassVar[Reading] = DistanceSpec.reads
    reads_along: ClassVar[Reading] = GapSpec.reads

    kind: Literal["position_error"]


class OrientationErrorSpec(PoseErrorSpec):
    """The rotation vector that turns the nominal frame of the feature into that of the trial.

    About `x`, `y` or `z` of the part `from`, which sees it, or its `size`.
    """

    dimension: ClassVar[Dimension] = "angle"
    reads: ClassVar[Reading] = Reading("turn", f"{PLACING}:turn", f"{TORSORS}:turn", is_linear=True, worse="high")
    reads_along: ClassVar[Reading] = reads

    kind: Literal["orientation_error"]
