"""Keys of summary.json for RV reducers, besides those of every run."""

from collections.abc import Mapping
from typing import Annotated, Final, Literal

from pydantic import Field
from typing_extensions import override

from tol3d.study.runs.summary.kinds import SummaryKinds
from tol3d.study.runs.summary.measure import OutputMeasureSummary
from tol3d.study.runs.summary.run import RunSummary
from tol3d.study.runs.summary.shows import Shows
from tol3d.study.runs.summary.values import LEFT_OUT, MOST_ENTRIES, Label, Maybe, Number, Section

PAPER: Final = "paper (reconstructed) [″]"
FIRST_PRINCIPLES: Final = "first principles [″]"


class SourceByFormula(Section):
    """One source of transmission error; three standard deviations of the output's angle [arc second]."""

    tolerance_um: Annotated[Number, Shows("tolerance [µm]", ".4g")] = Field(
        description="tolerance or run-out that its standard deviation stands for"
    )
    by_formula_arcsec: Annotated[Maybe[Number], Shows(PAPER, ".2f", seldom=True)] = Field(
        default=LEFT_OUT, description="by the published formula, as reconstructed, where a published column has it"
    )
    first_principles_arcsec: Annotated[Number, Shows(FIRST_PRINCIPLES, ".2f")]
    arcsec_per_um: Annotated[Number, Shows("per µm [″]", ".4f")] = Field(
        description="first principles: turn of a disc whose best pin alone touches"
    )


class StageTotals(Section):
    """Cycloid stage and carrier added up; three standard deviations [arc second]."""

    cycloid_arcsec: Number
    carrier_arcsec: Number
    added_arcsec: Number = Field(description="both added")
    root_sum_square_arcsec: Number


class FormulaTotals(StageTotals):
    """The same by the published formula, with the law that it has."""

    cycloid_half_range_arcsec: Number = Field(description="even about 0, 99.73 % of all: its law is not normal")
    cycloid_coverage_percent: Number = Field(description="coverage of three standard deviations")


class CycloidStageSummary(Section):
    """The cycloid stage and carrier of an RV reducer by formula."""

    sources: Mapping[Label, SourceByFormula]
    by_formula: Maybe[FormulaTotals] = Field(
        default=LEFT_OUT, description="the published formula, as reconstructed, where a published column has it"
    )
    first_principles: StageTotals = Field(description="of the pin with the largest lever alone")
    sun_held: Maybe[Number] = Field(
        default=LEFT_OUT, description="turn of the output while the sun stands per turn of a disc"
    )
    left_out: Annotated[list[Label], Field(max_length=MOST_ENTRIES)] = Field(
        description="contributors that the formula does not know"
    )


class CycloidOfRun(RunSummary):
    """The cycloid stages of a run."""

    cycloid_stages: Maybe[Mapping[Label, CycloidStageSummary]] = LEFT_OUT


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
    @override
    def identity(self) -> tuple[str | None, ...]:
        return *super().identity, None if self.deflection_um is None else f"{self.deflection_um:g}"


SUMMARY_KINDS: Final = SummaryKinds((RVMeasureSummary,), (CycloidOfRun,))
