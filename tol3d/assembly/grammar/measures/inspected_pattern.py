"""What a gauge for a whole pattern of holes or pins says, where it may find its place."""

from collections.abc import Sequence
from typing import Annotated, ClassVar, Literal, Self

from pydantic import Field, model_validator

from tol3d.assembly.grammar.datums import Datums, DatumSpec
from tol3d.assembly.grammar.feature_name import FeatureName, part_of
from tol3d.assembly.grammar.measures.assembly_measure import FeatureMeasureSpec
from tol3d.assembly.grammar.measures.virtual_clearance import MOST_HOLES
from tol3d.assembly.model.bonus import Modifier
from tol3d.assembly.model.measures import TORSORS, Gauge, Reading
from tol3d.scene.listed import listed
from tol3d.scene.place import KeyPath
from tol3d.strict import refused


class InspectedPatternSpec(FeatureMeasureSpec):
    """The largest position of 2 to 8 parallel features, where nominal places may move to make it least.

    They may `shift`, or `shift_and_turn`; with a `modifier` each position is less its bonus.
    """

    reads: ClassVar[Reading] = Reading(
        "pattern", "tol3d.assembly.placing.measuring:pattern", f"{TORSORS}:pattern", worse="high"
    )

    kind: Literal["inspected_pattern"]
    features: Annotated[tuple[FeatureName, ...], listed("features", 2, MOST_HOLES)] = Field(
        alias="of", description="parallel holes or pins of one part"
    )
    free: Gauge = Field(description="how the gauge finds its pose, across the first feature's axis")
    datums: Datums | None = Field(default=None, description="what orients the gauge; the part's frame if not given")
    modifier: Modifier | None = Field(
        default=None, description="mmc or lmc: each less the bonus of its size, so that all count against t0"
    )

    @property
    def named_datums(self) -> tuple[DatumSpec, ...]:
        """See FeatureMeasureSpec."""
        return self.datums or ()

    @model_validator(mode="after")
    def _refuse_contradictions(self) -> Self:
        parts = sorted({part_of(name) for name in self.features})
        if len(parts) > 1:
            raise refused("of", "features of one part", f"features of {', '.join(map(repr, parts))}")
        for k, name in enumerate(self.features):
            if name in self.features[:k]:
                raise refused("of", "each feature once", repr(name))
        if len(self.named_datums) > 1:
            raise refused("datums", "one at most, which orients the gauge: it finds its place by the features", "more")
        return self

    def named(self) -> Sequence[tuple[KeyPath, FeatureName, tuple[str, ...]]]:
        """See FeatureMeasureSpec."""
        kinds = ("cylinder",) if self.modifier is not None else ("cylinder", "axis")
        return tuple((("of", k), name, kinds) for k, name in enumerate(self.features))
