"""What summary.json holds of RV reducers besides what every run has."""

from typing import Annotated, Final, Literal

from pydantic import Field

from tol3d.cycloid.formula_summary import CycloidOfRun
from tol3d.runs.summary.kinds import SummaryKinds
from tol3d.runs.summary.measure import MeasureSummary
from tol3d.runs.summary.values import LEFT_OUT, Label, Maybe

MOST_ORDER: Final = 16_000


class RVMeasureSummary(MeasureSummary):
    """A measure of an RV reducer."""

    kind: Literal["cycloid_lost_motion", "cycloid_transmission_error"]
    of: Label
    order: Maybe[Annotated[int, Field(ge=1, le=MOST_ORDER)]] = Field(
        default=LEFT_OUT, description="of a harmonic: cycles a turn of the output"
    )

    @property
    def words(self) -> str:
        """See MeasureSummary.

        >>> made = RVMeasureSummary.model_construct
        >>> made(kind="cycloid_lost_motion", of="reducer", take="value").words
        'lost motion of reducer'
        >>> made(kind="cycloid_transmission_error", of="reducer", take="harmonic", order=39).words
        'order 39, peak to peak, of the transmission error of reducer'
        """
        quantity = self.kind.removeprefix("cycloid_").replace("_", " ")
        taken = {
            "min": "least ",
            "max": "largest ",
            "range": "range of the ",
            "harmonic": f"order {self.order}, peak to peak, of the ",
        }
        return f"{taken.get(self.take, '')}{quantity} of {self.of}"

    @property
    def position_word(self) -> str:
        """See MeasureSummary."""
        return "output"

    @property
    def identity(self) -> tuple[str | None, ...]:
        """See MeasureSummary."""
        return self.kind, self.of, None if self.order is None else str(self.order)


SUMMARY_KINDS: Final = SummaryKinds((RVMeasureSummary,), (CycloidOfRun,))
