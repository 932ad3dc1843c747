"""What summary.json holds of RV reducers besides what every run has."""

from typing import Annotated, Final, Literal

from pydantic import Field

from tol3d.cycloid.formula_summary import CycloidOfRun
from tol3d.runs.summary.kinds import SummaryKinds
from tol3d.runs.summary.output_measure import OutputMeasureSummary
from tol3d.runs.summary.values import LEFT_OUT, Maybe

MOST_UM: Final = 1e9


class RVMeasureSummary(OutputMeasureSummary):
    """A measure of an RV reducer."""

    kind: Literal["cycloid_lost_motion", "cycloid_pins_near_contact", "cycloid_transmission_error"]
    deflection_um: Maybe[Annotated[float, Field(gt=0.0, le=MOST_UM)]] = Field(
        default=LEFT_OUT, description="of pins near contact: the largest gap of those that are counted"
    )

    @property
    def words(self) -> str:
        """See MeasureSummary.

        >>> made = RVMeasureSummary.model_construct
        >>> made(kind="cycloid_lost_motion", of="reducer", take="value").words
        'lost motion of reducer'
        >>> made(kind="cycloid_transmission_error", of="reducer", take="harmonic", order=39).words
        'order 39, peak to peak, of the transmission error of reducer'
        >>> made(kind="cycloid_pins_near_contact", of="reducer", take="min", deflection_um=1.5).words
        'fewest pins within 1.5 µm of contact of reducer'
        """
        if self.deflection_um is None:
            return f"{self.quantity} of {self.of}"
        taken = {"min": "fewest ", "max": "most ", "range": "range of "}.get(self.take, "")
        return f"{taken}pins within {self.deflection_um:g} µm of contact of {self.of}"

    @property
    def identity(self) -> tuple[str | None, ...]:
        """See MeasureSummary."""
        return *super().identity, None if self.deflection_um is None else f"{self.deflection_um:g}"


SUMMARY_KINDS: Final = SummaryKinds((RVMeasureSummary,), (CycloidOfRun,))
