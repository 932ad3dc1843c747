"""What summary.json holds of assemblies: of which features each measure is."""

from collections.abc import Mapping
from typing import Annotated, Final, Literal

from pydantic import Field

from tol3d.runs.summary.kinds import SummaryKinds
from tol3d.runs.summary.measure import MeasureSummary
from tol3d.runs.summary.values import LEFT_OUT, MOST_ENTRIES, Label, Maybe

PRESENTER: Final = "tol3d.assembly.presenting"


class AssemblyMeasureSummary(MeasureSummary):
    """A measure of features, or the difference of two measures."""

    presenter = PRESENTER

    kind: Literal[
        "angle",
        "contact_angle",
        "difference",
        "distance",
        "flush",
        "gap",
        "inspected_flatness",
        "inspected_orientation",
        "inspected_pattern",
        "inspected_position",
        "inspected_size",
        "point_plane",
        "slack",
        "virtual_clearance",
        "surface_gap",
    ]
    laws: Maybe[Mapping[Label, Label]] = Field(
        default=LEFT_OUT, description="laws of zones that a size widens, and of those that only judge, by tolerance"
    )
    of: Annotated[list[Label], Field(min_length=1, max_length=MOST_ENTRIES)]

    @property
    def words(self) -> str:
        """See MeasureSummary.

        >>> AssemblyMeasureSummary.model_construct(kind="gap", of=["base.rim", "cover.rim"]).words
        'gap from base.rim to cover.rim'
        >>> AssemblyMeasureSummary.model_construct(kind="difference", of=["upper gap", "lower gap"]).words
        'upper gap less lower gap'
        >>> AssemblyMeasureSummary.model_construct(kind="inspected_size", of=["base.bore"]).words
        'inspected size of base.bore'
        >>> AssemblyMeasureSummary.model_construct(kind="virtual_clearance", of=["base.hole", "lid.hole"]).words
        'virtual clearance of base.hole, lid.hole'
        """
        kind = self.kind.replace("_", " ")
        if self.kind == "difference":
            return " less ".join(self.of)
        if len(self.of) == 2 and self.kind not in ("virtual_clearance", "inspected_pattern"):
            return f"{kind} from {self.of[0]} to {self.of[1]}"
        return f"{kind} of {', '.join(self.of)}"

    @property
    def identity(self) -> tuple[str | None, ...]:
        """See MeasureSummary."""
        return (self.kind, *self.of)


SUMMARY_KINDS: Final = SummaryKinds((AssemblyMeasureSummary,))
