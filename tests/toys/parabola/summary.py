"""Keys of a summary for springs, besides those of every one."""

from collections.abc import Mapping
from typing import Final, Literal

from tol3d.study.runs.summary.kinds import SummaryKinds
from tol3d.study.runs.summary.measure import MeasureSummary
from tol3d.study.runs.summary.run import RunSummary
from tol3d.study.runs.summary.values import LEFT_OUT, Known, Label, Maybe, Number, Section

PRESENTER: Final = "toys.parabola.showing"


class HeightSummary(MeasureSummary):
    """Lift of a spring."""

    presenter = PRESENTER

    kind: Literal["height"]
    of: Label

    @property
    def words(self) -> str:
        return f"{self.take} of the height of {self.of}"

    @property
    def position_word(self) -> str:
        return "spring"

    @property
    def position_column(self) -> str | None:
        return "position:spring [deg]" if self.over == "random" else None


class RoomSummary(MeasureSummary):
    """Rest of a room."""

    presenter = PRESENTER

    kind: Literal["room"]
    of: Label
    room_um: Number


class Term(Section):
    """Contribution of a term to a measure, in its unit."""

    mean: Known
    sigma: Known
    share_percent: Known


class TermsOfRun(RunSummary):
    """The terms of heights."""

    terms: Maybe[Mapping[Label, Mapping[Label, Mapping[Label, Term]]]] = LEFT_OUT


class Knots(Section):
    """Between how many knots chords were drawn."""

    knots: Maybe[int] = LEFT_OUT


SUMMARY_KINDS: Final = SummaryKinds((HeightSummary, RoomSummary), (TermsOfRun,), options=(Knots,))
