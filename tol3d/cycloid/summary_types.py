"""What summary.json holds of RV reducers besides what every run has."""

from typing import Final, Literal

from tol3d.cycloid.formula_summary import CycloidOfRun
from tol3d.runs.summary.kinds import SummaryKinds
from tol3d.runs.summary.output_measure import OutputMeasureSummary


class RVMeasureSummary(OutputMeasureSummary):
    """A measure of an RV reducer."""

    kind: Literal["cycloid_lost_motion", "cycloid_transmission_error"]

    @property
    def words(self) -> str:
        """See MeasureSummary.

        >>> made = RVMeasureSummary.model_construct
        >>> made(kind="cycloid_lost_motion", of="reducer", take="value").words
        'lost motion of reducer'
        >>> made(kind="cycloid_transmission_error", of="reducer", take="harmonic", order=39).words
        'order 39, peak to peak, of the transmission error of reducer'
        """
        return f"{self.quantity} of {self.of}"


SUMMARY_KINDS: Final = SummaryKinds((RVMeasureSummary,), (CycloidOfRun,))
