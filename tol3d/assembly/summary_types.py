"""Assembly entries in summary.json: the features of each measure."""

from typing import Annotated, Final

from pydantic import Field

from tol3d.study.runs.summary.kinds import SummaryKinds
from tol3d.study.runs.summary.measure import MeasureSummary
from tol3d.study.runs.summary.values import LEFT_OUT, MOST_ENTRIES, Label, Maybe, NotNegative

PRESENTER: Final = "tol3d.assembly.presenting"
POSE_ERRORS: Final = ("position_error", "orientation_error", "direction_error")


class AssemblyMeasureSummary(MeasureSummary):
    """A measure of features, or the difference of two measures."""

    presenter = PRESENTER
    long_in_mm = True

    of: Annotated[list[Label], Field(min_length=1, max_length=MOST_ENTRIES)]
    chord_error_um: Maybe[NotNegative] = Field(
        default=LEFT_OUT, description="of a clearance: how far it may be off, as stated"
    )
    mesh_error_um: Maybe[NotNegative] = Field(
        default=LEFT_OUT, description="of a clearance: chord errors of the meshes of both parts, together"
    )

    pose: Maybe[Label] = Field(default=LEFT_OUT, description="in which it is read, where the scene's moves have poses")
    path: Maybe[Label] = Field(default=LEFT_OUT, description="over which it is read, where it is")
    component: Maybe[Label] = Field(default=LEFT_OUT, description="of an error of place or turn: x, y, z or size")

    @property
    def words(self) -> str:
        """See MeasureSummary.

        >>> AssemblyMeasureSummary.model_construct(kind="gap", of=["base.rim", "cover.rim"]).words
        'gap from base.rim to cover.rim'
        >>> given = {"kind": "position_error", "of": ["link 6.flange", "base"], "component": "x", "pose": "far"}
        >>> AssemblyMeasureSummary.model_construct(**given).words
        'x of the position error of link 6.flange, as base sees it, at far'
        >>> AssemblyMeasureSummary.model_construct(kind="difference", of=["upper gap", "lower gap"]).words
        'upper gap less lower gap'
        >>> AssemblyMeasureSummary.model_construct(kind="inspected_size", of=["base.bore"]).words
        'inspected size of base.bore'
        >>> AssemblyMeasureSummary.model_construct(kind="virtual_clearance", of=["base.hole", "lid.hole"]).words
        'virtual clearance of base.hole, lid.hole'
        >>> AssemblyMeasureSummary.model_construct(kind="clearance", of=["lid", "box"], chord_error_um=2.0).words
        'clearance from lid to box, within 2 um by their meshes'
        """
        kind = self.kind.replace("_", " ")
        if self.kind == "clearance":
            return f"clearance from {self.of[0]} to {self.of[1]}, within {self.chord_error_um:.3g} um by their meshes"
        at = f", at {self.pose}" if self.pose else f", {self.take} over {self.path}" if self.path else ""
        if self.kind in POSE_ERRORS:
            along = "" if self.component == "size" else f"{self.component} of the "
            return f"{along}{kind} of {self.of[0]}, as {self.of[1]} sees it{at}"
        if self.kind == "difference":
            return " less ".join(self.of) + at
        if len(self.of) == 2 and self.kind != "virtual_clearance" and not self.kind.startswith("inspected_"):
            return f"{kind} from {self.of[0]} to {self.of[1]}{at}"
        return f"{kind} of {', '.join(self.of)}{at}"

    @property
    def identity(self) -> tuple[str | None, ...]:
        return (self.kind, *self.of, *(own for own in (self.pose, self.path, self.component) if own))


SUMMARY_KINDS: Final = SummaryKinds(common=(AssemblyMeasureSummary,))
"""For the measures of the mechanism that names it: those of assembly/grammar/measures/, or of one that adds to them."""
