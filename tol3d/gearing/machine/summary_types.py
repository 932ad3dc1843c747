"""Keys of summary.json for machines: worst errors over poses."""

from typing import Annotated, Final, Literal

from pydantic import Field

from tol3d.study.runs.summary.kinds import SummaryKinds
from tol3d.study.runs.summary.measure import MeasureSummary
from tol3d.study.runs.summary.values import MOST_ENTRIES, Label

PRESENTER: Final = "tol3d.assembly.presenting"


class WorstErrorSummary(MeasureSummary):
    """The largest error of a feature's place over several poses."""

    presenter = PRESENTER
    long_in_mm = True

    kind: Literal["worst_position_error"]
    of: Annotated[list[Label], Field(min_length=2, max_length=2)]
    poses: Annotated[list[Label], Field(min_length=1, max_length=MOST_ENTRIES)]

    @property
    def words(self) -> str:
        """See MeasureSummary.

        >>> given = {"kind": "worst_position_error", "of": ["link 6.flange", "base"], "poses": ["home", "far"]}
        >>> WorstErrorSummary.model_construct(**given).words
        'worst position error of link 6.flange, as base sees it, over home, far'
        """
        return f"worst position error of {self.of[0]}, as {self.of[1]} sees it, over {', '.join(self.poses)}"

    @property
    def identity(self) -> tuple[str | None, ...]:
        return (self.kind, *self.of, *self.poses)


SUMMARY_KINDS: Final = SummaryKinds((WorstErrorSummary,))
